#include "report/floor_plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "report/page.h"

namespace gonio::report {
namespace {

constexpr double width = 560, most_height = 360, margin_x = 90, margin_y = 34;
constexpr double line_height = 15;  // of a label

struct Spot {
  double x = 0, y = 0;
};
struct Scale {
  double per_metre = 1, left_m = 0, far_m = 0, height = 0;
  Spot at(const FloorPlan::Place& p) const {
    return {margin_x + (p.right_m - left_m) * per_metre, margin_y + (far_m - p.away_m) * per_metre};
  }
};
Scale scale_of(const std::array<const FloorPlan::Place*, 4>& places) {
  double left = places[0]->right_m, right = left, near = places[0]->away_m, far = near;
  for (const FloorPlan::Place* p : places) {
    left = std::min(left, p->right_m), right = std::max(right, p->right_m);
    near = std::min(near, p->away_m), far = std::max(far, p->away_m);
  }
  const double across = std::max(right - left, 1e-9), deep = std::max(far - near, 1e-9);
  Scale scale;
  scale.per_metre = std::min((width - 2 * margin_x) / across, (most_height - 3 * margin_y) / deep);
  scale.left_m = left - 0.5 * ((width - 2 * margin_x) / scale.per_metre - across);
  scale.far_m = far;
  scale.height = 3 * margin_y + deep * scale.per_metre;
  return scale;
}

// Right of its spot, or left of it where the drawing ends.
std::string label(Spot s, double down, const std::string& name) {
  const bool crowded = s.x > width - 2 * margin_x;
  return format("<text class=\"mark-name\" x=\"%.1f\" y=\"%.1f\"%s>", crowded ? s.x - 12 : s.x + 12, s.y + down,
                crowded ? " text-anchor=\"end\"" : "") +
         escape(name) + "</text>";
}

double round_length(double most_m) {  // 1, 2 or 5 times a power of ten
  const double power = std::pow(10, std::floor(std::log10(most_m)));
  for (const double step : {5.0, 2.0})
    if (step * power <= most_m) return step * power;
  return power;
}

}  // namespace

std::string svg(const FloorPlan& plan) {
  const Scale scale = scale_of({&plan.camera, &plan.centre, &plan.from, &plan.to});
  const Spot camera = scale.at(plan.camera), centre = scale.at(plan.centre), from = scale.at(plan.from),
             to = scale.at(plan.to);
  std::string text = format("<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\" aria-label=\"", width, scale.height) +
                     escape(plan.title) + "\">";
  text += format("<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>", camera.x, camera.y, centre.x, centre.y);
  for (const Spot& lamp : {from, to})
    text += format("<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>", lamp.x, lamp.y, centre.x, centre.y);
  text += format("<path class=\"axis\" d=\"M%.1f %.1fl9 12h-18zm0 0l-6 -8h12z\"/>", camera.x, camera.y);
  text += format("<path class=\"axis\" d=\"M%.1f %.1fh16m-8 -8v16\"/>", centre.x - 8, centre.y);
  text += format("<path class=\"line c1\" stroke-dasharray=\"7 4\" d=\"M%.1f %.1fL%.1f %.1f\"/>", from.x, from.y, to.x,
                 to.y);
  text += format("<circle class=\"line c0\" cx=\"%.1f\" cy=\"%.1f\" r=\"6\"/>", from.x, from.y);
  text += format("<circle class=\"c1\" stroke=\"none\" cx=\"%.1f\" cy=\"%.1f\" r=\"7\"/>", to.x, to.y);
  // Labels of what stands close together go apart, the upper one up.
  const double apart = std::abs(from.y - to.y) < line_height && std::abs(from.x - to.x) < margin_x
                           ? std::copysign(0.6 * line_height, from.y - to.y)
                           : 0;
  text += label(camera, 4, plan.camera.name) + label(centre, 4, plan.centre.name);
  text += label(from, 4 + apart, plan.from.name) + label(to, 4 - apart, plan.to.name);
  const double bar = round_length(0.25 * width / scale.per_metre), bottom = scale.height - 8;
  text += format("<path class=\"axis\" d=\"M8 %.1fv6h%.1fv-6\"/><text x=\"%.1f\" y=\"%.1f\">%g m</text>", bottom - 6,
                 bar * scale.per_metre, 14 + bar * scale.per_metre, bottom + 2, bar);
  return text + "</svg>";
}

}  // namespace gonio::report
