// polarizer.angle: axes of the camera's own polarizers.
#include "photograph/mechanisms/polarizer_angle.h"

#include "photograph/polarizer_array.h"
#include "render/link.h"

namespace gonio::render::links {
namespace {

void make(std::span<const double> p, photograph::PolarizerArray& array) {
  array.turn_rad = p[0], array.turn_45_rad = p[1], array.turn_90_rad = p[2], array.turn_135_rad = p[3];
}

}  // namespace

const Link& polarizer_angle() {
  static const Link link{.mechanism = mechanism::polarizer_angle, .step = Step::polarizers, .polarizers = make};
  return link;
}

}  // namespace gonio::render::links
