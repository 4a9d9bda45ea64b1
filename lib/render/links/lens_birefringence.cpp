// lens.birefringence: before the camera's own polarizers.
#include "photograph/mechanisms/lens_birefringence.h"

#include "photograph/polarizer_array.h"
#include "render/link.h"

namespace gonio::render::links {
namespace {

void make(std::span<const double> p, photograph::PolarizerArray& array) {
  array.retardance_rad = p[0];
}

}  // namespace

const Link& lens_birefringence() {
  static const Link link{.mechanism = mechanism::lens_birefringence, .step = Step::polarizers, .polarizers = make};
  return link;
}

}  // namespace gonio::render::links
