// See boards_problem.h: from the manifest to plain numbers.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "camera/board.h"
#include "camera/board_projection.h"
#include "camera/corner_model.h"
#include "camera/corner_table.h"
#include "explain/boards/boards_problem.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/table.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& board_print();
}

namespace gonio::explain {
namespace {

constexpr std::size_t fewest_views = 3;
constexpr std::size_t fewest_to_place = 4;  // views of a corner that tell its place from their noise
constexpr std::size_t most_placed = 120;    // corners of a board: three numbers each, all in one fit

bool is_corner_table(const manifest::Table& table) {
  return table.model == "camera";
}

// Standard errors as the section states them; what has none is held as good as exactly.
void read_sigma(const manifest::Camera& section, BoardsInput::Camera& camera) {
  constexpr double exact = 1e-6;
  const auto stated = [&](const std::string& name, double otherwise) {
    const auto found = section.sigma.find(name);
    return found != section.sigma.end() && !found->second.empty() && found->second[0] > 0 ? found->second[0]
                                                                                          : otherwise;
  };
  const camera::Intrinsics& k = camera.intrinsics;
  for (std::size_t i = 0; i < 4; ++i) camera.sigma[i] = stated(std::string(camera::pinhole_names[i]), exact * k.fx_px);
  for (const std::size_t t : camera.terms)
    camera.sigma[4 + t] = stated(std::string(camera::distortion_names[t]), exact);
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
  // What stands at zero and has no standard error while others have, a model's empty place, was no part of their fit.
  const auto is_place = [&](const std::string& term, const manifest::Parameter& value) {
    return !found->second.sigma.empty() && !found->second.sigma.contains(term) && value.scalar() == 0;
  };
  for (const auto& [term, value] : found->second.distortion)
    if (!is_place(term, value)) camera.terms.push_back(camera::distortion_index(term, place));
  std::sort(camera.terms.begin(), camera.terms.end());
  camera.held = found->second.held.value_or(false);
  if (camera.held) read_sigma(found->second, camera);
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
    const auto listed = manifest::index_of_image(document, corners.image);
    if (!listed)
      throw Error(Exit::data, manifest::place(document, "/tables/" + name),
                  "has corners of image " + corners.image + ", which the manifest does not list");
    const manifest::ImageEntry& image = document.images[*listed];
    if (image.weight && *image.weight == 0) continue;
    if (!image.camera_from_board)
      throw Error(Exit::data, manifest::place(document, "/images/" + corners.image), "has no camera_from_board",
                  "calibrate first: calib-charuco");
    BoardsInput::View view;
    view.image = corners.image;
    view.camera = entered(input.cameras, table.camera.empty() ? image.camera : table.camera,
                          [&](const std::string& id) { return camera_input(document, id); });
    view.board = entered(input.boards, table.board.empty() ? image.board : table.board,
                         [&](const std::string& id) { return board_input(document, id); });
    view.camera_from_board = *image.camera_from_board;
    view.time_s = image.time_s;
    view.temperature_K = image.temperature_K;
    for (const camera::TableCorner& c : corners.corners) {
      view.corners.push_back({c.board_m, c.pixel, c.sigma_px, static_cast<camera::Colour>(c.channel), c.turned_rad});
      if (!view.time_s && std::isfinite(c.time_s)) view.time_s = c.time_s;
      if (!view.temperature_K && std::isfinite(c.temperature_K)) view.temperature_K = c.temperature_K;
    }
    if (view.corners.size() >= 6) input.views.push_back(std::move(view));
  }
}

}  // namespace

bool has_boards(const manifest::Document& document) {
  return std::any_of(document.tables.begin(), document.tables.end(),
                     [](const auto& t) { return is_corner_table(t.second); });
}

namespace {

// board.print: a list of corners, each with its column, row and displacement.
void read_print(const manifest::Document& document, const manifest::MechanismUse& use, BoardsInput& input) {
  const std::string at = manifest::place(document, "/mechanisms/" + mechanism::board_print().id);
  const auto list = [&](std::string_view name) {
    const auto found = use.parameters.find(std::string(name));
    return found == use.parameters.end() ? std::vector<double>{} : found->second.value;
  };
  const std::vector<double> columns = list("column"), rows = list("row"), of = list("of");
  if (columns.empty() || rows.empty())
    throw Error(Exit::data, at, "does not say which corners", "add the lists \"column\" and \"row\"");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> shift = list(camera::print_names[axis]);
    shift.resize(columns.size());  // one that is not there is zero
    for (std::size_t k = 0; k < shift.size(); ++k) {
      const double stated = of.empty() ? 0 : of[k];
      if (!(stated >= 0 && stated < std::max(1.0, static_cast<double>(use.on.size()))))
        throw Error(Exit::data, at, "has a corner of board " + shortest_text(stated) + ", counted from 0 in \"on\"");
      const auto board = static_cast<std::size_t>(stated);
      if (use.on.empty() && input.boards.size() > 1)
        throw Error(Exit::data, at, "does not say of which board", "add \"on\"");
      const std::string& name = use.on.empty() ? input.boards.at(0).name : use.on[board];
      if (std::ranges::find(input.boards, name, &BoardsInput::Board::name) == input.boards.end()) continue;
      input.given.push_back({mechanism::board_print().id, name, camera::CornerColumn::print + axis, shift[k],
                             std::array{std::lround(columns[k]), std::lround(rows[k])}});
    }
  }
}

