// Residual vectors of all corners over the image, before and after: what a person looks at first. Inline SVG, no
// scripts.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "explain/boards/boards_outcome.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

void print_line(std::string& svg, Vec2 from, Vec2 to) {
  char text[160];
  std::snprintf(text, sizeof text, "M%.1f %.1fL%.1f %.1f", from.x, from.y, to.x, to.y);
  svg += text;
}

// Arrows `scale` times the residual, in the frame of the image.
std::string vectors(const BoardsInput& input, std::size_t camera, const Observations& o,
                    const std::vector<double>& residual, double scale, const char* colour) {
  const BoardsInput::Camera& c = input.cameras[camera];
  char head[256];
  std::snprintf(head, sizeof head,
                "<svg viewBox=\"-10 -10 %d %d\" role=\"img\" style=\"background:#fff;min-width:min(27rem,85vw)\">"
                "<rect x=\"-0.5\" y=\"-0.5\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>",
                c.width_px + 20, c.height_px + 20, c.width_px, c.height_px);
  std::string path, dots;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    if (input.views[v].camera != camera) continue;
    for (std::size_t k = 0; k < input.views[v].corners.size(); ++k) {
      const Vec2 at = input.views[v].corners[k].pixel;
      const std::size_t row = o.first[v] + 2 * k;
      print_line(path, at, at + Vec2{residual[row], residual[row + 1]} * scale);
      char dot[80];
      std::snprintf(dot, sizeof dot, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.2\"/>", at.x, at.y);
      dots += dot;
    }
  }
  return std::string(head) + "<g fill=\"#999\">" + dots + "</g><path d=\"" + path + "\" stroke=\"" + colour +
         "\" stroke-width=\"1.3\" fill=\"none\"/></svg>";
}

}  // namespace

Illustration illustrate_boards(const BoardsInput& input, const Observations& o, const Explanation& e) {
  Illustration result;
  std::vector<double> length;
  for (const double r : e.residual_before) length.push_back(std::abs(r));
  const double typical = std::max(1e-6, stats::quantile(length, 0.95));
  for (std::size_t c = 0; c < input.cameras.size(); ++c) {
    const double scale = std::pow(10.0, std::round(2 * std::log10(0.06 * input.cameras[c].width_px / typical)) / 2);
    char title[160];
    const std::string name = input.cameras.size() > 1 ? " of " + input.cameras[c].name : "";
    std::snprintf(title, sizeof title, "Residuals%s under the base model, %.0f times enlarged", name.c_str(), scale);
    result.pictures.push_back({title, "", vectors(input, c, o, e.residual_before, scale, "#b34700")});
    if (e.named.empty()) continue;
    std::snprintf(title, sizeof title, "The same with the named physics, %.0f times enlarged", scale);
    result.pictures.push_back({title, "", vectors(input, c, o, e.residual_after, scale, "#0067a5")});
  }
  return result;
}

}  // namespace gonio::explain
