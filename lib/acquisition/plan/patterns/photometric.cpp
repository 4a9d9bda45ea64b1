// One view under each lamp in turn: photometric stereo. Where an arm holds the lamp and it is given a radius, its
// places on a cone instead.
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> photometric_steps(const PatternScene& scene, const PatternNumbers& n) {
  need_lamps(scene, "photometric");
  manifest::PlanStep like = view_step(scene, "");
  if (n.at("radius") > 0)
    like.world_from_camera = camera_at(scene, {pi / 2 - n.at("elevation"), n.at("azimuth")}, n.at("radius"));
  std::vector<manifest::PlanStep> steps;
  const auto add = [&] {
    steps.push_back(like);
    steps.back().image = image_name("photometric", steps.size() - 1);
  };
  if (n.at("lamp-radius") > 0) {
    const auto places = static_cast<int>(n.at("lamp-places"));
    for (int k = 0; k < places; ++k) {
      const Vec3 p = place_at(scene, {pi / 2 - n.at("lamp-elevation"), 2 * pi * k / places}, n.at("lamp-radius"));
      like.light_m = {p.x, p.y, p.z};
      add();
    }
    return steps;
  }
  for (const std::string& lamp : scene.lamps) {
    like.lamps = {lamp};
    add();
  }
  return steps;
}

}  // namespace

const ViewPattern& photometric() {
  static const ViewPattern pattern{
      "photometric",
      "One view under each lamp in turn, or under one lamp from places on a cone.",
      "Woodham 1980",
      {{"radius", "m", 0, 0, 100, "of the camera from the target; 0: the camera stays where it stands"},
       {"elevation", "rad", 90 * degree, -90 * degree, 90 * degree, "of the camera"},
       {"azimuth", "rad", 0, -2 * pi, 2 * pi, "of the camera"},
       {"lamp-radius", "m", 0, 0, 100, "of the first lamp from the target; 0: each lamp where it stands"},
       {"lamp-elevation", "rad", 45 * degree, -90 * degree, 90 * degree, "of the lamp's places"},
       {"lamp-places", "1", 8, 3, 100000, "on the cone"}},
      photometric_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
