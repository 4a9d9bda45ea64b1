// One view at exposures that double: all of them a single step, a bracket. The acquisition's "11 exposures at one-stop
// intervals ranging from 1 to 2048 ms" are 12 where both ends count (2048 = 2^11): the ends are taken at their word.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> hdr_steps(const PatternScene& scene, const PatternNumbers& n) {
  manifest::PlanStep step = view_step(scene, image_name("hdr", 0));
  step.exposures_s = bracket(n.at("shortest"), n.at("longest"), n.at("stops"));
  if (n.at("radius") > 0)
    step.world_from_camera = camera_at(scene, {pi / 2 - n.at("elevation"), n.at("azimuth")}, n.at("radius"));
  return {step};
}

}  // namespace

const ViewPattern& hdr() {
  static const ViewPattern pattern{
      "hdr",
      "One view at a bracket of exposures.",
      "Debevec & Malik 1997; 1 to 2048 ms: Stets et al. 2017",
      {{"shortest", "s", 0.001, 1e-7, 1000, "exposure"},
       {"longest", "s", 2.048, 1e-7, 1000, "exposure"},
       {"stops", "1", 1, 0.1, 10, "between neighbours: each is 2^stops as long as the one before"},
       {"radius", "m", 0, 0, 100, "of the camera from the target; 0: the camera stays where it stands"},
       {"elevation", "rad", 90 * degree, -90 * degree, 90 * degree, "of the camera"},
       {"azimuth", "rad", 0, -2 * pi, 2 * pi, "of the camera"}},
      hdr_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
