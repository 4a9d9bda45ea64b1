// See layer_pictures.h.
#include "glass/layer_pictures.h"

#include <algorithm>

namespace gonio::glass {

std::vector<float> values_within(const io::Image& answer, const std::string& channel) {
  std::vector<float> values;
  const int c = answer.channel(channel), mask = answer.channel("mask");
  for (std::size_t i = 0; c >= 0 && i < answer.pixels(); ++i) {
    const float* at = &answer.data[i * answer.channels.size()];
    if (at[mask] >= 0.5F) values.push_back(at[c]);
  }
  std::ranges::sort(values);
  return values;
}

double middle_of(const std::vector<float>& sorted) {
  return sorted.empty() ? 0 : static_cast<double>(sorted[sorted.size() / 2]);
}

io::Image grey_layer(const io::Image& answer, const std::string& channel) {
  const std::vector<float> values = values_within(answer, channel);
  const float white = channel == "mask" || values.empty() ? 1 : values[values.size() * 99 / 100];
  io::Image picture(answer.width, answer.height, {"Y"});
  const int c = answer.channel(channel);
  for (std::size_t i = 0; c >= 0 && i < picture.pixels(); ++i)
    picture.data[i] = answer.data[i * answer.channels.size() + static_cast<std::size_t>(c)] / std::max(white, 1e-9F);
  return picture;
}

}  // namespace gonio::glass
