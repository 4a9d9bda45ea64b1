// What the readers of height maps refuse in the same words.
#pragma once
#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"

namespace gonio::io {

inline constexpr std::int64_t most_points_a_side = 32768;

[[noreturn]] inline void refuse_map(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "copy it again, or export it as .x3p, .sur, .opd, .nms or .plu");
}

inline void check_map_size(std::int64_t width, std::int64_t height, const std::string& place) {
  if (width < 2 || height < 2 || width > most_points_a_side || height > most_points_a_side)
    refuse_map(place, "claims " + std::to_string(width) + " x " + std::to_string(height) +
                          " points, between 2 and 32768 a side are possible");
}

inline void check_map_bytes(std::size_t has, std::size_t wants, const std::string& place) {
  if (has < wants)
    refuse_map(place, "has " + std::to_string(has) + " bytes where its head asks for " + std::to_string(wants));
}

inline double checked_step(double metres, const char* axis, const std::string& place) {
  if (!(std::isfinite(metres) && metres > 0 && metres < 1))
    refuse_map(place, "states no step between points along " + std::string(axis));
  return metres;
}

}  // namespace gonio::io
