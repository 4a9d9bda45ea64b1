// See robot_problem.h: from the manifest to plain numbers.
#include "robot/chain/input.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "camera/board.h"
#include "camera/board_projection.h"
#include "camera/corner_table.h"
#include "camera/moved_corners.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/robot.h"
#include "manifest/sections/table.h"
#include "mechanism/mechanism.h"
#include "robot/ur_calibration.h"

namespace gonio::mechanism {
const Mechanism& board_scale();
}

namespace gonio::robot {
namespace {

constexpr std::ptrdiff_t fewest_images = 6;
constexpr std::size_t fewest_corners = 6;

bool is_complete(const manifest::Mounting& m) {
  return (m.kind == "eye-in-hand" && m.tool_from_camera && m.base_from_board) ||
         (m.kind == "eye-to-hand" && m.tool_from_board && m.base_from_camera);
}

bool belongs(const manifest::ImageEntry& image, const manifest::Mounting& m) {
  const auto same = [](const std::string& a, const std::string& b) { return a.empty() || b.empty() || a == b; };
  return same(image.camera, m.camera) && same(image.board, m.board) && same(image.robot, m.robot) &&
         image.camera_from_board && (image.base_from_tool || !image.joints_rad.empty()) &&
         !(image.weight && *image.weight == 0);
}

std::vector<const manifest::ImageEntry*> images_of(const manifest::Document& document, const manifest::Mounting& m) {
  std::vector<const manifest::ImageEntry*> images;
  for (const manifest::ImageEntry& image : document.images)
    if (belongs(image, m)) images.push_back(&image);
  return images;
}

// What handeye left out is left out here, a few strays. Where more than a quarter of the poses do not fit the mountings
// alone, they are what is to be explained (joints with play stand in two places); strays among them are found when
// every hypothesis is free.
std::vector<std::string> strays(const manifest::Document& document, const manifest::Mounting& m) {
  return 4 * m.outliers.size() > images_of(document, m).size() ? std::vector<std::string>{} : m.outliers;
}

bool is_among(const std::string& image, const std::vector<std::string>& images) {
  return std::find(images.begin(), images.end(), image) != images.end();
}

bool is_enough(const manifest::Document& document, const manifest::Mounting& m) {
  const std::vector<std::string> left_out = strays(document, m);
  const auto counts = [&](const manifest::ImageEntry* image) { return !is_among(image->id, left_out); };
  return is_complete(m) && std::ranges::count_if(images_of(document, m), counts) >= fewest_images;
}

template <class Pose>
auto as_part(const Pose& pose) {
  return std::pair{pose.rotation, pose.translation_m};
}

void read_camera(const manifest::Document& document, ChainInput& input) {
  const std::string place = manifest::place(document, "/cameras/" + input.camera);
  const auto found = document.cameras.find(input.camera);
  if (found == document.cameras.end())
    throw Error(Exit::data, place, "is not described", "calibrate first: calib-charuco");
  input.intrinsics = camera::intrinsics_of(found->second, place);
  for (const auto& [term, value] : found->second.distortion)
    input.terms.push_back(camera::distortion_index(term, place));
  for (std::size_t i = 0; i < camera::pinhole_names.size(); ++i) {
    const auto sigma = found->second.sigma.find(std::string(camera::pinhole_names[i]));
    if (sigma != found->second.sigma.end() && !sigma->second.empty()) input.pinhole_sigma_px[i] = sigma->second[0];
  }
}

void read_board(const manifest::Document& document, ChainInput& input) {
  const std::string place = manifest::place(document, "/boards/" + input.board);
  const auto found = document.boards.find(input.board);
  if (found == document.boards.end())
    throw Error(Exit::data, place, "is not described", "calibrate first: calib-charuco");
  input.extent = camera::board_of(found->second, place).extent();
  const auto sag = [&](const char* axis) {
    const auto given = found->second.warp.find(axis);
    if (given == found->second.warp.end()) return 0.0;
    input.warped = true;
    return given->second.scalar();
  };
  input.warp = {sag("x_m"), sag("y_m")};
}

void read_corners(const manifest::Document& document, ChainInput& input) {
  for (const auto& [name, section] : document.tables) {
    if (section.model != "camera") continue;
    if (!section.camera.empty() && section.camera != input.camera) continue;
    if (!section.board.empty() && section.board != input.board) continue;
    const camera::CornerTable table = camera::read_corners(document, name);
    for (const camera::ImageCorners& own : table.images)
      for (ChainInput::View& view : input.views) {
        if (view.image != own.image) continue;
        for (const camera::TableCorner& c : own.corners) view.corners.push_back({c.board_m, c.pixel, c.sigma_px});
      }
  }
}

// Terms of the manifest that move this set's corners, and that a pose solved from corners here would not know: the
// poses as they stand were fitted with them. The scale of the board is the chain's own.
bool corners_moved_elsewhere(const manifest::Document& document, const ChainInput& input) {
  return std::ranges::any_of(document.mechanisms, [&](const auto& entry) {
    const auto& [id, use] = entry;
    const auto names = [&, &on = use.on](const std::string& name) {
      return on.empty() || std::ranges::find(on, name) != on.end();
    };
    return id != mechanism::board_scale().id && (names(input.camera) || names(input.board)) &&
           camera::moves_corners(id, use);
  });
}

ChainInput::View view_of(const manifest::Document& document, const manifest::ImageEntry& image,
                         const ChainInput& input) {
  ChainInput::View view;
  view.image = image.id;
  view.joints_rad = image.joints_rad;
  view.time_s = image.time_s;
  view.temperature_K = image.temperature_K;
  view.camera_from_board = *image.camera_from_board;
  if (image.base_from_tool) {
    view.base_from_tool = *image.base_from_tool;
  } else {
    const std::string place = manifest::place(document, "/images/" + image.id + "/joints_rad");
    if (input.links.empty())
      throw Error(Exit::data, place, "are given without base_from_tool, and the arm is not described",
                  "describe it in robots");
    view.base_from_tool = flange(input.links, image.joints_rad);
  }
  if (const auto& sigma = image.camera_from_board->sigma;
      sigma && !sigma->rotation_rad.empty() && !sigma->translation_m.empty()) {
    view.rotation_sigma_rad = *std::ranges::max_element(sigma->rotation_rad);
    view.shift_sigma_m = *std::ranges::max_element(sigma->translation_m);
  }
  return view;
}

// Where any view lacks joints or corners, none of them counts: hypotheses are asked of all poses alike.
void even_out(const manifest::Document& document, ChainInput& input) {
  const auto lacks = [&](auto condition) { return std::any_of(input.views.begin(), input.views.end(), condition); };
  if (lacks([&](const ChainInput::View& v) { return v.joints_rad.size() != input.links.size(); })) {
    input.links.clear();
    for (ChainInput::View& v : input.views) v.joints_rad.clear();
  }
  std::erase_if(input.views,
                [](const ChainInput::View& v) { return !v.corners.empty() && v.corners.size() < fewest_corners; });
  if (!lacks([](const ChainInput::View& v) { return v.corners.empty(); })) return;
  for (ChainInput::View& v : input.views) {
    v.corners.clear();
    if (!(v.rotation_sigma_rad > 0) || !(v.shift_sigma_m > 0))
      throw Error(Exit::data, manifest::place(document, "/images/" + v.image + "/camera_from_board"),
                  "has no sigma, and there is no table of corners for all images", "hand on what calib-charuco writes");
  }
}

// The first pose of a run was come to from the arm's home.
void find_first_approach(const manifest::Document& document, ChainInput& input) {
  if (document.runs.size() != 1 || document.laboratory.entry.empty() || input.views.empty()) return;
  const auto& robots = document.laboratory.entry.front().robots;
  const auto arm = robots.find(input.robot);
  const auto first = std::ranges::min_element(input.views, {}, [](const ChainInput::View& v) {
    return v.time_s.value_or(std::numeric_limits<double>::infinity());
  });
  if (arm == robots.end() || !first->time_s || first->joints_rad.size() != arm->second.home_rad.size()) return;
  for (std::size_t j = 0; j < std::min<std::size_t>(6, first->joints_rad.size()); ++j) {
    const double turn = first->joints_rad[j] - arm->second.home_rad[j];
    if (std::abs(turn) > 1e-5) first->approach[j] = turn > 0 ? 1 : -1;
  }
}

ChainInput input_of(const manifest::Document& document, const std::string& name, const manifest::Mounting& m) {
  ChainInput input;
  input.mounting = name;
  input.eye_to_hand = m.kind == "eye-to-hand";
  const auto hand = input.eye_to_hand ? as_part(*m.tool_from_board) : as_part(*m.tool_from_camera);
  const auto fixed = input.eye_to_hand ? as_part(*m.base_from_camera) : as_part(*m.base_from_board);
  input.tool_from_hand = {hand.first, hand.second};
  input.base_from_fixed = {fixed.first, fixed.second};
  const std::vector<const manifest::ImageEntry*> images = images_of(document, m);
  input.robot = m.robot.empty() ? images[0]->robot : m.robot;
  input.camera = m.camera.empty() ? images[0]->camera : m.camera;
  input.board = m.board.empty() ? images[0]->board : m.board;
  if (document.robots.contains(input.robot)) input.links = arm_of(document, input.robot).links;
  read_camera(document, input);
  read_board(document, input);
  for (const manifest::ImageEntry* image : images) input.views.push_back(view_of(document, *image, input));
  find_first_approach(document, input);
  find_passage(input);  // by all poses: the arm went through those that are left out, too
  std::erase_if(input.views,
                [left_out = strays(document, m)](const ChainInput::View& v) { return is_among(v.image, left_out); });
  if (!corners_moved_elsewhere(document, input)) read_corners(document, input);
  even_out(document, input);
  return input;
}

}  // namespace

bool has_hand_eye(const manifest::Document& document) {
  return std::any_of(document.mountings.begin(), document.mountings.end(),
                     [&](const auto& m) { return is_enough(document, m.second); });
}

std::vector<ChainInput> robot_inputs(const manifest::Document& document) {
  std::vector<ChainInput> inputs;
  for (const auto& [name, mounting] : document.mountings)
    if (is_enough(document, mounting)) inputs.push_back(input_of(document, name, mounting));
  return inputs;
}

}  // namespace gonio::robot
