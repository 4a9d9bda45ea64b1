#include "robot/handeye_document.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "camera/board.h"
#include "camera/board_place.h"
#include "camera/corner_table.h"
#include "camera/intrinsics.h"
#include "manifest/document.h"
#include "manifest/measured_views.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mounting.h"

namespace gonio::robot {
namespace {

using handeye::Kind;
constexpr std::size_t fewest_poses = 3, fewest_corners = 4;
constexpr double no_motion_m = 1e-6, no_motion_rad = 1e-6;

std::string image_place(const manifest::Document& document, std::size_t i, const std::string& member) {
  return manifest::place(document, "/images/" + std::to_string(i) + member);
}

std::string the_one(const std::string& asked, const std::string& of_table, const std::vector<std::string>& known,
                    const std::string& what, const manifest::Document& document) {
  const std::string name = !asked.empty() ? asked : !of_table.empty() ? of_table : known.size() == 1 ? known[0] : "";
  if (std::ranges::find(known, name) != known.end()) return name;
  throw Error(Exit::data, manifest::place(document, "/" + what + "s"),
              name.empty() ? "say which " + what + " was used" : "has no " + what + " \"" + name + "\"",
              "calib-charuco writes one; --" + what + " chooses among several");
}

template <class Map>
std::vector<std::string> keys(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

void enter_lens_covariance(const manifest::Value& value, handeye::Setup& setup) {
  const manifest::Value* order = value.find("order");
  const manifest::Value* rows = value.find("values");
  if (order == nullptr || rows == nullptr || !order->is_array() || !rows->is_array()) return;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < order->as_array().size(); ++i) {
    const std::string name = order->as_array()[i].as_string();
    const bool known = std::ranges::find(camera::distortion_names, name) != camera::distortion_names.end();
    if (!known && name != "fx_px" && name != "fy_px" && name != "cx_px" && name != "cy_px") continue;
    setup.lens_order.push_back(name);
    kept.push_back(i);
  }
  for (const std::size_t i : kept) {
    for (const std::size_t j : kept)
      setup.lens_covariance.push_back(rows->as_array().at(i).as_array().at(j).as_number());
  }
}

handeye::Setup setup_of(const manifest::Document& document, const HandEyeRequest& request, const HandEyeInput& input) {
  handeye::Setup setup;
  setup.kind = request.kind;
  const manifest::Camera& camera = document.cameras.at(input.camera);
  setup.lens = camera::intrinsics_of(camera, manifest::place(document, "/cameras/" + input.camera));
  setup.width_px = camera.width_px;
  setup.height_px = camera.height_px;
  enter_lens_covariance(camera.covariance, setup);
  const manifest::Board& board = document.boards.at(input.board);
  setup.extent = camera::board_of(board, manifest::place(document, "/boards/" + input.board)).extent();
  if (board.warp.contains("x_m")) setup.warp.sag_x_m = board.warp.at("x_m").scalar();
  if (board.warp.contains("y_m")) setup.warp.sag_y_m = board.warp.at("y_m").scalar();
  return setup;
}

// The pose of the board in an image, also where the image shows several boards.
const manifest::Pose<frame::Camera, frame::Board>* pose_in(const manifest::ImageEntry& image,
                                                           const std::string& board) {
  for (const manifest::SeenBoard& seen : image.boards) {
    if (seen.board == board && seen.camera_from_board && seen.weight.value_or(1) > 0) return &*seen.camera_from_board;
  }
  if (image.board.empty() || image.board == board) return image.camera_from_board ? &*image.camera_from_board : nullptr;
  return nullptr;
}

void check_motion(const manifest::Document& document, const HandEyeInput& input) {
  const std::size_t n = input.views.size();
  if (n < fewest_poses) {
    throw Error(
        Exit::data, manifest::place(document, "/images"),
        std::to_string(n) + (n == 1 ? " pose with a board" : " poses with a board") + " (at least 3 are needed)",
        "photograph the board from ten or more poses with turns about different axes");
  }
  const auto& first = input.views.front().base_from_tool;
  const bool moves = std::ranges::any_of(input.views, [&](const handeye::View& view) {
    const auto between = inverse(first) * view.base_from_tool;
    return norm(between.translation_m) > no_motion_m || norm(rotation_vector_of(between.rotation)) > no_motion_rad;
  });
  if (moves) return;
  throw Error(Exit::data, manifest::place(document, "/images"), "the robot's poses are all the same",
              "give the pose at which each image was taken");
}

std::string text(const char* format, auto... values) {
  char line[300];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

template <class To, class From, class A, class B>
manifest::Pose<To, From> posed(const Rigid<A, B>& pose, const handeye::Analysis& a, std::size_t first) {
  manifest::Pose<To, From> result;
  result.rotation = pose.rotation;
  result.translation_m = pose.translation_m;
  if (a.method != "joint") return result;
  const auto s = [&](std::size_t k) { return a.consensus.refined.sigma(first + k); };
  result.sigma = manifest::PoseSigma{{s(0), s(1), s(2)}, {s(3), s(4), s(5)}};
  return result;
}

manifest::Value covariance_of(const handeye::Analysis& a, const std::string& x, const std::string& z) {
  if (a.method != "joint" || !a.observability.unobservable.empty()) return {};
  manifest::Value order = manifest::Value::array(), values = manifest::Value::array();
  for (const std::string& pose : {x, z}) {
    for (const char* part : {"rotation_x_rad", "rotation_y_rad", "rotation_z_rad", "x_m", "y_m", "z_m"}) {
      order.push_back(pose + "." + part);
    }
  }
  for (std::size_t i = 0; i < 12; ++i) {
    const auto* row = a.consensus.refined.covariance.data() + 12 * i;
    values.push_back(manifest::Value(std::vector<double>(row, row + 12)));
  }
  return manifest::Value::object({{"order", order}, {"values", values}});
}

template <class To, class From>
void enter_frame(const std::string& to, const std::string& from, const std::optional<manifest::Pose<To, From>>& pose,
                 manifest::Document& document) {
  std::erase_if(document.frames, [&](const manifest::Link& link) { return link.to == to && link.from == from; });
  if (pose) document.frames.push_back({to, from, pose->rotation, pose->translation_m, pose->sigma});
}

void enter_errors(const handeye::Analysis& a, manifest::Mounting& m) {
  m.scatter_m = a.scatter.translation_m;
  m.scatter_rad = a.scatter.rotation_rad;
  m.rms_px = a.rms_px;
  if (const auto* errors = a.held_out_of(a.method)) {
    m.held_out = manifest::HeldOut{errors->rms.rms_px, errors->rms.translation_m, errors->rms.rotation_rad};
  }
  m.parts = manifest::ScatterParts{a.parts.robot_m, a.parts.camera_m, std::nullopt, a.parts.unexplained_m};
}

// Of a board whose place in the world is known, calib-charuco has placed the images that show it; the others are seen
// from where the calibrated mounting holds the camera, unless their step was seen from a board in another run.
void place_cameras(const manifest::Mounting& m, manifest::Document& document) {
  const auto board = camera::world_from_board(document, m.board);
  if (!board || !m.tool_from_camera || !m.base_from_board) return;
  const Rigid<frame::World, frame::Base> world_from_base = *board * inverse(*m.base_from_board);
  for (manifest::ImageEntry& image : document.images) {
    if (image.camera != m.camera || !image.base_from_tool || pose_in(image, m.board) != nullptr) continue;
    if (manifest::is_remembered(document, image, "calib-charuco")) continue;
    if (!m.robot.empty() && !image.robot.empty() && image.robot != m.robot) continue;
    if (!image.world_from_camera) image.world_from_camera.emplace();
    static_cast<Rigid<frame::World, frame::Camera>&>(*image.world_from_camera) =
        world_from_base * *image.base_from_tool * *m.tool_from_camera;
    manifest::remember_view(document, image, "handeye");
  }
}

double mean_sigma_px(const HandEyeInput& input) {
  double squares = 0, n = 0;
  for (const handeye::View& view : input.views) {
    for (const handeye::SeenCorner& corner : view.corners) {
      squares += corner.sigma_px * corner.sigma_px;
      ++n;
    }
  }
  return n > 0 ? std::sqrt(squares / n) : 0;
}

}  // namespace

void enter_poses(const PoseList& list, bool by_name, manifest::Document& document) {
  const std::string place = manifest::place(document, "/images");
  if (list.poses.size() != document.images.size()) {
    throw Error(Exit::data, list.poses.empty() ? "--poses" : list.poses.front().place,
                std::to_string(list.poses.size()) + " poses for " + std::to_string(document.images.size()) +
                    " images of " + place,
                "give one pose per image, also for images without a board");
  }
  std::map<std::string, const ListedPose*> named;
  for (const ListedPose& pose : list.poses) named[pose.name] = &pose;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    manifest::ImageEntry& image = document.images[i];
    const auto found = by_name ? named.find(image.id) : named.end();
    if (by_name && found == named.end()) {
      throw Error(Exit::data, image_place(document, i, "/id"), "no pose is named \"" + image.id + "\"",
                  "name every pose by its image, or leave out --match");
    }
    const ListedPose& pose = by_name ? *found->second : list.poses[i];
    if (image.base_from_tool) {
      throw Error(Exit::data, image_place(document, i, "/base_from_tool"), "stands beside --poses",
                  "give the pose once");
    }
    image.base_from_tool.emplace();
    static_cast<Rigid<frame::Base, frame::Tool>&>(*image.base_from_tool) = pose.base_from_tool;
  }
}

HandEyeInput handeye_input(const manifest::Document& document, const HandEyeRequest& request) {
  HandEyeInput input;
  const camera::CornerTable table = camera::read_corners(document, request.table);
  input.camera = the_one(request.camera, table.camera, keys(document.cameras), "camera", document);
  input.board = the_one(request.board, table.board, keys(document.boards), "board", document);
  input.robot = request.robot;
  input.setup = setup_of(document, request, input);
  std::map<std::string, const camera::ImageCorners*> corners;
  for (const camera::ImageCorners& group : table.images) corners[group.image] = &group;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (!image.camera.empty() && image.camera != input.camera) continue;
    if (!request.robot.empty() && !image.robot.empty() && image.robot != request.robot) continue;
    const auto* pose = pose_in(image, input.board);
    if (pose == nullptr) {
      input.left_out.push_back(image.id + ": no camera_from_board");
      continue;
    }
    if (image.weight.value_or(1) == 0) {
      input.left_out.push_back(image.id + ": dropped by the calibration");
      continue;
    }
    const auto found = corners.find(image.id);
    if (found == corners.end() || found->second->corners.size() < fewest_corners) {
      input.left_out.push_back(image.id + ": fewer than four corners in the table");
      continue;
    }
    if (!image.base_from_tool) {
      throw Error(Exit::data, image_place(document, i, "/base_from_tool"), "missing",
                  "give the robot's pose of every image with a board, here or by --poses");
    }
    if (!input.robot.empty() && !image.robot.empty() && image.robot != input.robot)
      throw Error(Exit::data, image_place(document, i, "/robot"),
                  "is \"" + image.robot + "\", that of earlier images \"" + input.robot + "\"",
                  "name one of them with --robot");
    if (!image.robot.empty()) input.robot = image.robot;
    handeye::View view{image.id, *image.base_from_tool, *pose, {}};
    for (const camera::TableCorner& c : found->second->corners)
      view.corners.push_back({c.board_m, c.pixel, c.sigma_px});
    view.camera_from_board = handeye::pose_by_camera(input.setup, view);
    input.views.push_back(std::move(view));
  }
  check_motion(document, input);
  return input;
}

