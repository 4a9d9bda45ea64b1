// A grid over a hemisphere, from the pole down, of the camera; of a lamp that an arm holds too, where it is given a
// radius: every place of the lamp with every place of the camera.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> hemisphere_steps(const PatternScene& scene, const PatternNumbers& n) {
  return grid_steps("hemisphere", scene, n, 0, 2 * pi);
}

}  // namespace

const ViewPattern& hemisphere() {
  static const ViewPattern pattern{
      "hemisphere", "The camera on a grid over a hemisphere, under every place of the lamp where that moves.",
      "Nicodemus et al. 1977; gantry goniometers", grid_parameters(), hemisphere_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
