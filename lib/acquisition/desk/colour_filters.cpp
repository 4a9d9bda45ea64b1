// See colour_filters.h.
#include "acquisition/desk/colour_filters.h"

#include <array>

#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition::desk {

io::Image through_filters(const io::Image& light, const std::vector<double>& filters, const std::string& place) {
  io::Image passed = light;
  if (filters.empty()) return passed;
  if (filters.size() != 9)
    throw Error(Exit::data, place, format("has %zu numbers", filters.size()), "give three rows of three, row by row");
  std::array<std::size_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const int channel = light.channel(std::string(1, "RGB"[c]));
    if (channel < 0) throw Error(Exit::data, place, "is for cameras of three colours", "take it out");
    colour[c] = static_cast<std::size_t>(channel);
  }
  const std::size_t channels = light.channels.size();
  for (std::size_t i = 0; i < light.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += filters[3 * c + k] * light.data[channels * i + colour[k]];
      passed.data[channels * i + colour[c]] = static_cast<float>(sum);
    }
  return passed;
}

}  // namespace gonio::acquisition::desk
