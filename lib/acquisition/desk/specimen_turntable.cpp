// A UR3 that holds a camera behind polarizers over a turntable, after the rig of the thesis's chapter on glass: a knot
// whose smooth varnish polarizes turns under one lamp. World: the turntable's plane is z = 0, its axis the z axis.
#include "acquisition/desk/specimen_laboratory.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/surface.h"
#include "render/specimen.h"

namespace gonio::acquisition {

manifest::Document specimen_turntable(const std::filesystem::path& out) {
  manifest::Document document = render::specimen("knot", out);
  document.images.clear();
  document.lights.clear();
  document.lights["lamp"].parameters = {{"position_m", std::vector<double>{0.2, -0.15, 0.45}},
                                        {"watt_per_sr", std::vector<double>{1, 1, 1}}};
  manifest::Surface& varnished = document.surfaces.at("knot");
  varnished.model = "interfaced-diffuse";
  varnished.parameters["eta"] = 1.5;
  varnished.parameters["alpha"] = 0.15;
  manifest::Camera& lens = document.cameras.at("camera");
  lens.width_px = 320;
  lens.height_px = 240;
  lens.fx_px = lens.fy_px = 430;
  lens.cx_px = 159.5;
  lens.cy_px = 119.5;
  lens.mosaic = "polarizers";
  manifest::Laboratory& lab = document.laboratory.entry.emplace_back();
  lab.robots["arm"] = simulated_arm("ur3", {-0.35, 0, 0}, pi, {0, -1.9, 1.9, -pi / 2, -pi / 2, 0});
  give_housing(lab.robots["arm"], "camera", {0.05, 0.05, 0.06});
  manifest::LaboratoryCamera& camera = lab.cameras["camera"] = simulated_camera(0.04);
  camera.robot = "arm";
  camera.tool_from_camera.emplace().translation_m = {0, 0, 0.05};
  lab.lamps["lamp"].url = "sim://";
  manifest::LaboratoryTurntable& table = lab.turntables["table"];
  table.url = "sim://";
  table.carries = {"knot", "table"};
  table.speed_rad_per_s = 0.5;
  table.acceleration_rad_per_s2 = 1;
  lab.obstacles = {box_body("turntable", {2, 2, 0.05}, {0, 0, -0.035}),
                   box_body("knot", {0.14, 0.14, 0.08}, {0, 0, 0.04})};
  lab.limits.emplace().speed_m_per_s = 0.25;
  return document;
}

}  // namespace gonio::acquisition
