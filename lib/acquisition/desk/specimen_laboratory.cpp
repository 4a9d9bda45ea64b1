// The list of built-in laboratories, and their common parts.
#include "acquisition/desk/specimen_laboratory.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "manifest/document.h"

namespace gonio::acquisition {

std::span<const SpecimenLaboratory> specimen_laboratories() {
  static const std::array<SpecimenLaboratory, 6> all{
      {{"desk", "a UR5 that holds a camera over a board", specimen_desk},
       {"arc", "an IRB 1600 that holds a camera over a flat sample and a white tile, and a light arc of 11 lamps",
        specimen_arc},
       {"scanner", "a camera and a projector over a turntable on which a board leans, or a plate lies",
        specimen_scanner},
       {"stage",
        "the studio with an empty table and a drive that deforms the object \"sheet\" of a truth (nrsfm-make --object)",
        specimen_stage},
       {"studio", "two UR5, one with a camera, one with a lamp, round a knot on a table or a board", specimen_studio},
       {"turntable", "a UR3 that holds a camera behind polarizers over a varnished knot on a turntable",
        specimen_turntable}}};
  return all;
}

manifest::Document specimen_laboratory(const std::string& name, const std::filesystem::path& out) {
  const auto found = std::ranges::find(specimen_laboratories(), name, &SpecimenLaboratory::name);
  if (found != specimen_laboratories().end()) return found->make(out);
  std::string names;
  for (const SpecimenLaboratory& lab : specimen_laboratories()) names += (names.empty() ? "" : ", ") + lab.name;
  throw Error(Exit::usage, "--specimen", "there is no laboratory \"" + name + "\"", "there are " + names);
}

manifest::SolidBody box_body(const char* name, std::vector<double> sides_m, Vec3 middle_m) {
  manifest::SolidBody body;
  body.name = name;
  body.box_m = std::move(sides_m);
  body.world_from_body.emplace().translation_m = middle_m;
  return body;
}

manifest::SolidBody ball_body(const char* name, double radius_m, Vec3 middle_m) {
  manifest::SolidBody body;
  body.name = name;
  body.ball_m = radius_m;
  body.world_from_body.emplace().translation_m = middle_m;
  return body;
}

manifest::LaboratoryRobot simulated_arm(const char* model, Vec3 base_m, double turn_rad, std::vector<double> home_rad) {
  manifest::LaboratoryRobot robot;
  robot.url = "sim://";
  robot.model = model;
  robot.world_from_base.emplace() = {{quaternion_of_rotation_vector({0, 0, turn_rad}), base_m}, {}};
  robot.home_rad = std::move(home_rad);
  return robot;
}

manifest::LaboratoryCamera simulated_camera(double full_s) {
  manifest::LaboratoryCamera camera;
  camera.url = "sim://";
  camera.pixel_format = "Mono12";
  camera.white = 4095;
  camera.codes_per_radiance_s = 4095 / full_s;
  camera.black_code = 64;
  camera.electrons_per_code = 2.5;
  camera.read_electrons = 3;
  return camera;
}

void give_housing(manifest::LaboratoryRobot& robot, const char* name, std::vector<double> sides_m, double above_m) {
  manifest::SolidBody body;
  body.name = name;
  body.tool_from_body.emplace().translation_m = {0, 0, above_m + sides_m[2] / 2};
  body.box_m = std::move(sides_m);
  robot.carries.push_back(std::move(body));
}

}  // namespace gonio::acquisition
