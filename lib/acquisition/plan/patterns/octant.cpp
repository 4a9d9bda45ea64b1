// A grid over a part of the hemisphere between two azimuths, the pole among them where asked; under every place of a
// lamp that moves.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> octant_steps(const PatternScene& scene, const PatternNumbers& n) {
  return grid_steps("octant", scene, n, n.at("azimuth"), n.at("span"));
}

std::vector<PatternParameter> octant_parameters() {
  std::vector<PatternParameter> all = grid_parameters();
  all.push_back({"azimuth", "rad", 0, -2 * pi, 2 * pi, "at which the octant begins"});
  all.push_back({"span", "rad", pi / 2, 0, 2 * pi, "of azimuths"});
  return all;
}

}  // namespace

const ViewPattern& octant() {
  static const ViewPattern pattern{
      "octant", "The camera on a grid over a quarter of the hemisphere, an eighth of the sphere.",
      "isotropic surfaces, whose reflectance repeats round the normal", octant_parameters(), octant_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
