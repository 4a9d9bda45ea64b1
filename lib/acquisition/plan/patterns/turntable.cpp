// The object turns on its table before a camera that stands; at some heights of the camera, the table turning on each.
#include "acquisition/plan/view_steps.h"
#include "base/error.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> turntable_steps(const PatternScene& scene, const PatternNumbers& n) {
  if (scene.turntable.empty())
    throw Error(Exit::usage, "turntable", "no turntable is named", "name one of the laboratory's");
  const double span = n.at("span");
  std::vector<manifest::PlanStep> steps;
  for (const double elevation : stepped(n.at("lowest"), n.at("highest"), n.at("elevation-step")))
    for (const double angle : stepped(0, span, n.at("step"))) {
      if (span > 2 * pi - 1e-9 && angle > 2 * pi - 1e-9) continue;  // the first again
      manifest::PlanStep step = view_step(scene, image_name("turntable", steps.size()));
      if (n.at("radius") > 0)
        step.world_from_camera = camera_at(scene, {pi / 2 - elevation, n.at("azimuth")}, n.at("radius"));
      step.turntable_rad[scene.turntable] = n.at("first") + angle;
      steps.push_back(std::move(step));
    }
  return steps;
}

}  // namespace

const ViewPattern& turntable() {
  static const ViewPattern pattern{
      "turntable",
      "The object turned in steps before a camera at some heights.",
      "series for shape and polarization on a turntable",
      {{"step", "rad", 10 * degree, 0.01 * degree, 360 * degree, "of the table"},
       {"first", "rad", 0, -1000, 1000, "angle of the table at which the series begins"},
       {"span", "rad", 360 * degree, 0, 360 * degree, "of the table; of a full turn the last angle is left out"},
       {"radius", "m", 0.5, 0, 100, "of the camera from the target; 0: the camera stays where it stands"},
       {"azimuth", "rad", 0, -2 * pi, 2 * pi, "of the camera"},
       {"lowest", "rad", 30 * degree, -90 * degree, 90 * degree, "elevation of the camera"},
       {"highest", "rad", 30 * degree, -90 * degree, 90 * degree, "its last elevation"},
       {"elevation-step", "rad", 15 * degree, degree, 90 * degree, "between elevations"}},
      turntable_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
