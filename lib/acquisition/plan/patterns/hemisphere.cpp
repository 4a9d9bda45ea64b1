// A grid over a hemisphere, from the pole down, of the camera; of a lamp that an arm holds too, where it is given a
// radius: every place of the lamp with every place of the camera.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> hemisphere_steps(const PatternScene& scene, const PatternNumbers& n) {
  const std::vector<Direction> views =
      directions({n.at("step"), pi / 2 - n.at("highest"), pi / 2 - n.at("lowest"), 0, 2 * pi, n.at("even") > 0.5});
  std::vector<std::vector<double>> places{{}};
  if (n.at("lamp-radius") > 0) {
    need_lamps(scene, "hemisphere");
    places.clear();
    for (const Direction d : directions({n.at("lamp-step"), 0, pi / 2 - n.at("lamp-lowest"), 0, 2 * pi, true})) {
      const Vec3 p = place_at(scene, d, n.at("lamp-radius"));
      places.push_back({p.x, p.y, p.z});
    }
  }
  std::vector<manifest::PlanStep> steps;
  for (const std::vector<double>& place : places)
    for (const Direction view : views) {
      manifest::PlanStep step = view_step(scene, image_name("hemisphere", steps.size()));
      step.world_from_camera = camera_at(scene, view, n.at("radius"));
      step.light_m = place;
      steps.push_back(std::move(step));
    }
  return steps;
}

std::vector<PatternParameter> hemisphere_parameters() {
  std::vector<PatternParameter> all = sphere_parameters();
  all.push_back({"lamp-radius", "m", 0, 0, 100, "of the first lamp from the target; 0: the lamp is not moved"});
  all.push_back({"lamp-step", "rad", 30 * degree, degree, 90 * degree, "between the lamp's directions, about evenly"});
  all.push_back({"lamp-lowest", "rad", 30 * degree, 0, 90 * degree, "the lamp's lowest elevation"});
  return all;
}

}  // namespace

const ViewPattern& hemisphere() {
  static const ViewPattern pattern{
      "hemisphere", "The camera on a grid over a hemisphere, under every place of the lamp where that moves.",
      "Nicodemus et al. 1977; gantry goniometers", hemisphere_parameters(), hemisphere_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
