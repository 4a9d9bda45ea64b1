// The goniometer of Stets et al. 2017: an IRB 1600 that holds a camera over a flat sample and a white tile, and a light
// arc of 11 lamps in the half plane y = 0, x > 0. World: the sample's middle is the origin, z its normal. The arm
// stands where the camera is to be: at y > 0.
#include "acquisition/desk/specimen_laboratory.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "render/specimen_goniometer.h"

namespace gonio::acquisition {

manifest::Document specimen_arc(const std::filesystem::path&) {
  manifest::Document document = render::goniometer_specimen({});
  document.images.clear();
  manifest::Laboratory& lab = document.laboratory.entry.emplace_back();
  lab.robots["arm"] = simulated_arm("abb-irb-1600", {0, 1.05, -0.55}, -pi / 2, {0, 0, 0, 0, pi / 2, 0});
  give_housing(lab.robots["arm"], "camera", {0.06, 0.06, 0.1}, 0.04);
  manifest::LaboratoryCamera& camera = lab.cameras["camera"] = simulated_camera(0.02);
  camera.robot = "arm";
  camera.tool_from_camera.emplace().translation_m = {0, 0, 0.12};
  for (const auto& [name, light] : document.lights) {
    lab.lamps[name].url = "sim://";
    lab.obstacles.push_back(ball_body(name.c_str(), 0.015, light.parameters.at("position_m").vector()));
  }
  lab.obstacles.push_back(box_body("pedestal", {0.05, 0.05, 0.5}, {0, 0, -0.27}));
  lab.limits.emplace().speed_m_per_s = 0.5;
  return document;
}

}  // namespace gonio::acquisition
