// What a network said of photographs of glass, as pictures.
#include "report/page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "io/picture.h"
#include "render/preview.h"
#include "tools/glass-net/call.h"

namespace gonio::tools::glass_net {
namespace {

// Values of a channel where there is glass, sorted.
std::vector<float> within(const io::Image& answer, const std::string& channel) {
  std::vector<float> values;
  const int c = answer.channel(channel), mask = answer.channel("mask");
  for (std::size_t i = 0; c >= 0 && i < answer.pixels(); ++i) {
    const float* at = &answer.data[i * answer.channels.size()];
    if (at[mask] >= 0.5F) values.push_back(at[c]);
  }
  std::ranges::sort(values);
  return values;
}

double median(const std::vector<float>& sorted) {
  return sorted.empty() ? 0 : static_cast<double>(sorted[sorted.size() / 2]);
}

// White where the channel is as large as 99 % of its values are, or as 1 of a mask.
io::Image grey(const io::Image& answer, const std::string& channel) {
  const std::vector<float> values = within(answer, channel);
  const float white = channel == "mask" || values.empty() ? 1 : values[values.size() * 99 / 100];
  io::Image picture(answer.width, answer.height, {"Y"});
  const int c = answer.channel(channel);
  for (std::size_t i = 0; i < picture.pixels(); ++i)
    picture.data[i] = answer.data[i * answer.channels.size() + static_cast<std::size_t>(c)] / std::max(white, 1e-9F);
  return picture;
}

}  // namespace

std::string summary_of(const Looked& looked) {
  const auto glass = static_cast<double>(within(looked.answer, "mask").size());
  std::string text = format("%s: %.3g %% of the pixels show glass", looked.id.c_str(),
                            100 * glass / static_cast<double>(looked.answer.pixels()));
  if (glass == 0) return text;
  for (const auto& [channel, of] : {std::pair{"uncertainty.normal", "front"}, {"uncertainty.back_normal", "back"}})
    if (looked.answer.channel(channel) >= 0)
      text += format(", normals of the %s to %.3g degrees", of, median(within(looked.answer, channel)) * 180 / M_PI);
  if (looked.answer.channel("uncertainty.depth.Z") >= 0)
    text += format(", depth to %.3g mm", 1e3 * median(within(looked.answer, "uncertainty.depth.Z")));
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
    add("mask", grey(looked.answer, "mask"));
    for (const auto& [layer, picture] : render::layer_previews(looked.answer)) add(layer, picture);
    for (const auto& [layer, channel] : {std::pair{"depth +-", "uncertainty.depth.Z"},
                                         {"normal +-", "uncertainty.normal"},
                                         {"back-normal +-", "uncertainty.back_normal"}})
      if (looked.answer.channel(channel) >= 0) add(layer, grey(looked.answer, channel));
    page.figures(figures, 240);
  }
  return page.html();
}

}  // namespace gonio::tools::glass_net