// Numbers that every view has of its own (a motion): for each image that is named, and for all of a camera's.
void read_motions(const manifest::MechanismUse& use, const mechanism::Mechanism& m, BoardsInput& input) {
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    const BoardsInput::View& view = input.views[v];
    auto found = std::ranges::find(use.on, view.image);
    if (found == use.on.end()) found = std::ranges::find(use.on, input.cameras[view.camera].name);
    if (found == use.on.end() && !use.on.empty()) continue;
    const auto place = static_cast<std::size_t>(found - use.on.begin());
    for (const auto& [parameter, value] : use.parameters) {
      const auto column = camera::corner_column(parameter);
      if (!column || !camera::CornerColumn::is_motion(*column) || value.value.empty()) continue;
      input.given.push_back({.mechanism = m.id,
                             .on = view.image,
                             .column = *column,
                             .value = value.value[std::min(place, value.value.size() - 1)],
                             .view = v});
    }
  }
}

// Terms that no section of cameras or boards has a place for, where the manifest switches them on.
void read_given(const manifest::Document& document, BoardsInput& input) {
  for (const auto& [id, use] : document.mechanisms) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    if (m == nullptr || std::ranges::find(m->domains, "boards") == m->domains.end()) continue;
    if (id == mechanism::board_print().id) {
      read_print(document, use, input);
      continue;
    }
    if (m->target == mechanism::Target::camera) read_motions(use, *m, input);
    const auto add = [&](const std::string& name) {
      const auto found = std::find(use.on.begin(), use.on.end(), name);
      if (!use.on.empty() && found == use.on.end()) return;
      for (const auto& [parameter, value] : use.parameters) {
        const auto column = camera::corner_column(parameter);
        if (!column || *column < camera::CornerColumn::scale || value.value.empty()) continue;
        const auto place = static_cast<std::size_t>(found - use.on.begin());
        input.given.push_back({id, name, *column, value.value[std::min(place, value.value.size() - 1)]});
      }
    };
    if (m->target == mechanism::Target::board)
      for (const BoardsInput::Board& board : input.boards) add(board.name);
    else
      for (const BoardsInput::Camera& camera : input.cameras) add(camera.name);
  }
}

// Differences from the mean where all views state the quantity.
template <class Stated>
void settle_drift(std::vector<BoardsInput::View>& views, Stated stated, double BoardsInput::View::*difference) {
  double sum = 0;
  for (const BoardsInput::View& view : views) {
    if (!(view.*stated)) return;
    sum += *(view.*stated);
  }
  for (BoardsInput::View& view : views) view.*difference = *(view.*stated) - sum / static_cast<double>(views.size());
}

// One target at rest, not two views that start from the same guess: common corners lie within a hundredth of the
// image's width.
bool of_one_target(const BoardsInput& input, const BoardsInput::View& a, const BoardsInput::View& b) {
  if (a.camera != b.camera || a.board != b.board || !(a.camera_from_board == b.camera_from_board)) return false;
  const double near_px = 0.01 * input.cameras[a.camera].width_px;
  return std::ranges::all_of(a.corners, [&](const BoardsInput::Corner& c) {
    return std::ranges::all_of(b.corners, [&](const BoardsInput::Corner& d) {
      return norm(c.board_m - d.board_m) > 1e-9 || norm(c.pixel - d.pixel) < near_px;
    });
  });
}

std::array<long, 2> place_of(const BoardsInput::Corner& corner, const BoardsInput::Board& board) {
  return {std::lround(corner.board_m.x / board.square_m), std::lround(corner.board_m.y / board.square_m)};
}

// Corners that enough views show, whatever their colour, of a board with too many none; and those that are given.
void settle_places(BoardsInput& input, std::size_t b) {
  BoardsInput::Board& board = input.boards[b];
  std::map<std::array<long, 2>, std::size_t> views;
  for (const BoardsInput::View& view : input.views) {
    if (view.board != b) continue;
    std::set<std::array<long, 2>> own;
    for (const BoardsInput::Corner& corner : view.corners) own.insert(place_of(corner, board));
    for (const auto& place : own) ++views[place];
  }
  std::set<std::array<long, 2>> placed;
  for (const auto& [place, count] : views)
    if (count >= fewest_to_place) placed.insert(place);
  if (placed.size() > most_placed) placed.clear();
  bool given = false;
  for (const BoardsInput::Given& g : input.given)
    if (g.place && g.on == board.name) placed.insert(*g.place), given = true;
  board.places.assign(placed.begin(), placed.end());
  board.print = given ? PrintPlaces() : PrintPlaces(board.places);
  for (BoardsInput::View& view : input.views) {
    if (view.board != b) continue;
    for (BoardsInput::Corner& corner : view.corners) {
      const auto found = std::ranges::lower_bound(board.places, place_of(corner, board));
      if (found != board.places.end() && *found == place_of(corner, board))
        corner.of_board = static_cast<std::size_t>(found - board.places.begin());
    }
  }
}

}  // namespace

void settle_views(BoardsInput& input) {
  for (std::size_t b = 0; b < input.boards.size(); ++b) settle_places(input, b);
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    BoardsInput::View& view = input.views[v];
    view.pose_of = v;
    for (std::size_t w = 0; w < v && view.pose_of == v; ++w)
      if (of_one_target(input, input.views[w], view)) view.pose_of = w;
  }
  settle_drift(input.views, &BoardsInput::View::temperature_K, &BoardsInput::View::warmer_K);
  settle_drift(input.views, &BoardsInput::View::time_s, &BoardsInput::View::later_s);
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
  read_given(document, input);
  return input;
}

}  // namespace gonio::explain