void enter_mounting(const HandEyeInput& input, const HandEyeRequest& request, const handeye::Analysis& a,
                    manifest::Document& document) {
  manifest::Mounting m;
  m.kind = handeye::name_of(request.kind);
  m.robot = input.robot;
  m.camera = input.camera;
  m.board = input.board;
  m.method =
      a.method == "joint" ? "joint refinement of corners and robot poses, " + a.best_closed + " beside it" : a.method;
  const bool in_hand = request.kind == Kind::eye_in_hand;
  const auto& x = a.solution.mount_from_camera;
  const auto& z = a.solution.stand_from_board;
  if (in_hand) {
    if (a.observability.mount_from_camera) m.tool_from_camera = posed<frame::Tool, frame::Camera>(x, a, 0);
    if (a.observability.stand_from_board) m.base_from_board = posed<frame::Base, frame::Board>(z, a, 6);
    enter_frame("tool", input.camera, m.tool_from_camera, document);
    enter_frame("base", input.board, m.base_from_board, document);
  } else {
    if (a.observability.mount_from_camera) m.base_from_camera = posed<frame::Base, frame::Camera>(x, a, 0);
    if (a.observability.stand_from_board) m.tool_from_board = posed<frame::Tool, frame::Board>(z, a, 6);
    enter_frame("base", input.camera, m.base_from_camera, document);
    enter_frame("tool", input.board, m.tool_from_board, document);
  }
  m.covariance = in_hand ? covariance_of(a, "tool_from_camera", "base_from_board")
                         : covariance_of(a, "base_from_camera", "tool_from_board");
  m.corner_px = a.consensus.refined.noise.corner * mean_sigma_px(input);
  m.robot_m = a.consensus.refined.noise.robot_m;
  m.robot_rad = a.consensus.refined.noise.robot_rad;
  enter_errors(a, m);
  m.unobservable = a.observability.unobservable;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    if (!a.consensus.counts[i]) m.outliers.push_back(input.views[i].image);
  }
  m.next = a.next;
  document.mountings[input.camera] = m;
  place_cameras(m, document);
}

