#include "render/specimen_board.h"

#include <cmath>

#include "base/atomic_file.h"
#include "camera/board_drawing.h"
#include "geom/rigid.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/specimen_camera.h"

namespace gonio::render {
namespace {

constexpr double distance_m = 0.32, millimetre = 1e-3;

// Looks at `target_m` from `distance_m` away: straight down on the board first, then tilted about the world's x and y
// axes and rolled.
Rigid<frame::World, frame::Camera> view(double tilt_x_rad, double tilt_y_rad, double roll_rad, Vec3 target_m) {
  const Quaternion down{0, 1, 0, 0};  // camera z to world -z, camera y to world -y
  const Quaternion tilt =
      quaternion_of_rotation_vector({tilt_x_rad, 0, 0}) * quaternion_of_rotation_vector({0, tilt_y_rad, 0});
  const Quaternion rotation = normalized(tilt * down * quaternion_of_rotation_vector({0, 0, roll_rad}));
  return {rotation, target_m - matrix_of(rotation) * Vec3{0, 0, distance_m}};
}

void add_views(manifest::Document& document) {
  for (int i = 0; i < 12; ++i) {
    const double turn = 2 * pi * i / 12;
    const auto pose = view(0.5 * std::cos(turn), 0.5 * std::sin(turn), 0.3 * std::sin(2 * turn),
                           {0.03 * std::cos(3 * turn), 0.03 * std::sin(5 * turn), 0});
    add_view(document, {.id = "board-" + std::string(i < 10 ? "0" : "") + std::to_string(i),
                        .world_from_camera = {pose, {}},
                        .light = {"lamp"}});
  }
}

}  // namespace

manifest::Board specimen_board_section() {
  manifest::Board section;
  section.kind = "charuco";
  section.squares = {9, 7};
  section.square_m = 0.02;
  section.marker_m = 0.015;
  section.dictionary = "4X4_50";
  return section;
}

manifest::Document board_specimen(const std::filesystem::path& out) {
  manifest::Document document;
  const manifest::Board section = specimen_board_section();
  const camera::Board board = camera::board_of(section, "built-in board");
  const camera::Drawing drawing = camera::lay_out(board, "fit", "built-in board");
  make_folder(out);
  write_file(out / "board.png", camera::png_of(board, drawing, 400, "built-in board"));
  document.surfaces["print"].textures["albedo"] = manifest::add_file(document, out / "board.png", "board");
  document.meshes["sheet"].plane_size_m = {drawing.width_mm * millimetre, drawing.height_mm * millimetre};
  document.objects.push_back({.id = "sheet", .mesh = "sheet", .surface = "print", .world_from_object = {}});
  manifest::Light& lamp = document.lights["lamp"];
  lamp.model = "directional";
  lamp.parameters = {{"towards", std::vector<double>{0.28, 0, 0.96}}, {"watt_per_m2", 2.5}};
  manifest::Camera& camera = document.cameras["camera"];
  camera.model = "radial-tangential";
  camera.width_px = 800;
  camera.height_px = 600;
  camera.fx_px = camera.fy_px = 900;
  camera.cx_px = 405;
  camera.cy_px = 296;
  camera.distortion = {{"k1", -0.22}, {"k2", 0.09}};
  add_views(document);
  return document;
}

}  // namespace gonio::render
