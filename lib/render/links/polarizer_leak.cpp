// polarizer.leak: extinction of the camera's own polarizers.
#include "photograph/mechanisms/polarizer_leak.h"

#include "photograph/polarizer_array.h"
#include "render/link.h"

namespace gonio::render::links {
namespace {

void make(std::span<const double> p, photograph::PolarizerArray& array) {
  array.leak = p[0];
}

}  // namespace

const Link& polarizer_leak() {
  static const Link link{.mechanism = mechanism::polarizer_leak, .step = Step::polarizers, .polarizers = make};
  return link;
}

}  // namespace gonio::render::links
