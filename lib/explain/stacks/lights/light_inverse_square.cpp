// light.inverse-square in a stack of lights, whose unit of length is half the picture's width.
#include "light/mechanisms/light_inverse_square.h"

#include "explain/stacks/light_binding.h"
#include "inference/sentence.h"

namespace gonio::explain::stacks::lights {
namespace {

constexpr double nearest = 0.7;  // half widths' inverse: a lamp just outside the picture

void enter_nearness(StackEntry& entry) {
  entry.add("nearness_per_m", 0.1).upper = nearest;
  entry.propose_all();
}

void bring_near(std::span<const double> p, std::size_t, Vec3 at, PatchLight& light) {
  light = seen_from(light, at, p[0]);
}

std::string how_far_away(std::span<const double> p) {
  return "The lamps stand " + printed(1 / p[0]) +
         " half widths of the picture away; without a scale the manifest cannot say so in metres.";
}

}  // namespace

const LightBinding& light_inverse_square() {
  static const LightBinding binding{.mechanism = mechanism::light_inverse_square,
                                    .order = 40,
                                    .written = Written::nowhere,
                                    .enter = enter_nearness,
                                    .aim = bring_near,
                                    .remark = how_far_away};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
