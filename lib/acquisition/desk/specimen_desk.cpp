// A UR5 that holds a camera over a ChArUco board on a table, under a lamp. World: the board's middle is the origin, z
// towards the camera. The base is turned half about, so that the arm reaches over the board with its first joint near
// 0.
#include "acquisition/desk/specimen_laboratory.h"
#include "camera/board.h"
#include "camera/board_drawing.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "render/specimen_board.h"

namespace gonio::acquisition {
namespace {

// Where the board lies on its sheet, whose middle is the page's, x to the right and y up.
manifest::Link sheet_from_board(const manifest::Board& section) {
  const camera::Board board = camera::board_of(section, "built-in board");
  const camera::Drawing drawing = camera::lay_out(board, "fit", "built-in board");
  const Quaternion down = quaternion_of_rotation_vector({pi, 0, 0});  // a board's y runs down its rows, its z away
  const Vec2 corner = board.squares_origin_m();
  const Vec3 outer{1e-3 * (drawing.board_mm.x - 0.5 * drawing.width_mm),
                   1e-3 * (0.5 * drawing.height_mm - drawing.board_mm.y), 0};
  manifest::Link link;
  link.to = "sheet";
  link.from = "board";
  link.rotation = down;
  link.translation_m = outer - matrix_of(down) * Vec3{corner.x, corner.y, 0};
  return link;
}

}  // namespace

manifest::Document specimen_desk(const std::filesystem::path& out) {
  manifest::Document document = render::board_specimen(out);
  document.images.clear();
  document.frames.push_back(sheet_from_board(render::specimen_board_section()));
  manifest::Camera& lens = document.cameras.at("camera");
  lens.width_px = 640;  // pictures that a desk computer renders while one waits
  lens.height_px = 480;
  lens.fx_px = lens.fy_px = 720;
  lens.cx_px = 324;
  lens.cy_px = 237;
  manifest::Laboratory& lab = document.laboratory.entry.emplace_back();
  lab.robots["arm"] = simulated_arm("ur5", {-0.45, 0, 0}, pi, {0, -1.9, 1.9, -pi / 2, -pi / 2, 0});
  give_housing(lab.robots["arm"], "camera", {0.06, 0.06, 0.09});
  manifest::LaboratoryCamera& camera = lab.cameras["camera"] = simulated_camera(0.01);
  camera.robot = "arm";
  camera.tool_from_camera.emplace() = {{quaternion_of_rotation_vector({0.01, -0.02, 0.8}), {0.01, -0.02, 0.07}}, {}};
  lab.lamps["lamp"].url = "sim://";
  lab.obstacles = {box_body("table", {2, 2, 0.05}, {0, 0, -0.035})};
  lab.limits.emplace().speed_m_per_s = 0.25;
  return document;
}

}  // namespace gonio::acquisition
