// A photograph as linear radiance: an EXR as it is, an 8 or 16-bit file through its stated response
// (photograph/response.h). EXR is linear unless stated otherwise; an 8 or 16-bit file without a stated response is
// refused, because a guess would bend every number that follows. Every program reads its photographs here.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/image.h"
#include "manifest/value.h"

namespace gonio::photograph {

struct LinearPicture {
  std::string name;                   // for messages
  io::Image colour;                   // R, G, B or Y
  io::Image variance;                 // of the same channels, where the file has variance.R, ...; else empty
  std::vector<std::uint8_t> clipped;  // per pixel: a code at full scale, the light was brighter; EXR: none
  std::vector<std::uint8_t> dark;     // per value of `colour`: the lowest code, the light was darker; EXR: none
  int code_bits = 0;                  // 8 or 16; 0: an EXR's floats
  bool integer_codes() const { return code_bits > 0; }
};

// `saturation`: as the image states it (saturation.h). Error(data) at `place` where the response is missing or the file
// has neither R, G, B nor Y.
LinearPicture read_linear(const std::filesystem::path& path, const manifest::Value& response, const std::string& place,
                          std::optional<double> saturation = {});

}  // namespace gonio::photograph
