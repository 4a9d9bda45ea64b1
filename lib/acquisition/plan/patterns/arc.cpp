// A light arc and a camera: for every place of the camera each lamp in turn.
//
// The acquisition that this copies (Stets et al. 2017, "Scene reassembly after multimodal digitization and pipeline
// evaluation using photorealistic rendering", Applied Optics 56) states 11 lamps, steps of 7.5 degrees, neither 0 nor
// 90 degrees from the zenith, "one octant", and 2,783 pictures a material. 2,783 = 11 x 253 and 253 = 11 x 23: 11
// zeniths, 7.5 to 82.5 degrees, and 23 azimuths, which at that step span 165 degrees: half of the azimuths, not an
// octant, and half is what an isotropic surface needs under an arc in one plane (f depends on |phi|). Of the 25
// azimuths 0 to 180 degrees the text does not say which two it leaves out. Here they are the two beside the lamps, 0
// and 7.5 degrees, where the arc stands between camera and sample; 180 degrees, the mirror's plane, stays.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> arc_steps(const PatternScene& scene, const PatternNumbers& n) {
  need_lamps(scene, "arc");
  std::vector<manifest::PlanStep> steps;
  for (const Direction view : directions({n.at("step"), n.at("steepest"), n.at("flattest"),
                                          n.at("plane") + n.at("nearest"), n.at("plane") + n.at("farthest")}))
    for (const std::string& lamp : scene.lamps) {
      manifest::PlanStep step = view_step(scene, image_name("arc", steps.size()));
      step.world_from_camera = camera_at(scene, view, n.at("radius"));
      step.lamps = {lamp};
      steps.push_back(std::move(step));
    }
  return steps;
}

}  // namespace

const ViewPattern& arc() {
  static const ViewPattern pattern{
      "arc",
      "The camera on a grid beside a light arc, for every place each lamp of the arc in turn.",
      "Stets et al. 2017, section on reflectance: 2,783 pictures with 11 lamps",
      {{"radius", "m", 0.5, 0.01, 100, "of the camera from the target"},
       {"step", "rad", 7.5 * degree, 0.1 * degree, 90 * degree, "of zeniths and of azimuths"},
       {"steepest", "rad", 7.5 * degree, 0, pi / 2, "least zenith angle of the camera"},
       {"flattest", "rad", 82.5 * degree, 0, pi / 2, "largest zenith angle of the camera"},
       {"plane", "rad", 0, -2 * pi, 2 * pi, "azimuth at which the lamps stand"},
       {"nearest", "rad", 15 * degree, 0, 2 * pi, "least azimuth of the camera from the lamps' plane"},
       {"farthest", "rad", 180 * degree, 0, 2 * pi, "largest; the mirror directions lie at 180 degrees"}},
      arc_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
