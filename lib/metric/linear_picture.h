// A picture as linear radiance: an EXR as it is, an 8 or 16-bit file through its stated response.
//
// A response takes the code (stored value over full scale, 0 to 1) to a linear value: "linear", "srgb" (IEC 61966-2-1),
// or a table
// [[code, linear], ...], interpolated linearly, constant beyond its ends, or an object with one of these for each
// channel, {"R": ..., "G": ..., "B": ...}. EXR is linear unless stated otherwise; an 8
// or 16-bit file without a stated response is refused, because a guess would bend every number that follows.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/image.h"
#include "manifest/value.h"

namespace gonio::metric {

class Response {
 public:
  explicit Response(const manifest::Value& stated, const std::string& place);
  float operator()(float code) const;
  float code(float linear) const;                         // the inverse
  void check_invertible(const std::string& place) const;  // Error(data) for a table whose linear values do not rise

 private:
  bool srgb_ = false;
  std::vector<std::pair<double, double>> table_;  // empty: linear
};

// What is stated for `channel`: the response itself, or the object's entry. Error(data) where the object has none.
const manifest::Value& response_of_channel(const manifest::Value& stated, const std::string& channel,
                                           const std::string& place);

struct LinearPicture {
  std::string name;                   // for messages
  io::Image colour;                   // R, G, B or Y
  io::Image variance;                 // of the same channels, where the file has variance.R, ...; else empty
  std::vector<std::uint8_t> clipped;  // per pixel: a code at full scale, the light was brighter; EXR: none
  bool integer_codes = false;         // from an 8 or 16-bit file
};

// Error(data) at `place` where the response is missing or the file has neither R, G, B nor Y.
LinearPicture read_linear(const std::filesystem::path& path, const manifest::Value& response, const std::string& place);

// Pixels above 0.5 count; the first channel decides. 1 per pixel that counts.
struct Mask {
  int width = 0, height = 0;
  std::vector<std::uint8_t> counts;
};
Mask read_mask(const std::filesystem::path& path);

}  // namespace gonio::metric
