// See boards_problem.h: from the manifest to plain numbers.
#include <algorithm>

#include "base/error.h"
#include "camera/board.h"
#include "camera/corner_table.h"
#include "explain/boards/boards_problem.h"

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_views = 3;

bool is_corner_table(const manifest::Table& table) {
  return table.model == "camera";
}

BoardsInput::Camera camera_input(const manifest::Document& document, const std::string& name) {
  const std::string place = manifest::place(document, "/cameras/" + name);
  const auto found = document.cameras.find(name);
  if (found == document.cameras.end())
    throw Error(Exit::data, place, "is not described", "calibrate first: calib-charuco");
  BoardsInput::Camera camera;
  camera.name = name;
  camera.intrinsics = camera::intrinsics_of(found->second, place);
  camera.width_px = found->second.width_px;
  camera.height_px = found->second.height_px;
  for (const auto& [term, value] : found->second.distortion)
    camera.terms.push_back(camera::distortion_index(term, place));
  std::sort(camera.terms.begin(), camera.terms.end());
  return camera;
}

BoardsInput::Board board_input(const manifest::Document& document, const std::string& name) {
  const std::string place = manifest::place(document, "/boards/" + name);
  const auto found = document.boards.find(name);
  if (found == document.boards.end())
    throw Error(Exit::data, place, "is not described", "calibrate first: calib-charuco");
  BoardsInput::Board board;
  board.name = name;
  board.square_m = found->second.square_m;
  board.extent = camera::board_of(found->second, place).extent();
  const auto sag = [&](const char* axis) {
    const auto given = found->second.warp.find(axis);
    if (given == found->second.warp.end()) return 0.0;
    board.warped = true;
    return given->second.scalar();
  };
  board.warp = {sag("x_m"), sag("y_m")};
  return board;
}

// Place of `name` among those read so far; read when it is new.
template <class Part, class Read>
std::size_t entered(std::vector<Part>& parts, const std::string& name, Read read) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].name == name) return i;
  parts.push_back(read(name));
  return parts.size() - 1;
}

void add_table(const manifest::Document& document, const std::string& name, BoardsInput& input) {
  const camera::CornerTable table = camera::read_corners(document, name);
  for (const camera::ImageCorners& corners : table.images) {
    const auto image = std::find_if(document.images.begin(), document.images.end(),
                                    [&](const manifest::ImageEntry& i) { return i.id == corners.image; });
    const std::string place = manifest::place(document, "/tables/" + name);
    if (image == document.images.end())
      throw Error(Exit::data, place, "has corners of image " + corners.image + ", which the manifest does not list");
    if (image->weight && *image->weight == 0) continue;
    if (!image->camera_from_board)
      throw Error(Exit::data, manifest::place(document, "/images/" + corners.image), "has no camera_from_board",
                  "calibrate first: calib-charuco");
    BoardsInput::View view;
    view.image = corners.image;
    view.camera = entered(input.cameras, table.camera.empty() ? image->camera : table.camera,
                          [&](const std::string& id) { return camera_input(document, id); });
    view.board = entered(input.boards, table.board.empty() ? image->board : table.board,
                         [&](const std::string& id) { return board_input(document, id); });
    view.camera_from_board = *image->camera_from_board;
    for (const camera::TableCorner& c : corners.corners) view.corners.push_back({c.board_m, c.pixel, c.sigma_px});
    if (view.corners.size() >= 6) input.views.push_back(std::move(view));
  }
}

}  // namespace

bool has_boards(const manifest::Document& document) {
  return std::any_of(document.tables.begin(), document.tables.end(),
                     [](const auto& t) { return is_corner_table(t.second); });
}

BoardsInput boards_input(const manifest::Document& document) {
  BoardsInput input;
  for (const auto& [name, table] : document.tables)
    if (is_corner_table(table)) add_table(document, name, input);
  if (input.views.size() < fewest_views)
    throw Error(Exit::data, manifest::place(document, "/tables"),
                "has corners of " + std::to_string(input.views.size()) +
                    " board views, and explain leaves views out to judge (at least " + std::to_string(fewest_views) +
                    ")",
                "photograph the board from more directions");
  return input;
}

}  // namespace gonio::explain