std::vector<std::string> outlier_lines(const HandEyeInput& input, const handeye::Analysis& a) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    if (a.consensus.counts[i]) continue;
    const handeye::HeldOutView& e = a.after[i];
    lines.push_back(input.views[i].image + ": does not fit the others: " +
                    text("the board is off by %.2f mm, %.3f deg, %.1f px", e.translation_m * 1e3,
                         e.rotation_rad * 180 / pi, e.rms_px));
  }
  return lines;
}

std::vector<std::string> summary_of(const HandEyeInput& input, const handeye::Analysis& a) {
  std::vector<std::string> lines;
  const auto& n = a.consensus.refined.noise;
  lines.push_back(
      text("%zu poses; scatter of the board %.3f mm, %.4f deg, %.3f px; robot noise %.3f mm, %.4f deg per axis",
           input.views.size() - static_cast<std::size_t>(std::ranges::count(a.consensus.counts, false)),
           a.scatter.translation_m * 1e3, a.scatter.rotation_rad * 180 / pi, a.rms_px, n.robot_m * 1e3,
           n.robot_rad * 180 / pi));
  if (6 * n.board_rad * n.board_rad >
      a.scatter.rotation_rad * a.scatter.rotation_rad) {  // more than half of the scatter
    lines.push_back(
        text("the board is seen turned by %.4f deg per axis beyond the corners' noise, most of its scatter: "
             "look at the lens's calibration and the board's flatness",
             n.board_rad * 180 / pi));
  }
  if (const auto* h = a.held_out_of(a.method)) {
    const auto* best = a.held_out_of(a.best_closed);
    lines.push_back(
        text("poses left out: %.3f mm, %.4f deg, %.3f px (%s, the best closed form: %.3f mm, %.4f deg, %.3f px)",
             h->rms.translation_m * 1e3, h->rms.rotation_rad * 180 / pi, h->rms.rms_px, a.best_closed.c_str(),
             best->rms.translation_m * 1e3, best->rms.rotation_rad * 180 / pi, best->rms.rms_px));
    lines.push_back(text("at a pose not seen the board lies within %.3f mm at 95 %%", *a.within_m() * 1e3));
  }
  return lines;
}

}  // namespace gonio::robot
