// A camera and a projector that stand over a turntable and look at what lies there from two sides. On it leans a
// ChArUco board: the table turns it to every side, which calibrates both. World: the turntable's plane is z = 0, its
// axis the z axis. Beside the board's drawing lies plate.json: what is so while a flat plate lies there instead.
#include "acquisition/desk/specimen_laboratory.h"
#include "base/atomic_file.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"
#include "render/specimen_board.h"

namespace gonio::acquisition {
namespace {

constexpr double height_m = 0.45, aside_m = 0.08;

manifest::Pose<frame::World, frame::Object> leaning(double tilt_rad, Vec3 middle_m) {
  return {{quaternion_of_rotation_vector({tilt_rad, 0.3 * tilt_rad, 0}), middle_m}, {}};
}

// The lens is told, too: what the description believes of it may be calibrated by then.
void write_plate(const manifest::Document& scanner, const std::filesystem::path& out) {
  manifest::Document there;
  there.cameras = scanner.cameras;
  there.meshes["plate"].plane_size_m = {0.16, 0.16};
  manifest::Surface& matte = there.surfaces["plate"];
  matte.model = "diffuse";
  matte.parameters["albedo"] = 0.7;
  there.objects.push_back(
      {.id = "plate", .mesh = "plate", .surface = "plate", .world_from_object = leaning(10 * degree, {0, 0, 0.03})});
  write_file(out / "plate.json", manifest::print_document(there, out));
}

}  // namespace

manifest::Document specimen_scanner(const std::filesystem::path& out) {
  manifest::Document document = render::board_specimen(out);
  manifest::keep_images(document, {});
  document.lights.clear();
  document.objects.front().world_from_object = leaning(28 * degree, {0.012, 0.008, 0.05});
  manifest::Camera& lens = document.cameras.at("camera");
  lens.width_px = 320;
  lens.height_px = 240;
  lens.fx_px = lens.fy_px = 460;
  lens.cx_px = 162;
  lens.cy_px = 118;
  write_plate(document, out);
  manifest::Light& light = document.lights["projector"];
  light.model = "projector";
  light.parameters = {{"position_m", std::vector<double>{aside_m, 0.02, height_m}},
                      {"direction", std::vector<double>{-aside_m, -0.02, -height_m}},
                      {"up", std::vector<double>{0, 1, 0}},
                      {"fx_px", 380.0},
                      {"fy_px", 381.0},
                      {"cx_px", 158.0},
                      {"cy_px", 123.0},
                      {"watt_per_sr", std::vector<double>{1, 1, 1}}};
  manifest::Laboratory& lab = document.laboratory.entry.emplace_back();
  manifest::LaboratoryCamera& camera = lab.cameras["camera"] = simulated_camera(0.032);
  static_cast<Rigid<frame::World, frame::Camera>&>(camera.world_from_camera.emplace()) =
      render::looking_at({-aside_m, 0, height_m}, {0, 0, 0.03}, {0, 1, 0}, {1, 0, 0});
  manifest::LaboratoryScreen& screen = lab.screens["projector"];
  screen.url = "sim://";
  screen.kind = "projector";
  screen.width_px = 320, screen.height_px = 240;
  manifest::LaboratoryTurntable& table = lab.turntables["table"];
  table.url = "sim://";
  table.carries = {"sheet"};
  table.speed_rad_per_s = 0.5;
  return document;
}

}  // namespace gonio::acquisition
