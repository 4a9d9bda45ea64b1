// light.direction in a stack of lights: every lamp by itself.
#include <cmath>

#include "explain/stacks/light_binding.h"
#include "inference/sentence.h"
#include "light/turn.h"

namespace gonio::mechanism {
const Mechanism& light_direction();
}

namespace gonio::explain::stacks::lights {
namespace {

constexpr double likely_turn_rad = 0.1;  // of a lamp; also holds all of them, which could turn with all normals

void enter_tilts(StackEntry& entry) {
  std::vector<std::string> lamps;
  for (std::size_t g = 0; g < entry.stack.images.size(); ++g) {
    lamps.push_back(entry.stack.images[g].light);
    for (const char* axis : {"tilt_x_rad", "tilt_y_rad"}) {
      Parameter& tilt = entry.add_for(lamps.back(), axis, 0.05);
      tilt.groups = {g};
      tilt.prior_sigma = likely_turn_rad;
    }
  }
  entry.propose_all(lamps);
}

void turn_lamp(std::span<const double> p, std::size_t lamp, Vec3, PatchLight& light) {
  const double x = p[2 * lamp], y = p[2 * lamp + 1];
  if (x != 0 || y != 0) light.towards = light::turned(light.towards, x, y);
}

std::string how_far_off(std::span<const double> p) {
  double sum = 0;
  for (std::size_t k = 0; k + 1 < p.size(); k += 2) sum += std::hypot(p[k], p[k + 1]);
  return "The lamps stand " + printed(sum / (0.5 * static_cast<double>(p.size())) * 180 / pi) +
         " degrees away from where they were said to be, on average.";
}

}  // namespace

const LightBinding& light_direction() {
  static const LightBinding binding{.mechanism = mechanism::light_direction,
                                    .order = 30,
                                    .enter = enter_tilts,
                                    .aim = turn_lamp,
                                    .remark = how_far_off};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
