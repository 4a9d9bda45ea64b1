// See polarizer_array.h.
#include "photograph/polarizer_array.h"

#include <cmath>

#include "optics/mueller_algebra.h"
#include "photograph/mechanisms/lens_birefringence.h"
#include "photograph/mechanisms/polarizer_leak.h"
#include "photograph/polarizers.h"

namespace gonio::photograph {
namespace {

double axis_of(const PolarizerArray& array, int x, int y) {
  const double stated = polarizer_angle(x, y) + array.turn_rad;
  switch (polarizer_degrees(x, y)) {
    case 45: return stated + array.turn_45_rad;
    case 90: return stated + array.turn_90_rad;
    case 135: return stated + array.turn_135_rad;
    default: return stated;
  }
}

}  // namespace

std::array<double, 4> analyser(const PolarizerArray& array, int x, int y, Vec2 radius) {
  const double axis = axis_of(array, x, y);
  const auto reads = [&](double s0, double s1, double s2) {
    const double along = behind_polarizer(s0, s1, s2, axis);
    return equation::polarizer_leak(along, s0 - along, array.leak);
  };
  std::array<double, 4> row{reads(1, 0, 0), reads(0, 1, 0), reads(0, 0, 1), 0};
  const double square = radius.x * radius.x + radius.y * radius.y;
  if (array.retardance_rad == 0 || !(square > 0)) return row;
  // In the Stokes frame y points up.
  const optics::Mueller lens = optics::linear_retarder(std::atan2(-radius.y, radius.x),
                                                       equation::lens_birefringence(array.retardance_rad, square));
  std::array<double, 4> before{};
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) before[static_cast<std::size_t>(j)] += row[static_cast<std::size_t>(i)] * lens(i, j);
  return before;
}

}  // namespace gonio::photograph
