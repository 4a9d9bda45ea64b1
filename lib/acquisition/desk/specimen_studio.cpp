// Two UR5 round a table, as Stets et al. 2017 used them: the left one holds a camera, the right one a lamp. On the
// table a knot, whose surface is believed to be matte. World: the table's plane is z = 0, the knot stands over the
// origin. Beside its mesh lies board.json: what is so while a ChArUco board lies there instead.
#include "acquisition/desk/specimen_laboratory.h"
#include "base/atomic_file.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/specimen.h"
#include "render/specimen_board.h"

namespace gonio::acquisition {
namespace {

// The board lies where the knot stands otherwise; the lens is that of its own camera, at a smaller size.
void write_board(const manifest::Document& board, const std::filesystem::path& out) {
  manifest::Document there;
  there.folder = board.folder;
  there.files = board.files;
  there.meshes = board.meshes;
  there.surfaces = board.surfaces;
  there.objects = board.objects;
  write_file(out / "board.json", manifest::print_document(there, out));
}

manifest::Camera studio_lens(manifest::Camera lens) {
  lens.width_px = 320;
  lens.height_px = 240;
  lens.fx_px = lens.fy_px = 430;
  lens.cx_px = 161;
  lens.cy_px = 119;
  return lens;
}

}  // namespace

manifest::Document specimen_studio(const std::filesystem::path& out) {
  manifest::Document document = render::specimen("knot", out);
  document.images.clear();
  document.lights.clear();
  document.lights["lamp"].parameters = {{"position_m", std::vector<double>{0.25, -0.25, 0.4}},
                                        {"watt_per_sr", std::vector<double>{1, 1, 1}}};
  const manifest::Document board = render::board_specimen(out);
  write_board(board, out);
  document.cameras = {{"camera", studio_lens(board.cameras.at("camera"))}};
  manifest::Laboratory& lab = document.laboratory.entry.emplace_back();
  lab.robots["left"] = simulated_arm("ur5", {-0.45, -0.15, 0}, pi, {0, -1.9, 1.9, -pi / 2, -pi / 2, 0});
  lab.robots["right"] = simulated_arm("ur5", {0.5, 0.1, 0}, 0, {-pi / 2, -1.9, 1.9, -pi / 2, -pi / 2, 0});
  give_housing(lab.robots["left"], "camera", {0.06, 0.06, 0.09});
  give_housing(lab.robots["right"], "lamp", {0.05, 0.05, 0.05});
  manifest::LaboratoryCamera& camera = lab.cameras["camera"] = simulated_camera(0.04);
  camera.robot = "left";
  camera.tool_from_camera.emplace() = {{quaternion_of_rotation_vector({0.01, -0.02, 0.8}), {0.01, -0.02, 0.07}}, {}};
  manifest::LaboratoryLamp& lamp = lab.lamps["lamp"];
  lamp.url = "sim://";
  lamp.robot = "right";
  lamp.in_tool_m = {0, 0, 0.06};
  lab.obstacles = {box_body("table", {2, 2, 0.05}, {0, 0, -0.035}), box_body("knot", {0.14, 0.14, 0.08}, {0, 0, 0.04})};
  lab.limits.emplace().speed_m_per_s = 0.25;
  return document;
}

}  // namespace gonio::acquisition
