// A grid over a part of the hemisphere between two azimuths, the pole among them where asked.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> octant_steps(const PatternScene& scene, const PatternNumbers& n) {
  const double first = n.at("azimuth");
  std::vector<manifest::PlanStep> steps;
  for (const Direction view : directions({n.at("step"), pi / 2 - n.at("highest"), pi / 2 - n.at("lowest"), first,
                                          first + n.at("span"), n.at("even") > 0.5})) {
    steps.push_back(view_step(scene, image_name("octant", steps.size())));
    steps.back().world_from_camera = camera_at(scene, view, n.at("radius"));
  }
  return steps;
}

std::vector<PatternParameter> octant_parameters() {
  std::vector<PatternParameter> all = sphere_parameters();
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
