// What a network said of photographs of glass, as pictures.
#include "report/page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "glass/layer_pictures.h"
#include "io/picture.h"
#include "render/preview.h"
#include "tools/glass-net/call.h"

namespace gonio::tools::glass_net {
using namespace gonio::glass;

std::string summary_of(const Looked& looked) {
  const auto glass = static_cast<double>(values_within(looked.answer, "mask").size());
  std::string text = format("%s: %.3g %% of the pixels show glass", looked.id.c_str(),
                            100 * glass / static_cast<double>(looked.answer.pixels()));
  if (glass == 0) return text;
  for (const auto& [channel, of] : {std::pair{"uncertainty.normal", "front"}, {"uncertainty.back_normal", "back"}})
    if (looked.answer.channel(channel) >= 0)
      text += format(", normals of the %s to %.3g degrees", of,
                     middle_of(values_within(looked.answer, channel)) * 180 / M_PI);
  if (looked.answer.channel("uncertainty.depth.Z") >= 0)
    text += format(", depth to %.3g mm", 1e3 * middle_of(values_within(looked.answer, "uncertainty.depth.Z")));
  return text;
}

std::string page_of(const std::vector<Looked>& all, const std::string& weights) {
  report::Page page("glass-net", format("%zu photograph%s of glass", all.size(), all.size() == 1 ? "" : "s"),
                    "weights: " + weights);
  page.note(
      "Normals: 0.5 + 0.5 n, x red, y green, z blue; depth from the nearest (dark) to the farthest; uncertainties "
      "from none (black) to the largest hundredth (white).");
  for (const Looked& looked : all) {
    page.section(looked.id);
    page.paragraph(summary_of(looked) + ".");
    std::vector<report::Figure> figures;
    const auto add = [&](const std::string& title, const io::Image& picture) {
      figures.push_back({.png = io::encode_png(picture), .title = title});
    };
    add("light", render::preview(looked.light));
    add("mask", grey_layer(looked.answer, "mask"));
    for (const auto& [layer, picture] : render::layer_previews(looked.answer)) add(layer, picture);
    for (const auto& [layer, channel] : {std::pair{"depth +-", "uncertainty.depth.Z"},
                                         {"normal +-", "uncertainty.normal"},
                                         {"back-normal +-", "uncertainty.back_normal"}})
      if (looked.answer.channel(channel) >= 0) add(layer, grey_layer(looked.answer, channel));
    page.figures(figures, 240);
  }
  return page.html();
}

}  // namespace gonio::tools::glass_net
