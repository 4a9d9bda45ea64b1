// The upgraded sections of the boards domain: a camera whose model has the named lens terms, a board with its warp,
// refitted poses; every fitted number with its uncertainty.
#include <algorithm>
#include <cmath>

#include "camera/board_place.h"
#include "explain/boards/boards_outcome.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/board.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& board_print();
const Mechanism& board_warp();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using camera::BoardColumn;
constexpr std::size_t none = static_cast<std::size_t>(-1);

bool is_named(const Problem& problem, const Explanation& e, const std::string& id) {
  return std::any_of(e.named.begin(), e.named.end(), [&](std::size_t c) { return problem.candidates()[c].id() == id; });
}

// RMS over the corners of the views for which `counts` holds.
template <class Counts>
double rms(const BoardsInput& input, const Observations& o, const Explanation& e, Counts counts) {
  double sum = 0;
  std::size_t corners = 0;
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    if (!counts(v)) continue;
    for (std::size_t i = o.first[v]; i < o.first[v + 1]; ++i) sum += e.residual_after[i] * e.residual_after[i];
    corners += input.views[v].corners.size();
  }
  return corners > 0 ? std::sqrt(sum / static_cast<double>(corners)) : 0;
}

void upgrade_camera(const Problem& problem, const BoardsInput& input, std::size_t c,
                    const std::vector<BoardRole>& roles, const Explanation& e, manifest::Camera& section) {
  camera::Intrinsics k = input.cameras[c].intrinsics;
  std::array<double, 4> pinhole = {k.fx_px, k.fy_px, k.cx_px, k.cy_px};
  std::vector<std::string> order;
  std::vector<std::size_t> places;
  camera::TermSet terms;
  section.sigma.clear();
  for (std::size_t p = 0; p < roles.size(); ++p) {
    if (roles[p].camera != c) continue;
    const std::size_t column = roles[p].column;
    if (column >= camera::CornerColumn::motion) continue;
    const bool lens = column >= BoardColumn::distortion;
    const auto active = std::find(e.active.begin(), e.active.end(), p);
    if (lens && active != e.active.end()) terms.add(column - BoardColumn::distortion);
    (lens ? k.distortion[column - BoardColumn::distortion] : pinhole[column]) = e.values[p];
    const std::string& full = problem.parameters()[p].name;
    const std::string name =
        full.substr(full.find_last_of(lens && full.find('/') == std::string::npos ? '.' : '/') + 1);
    if (active == e.active.end()) continue;
    section.sigma[name] = {e.sigma[p]};
    order.push_back(name);
    places.push_back(static_cast<std::size_t>(active - e.active.begin()));
  }
  k.fx_px = pinhole[0], k.fy_px = pinhole[1], k.cx_px = pinhole[2], k.cy_px = pinhole[3];
  section.model = camera::model_with(section.model, terms);
  camera::store(k, section);
  manifest::Value values = manifest::Value::array();
  for (const std::size_t a : places) {
    std::vector<double> row;
    for (const std::size_t b : places) row.push_back(e.covariance[a * e.active.size() + b]);
    values.push_back(row);
  }
  section.covariance = manifest::Value::object({{"order", order}, {"values", values}});
}

void upgrade_image(const BoardsInput& input, std::size_t v, const std::vector<BoardRole>& roles, const Explanation& e,
                   manifest::ImageEntry& image) {
  std::array<double, 6> change{};
  manifest::PoseSigma sigma{std::vector<double>(3, 0.0), std::vector<double>(3, 0.0)};
  for (std::size_t p = 0; p < roles.size(); ++p) {
    if (roles[p].view != input.views[v].pose_of || roles[p].column >= BoardColumn::warp) continue;
    const std::size_t i = roles[p].column - BoardColumn::rotation;
    change[i] = e.values[p];
    (i < 3 ? sigma.rotation_rad : sigma.translation_m)[i % 3] = e.sigma[p];
  }
  const camera::BoardPose pose = camera::moved(input.views[v].camera_from_board, change);
  manifest::Pose<frame::Camera, frame::Board> written;
  written.rotation = pose.rotation;
  written.translation_m = pose.translation_m;
  written.sigma = sigma;
  image.camera_from_board = written;
}

// Terms that have no place in a camera or a board: under "mechanisms", one number for each target.
void upgrade_mechanisms(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                        const Explanation& e, manifest::Document& document) {
  for (std::size_t p = 0; p < roles.size(); ++p) {
    const BoardRole& role = roles[p];
    if (role.column < camera::CornerColumn::motion || role.corner != none) continue;
    const std::string& name = role.board != none    ? input.boards[role.board].name
                              : role.camera != none ? input.cameras[role.camera].name
                                                    : input.views[role.view].image;
    const std::string& full = problem.parameters()[p].name;
    const auto holds = [&](const Candidate& c) {
      return std::find(c.parameters.begin(), c.parameters.end(), p) != c.parameters.end();
    };
    std::string id;
    for (const std::size_t c : e.named)
      if (holds(problem.candidates()[c])) id = problem.candidates()[c].id();
    for (const BoardsInput::Given& given : input.given)
      if (given.column == role.column && given.on == name &&
          std::find(problem.base().begin(), problem.base().end(), p) != problem.base().end())
        id = given.mechanism;
    if (id.empty()) continue;
    manifest::MechanismUse& use = document.mechanisms[id];
    if (std::find(use.on.begin(), use.on.end(), name) == use.on.end()) use.on.push_back(name);
    const auto place = static_cast<std::size_t>(std::find(use.on.begin(), use.on.end(), name) - use.on.begin());
    const std::string key = full.substr(full.find_last_of("./") + 1);
    std::vector<double>&value = use.parameters[key].value, &sigma = use.sigma[key];
    value.resize(use.on.size());
    sigma.resize(use.on.size());
    value[place] = e.values[p];
    sigma[place] = e.sigma[p];
  }
}

// Is it free, as part of what is named or of the base model?
bool was_fitted(const Problem& problem, const Explanation& e, std::size_t p) {
  const auto has = [&](const std::vector<std::size_t>& list) { return std::ranges::find(list, p) != list.end(); };
  return has(problem.base()) ||
         std::ranges::any_of(e.named, [&](std::size_t c) { return has(problem.candidates()[c].parameters); });
}

// The parameters of board.print that were fitted, by the board's places and axis; none elsewhere.
using PrintParameters = std::vector<std::array<std::size_t, 3>>;
PrintParameters fitted_print(const Problem& problem, const BoardsInput& input, std::size_t board,
                             const std::vector<BoardRole>& roles, const Explanation& e) {
  PrintParameters list(input.boards[board].places.size(), {none, none, none});
  for (std::size_t p = 0; p < roles.size(); ++p)
    if (roles[p].corner != none && roles[p].board == board && was_fitted(problem, e, p))
      list[roles[p].corner][roles[p].column - camera::CornerColumn::print] = p;
  return list;
}

// One standard deviation of where a corner stands: d = S a has the covariance S C S'.
double print_sigma(const PrintPlaces& print, const PrintParameters& list, std::size_t corner, std::size_t axis,
                   const Explanation& e) {
  std::vector<std::pair<std::size_t, double>> terms;  // places in `active`, slopes
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto active = std::ranges::find(e.active, list[k][axis]);
    if (active != e.active.end())
      terms.emplace_back(static_cast<std::size_t>(active - e.active.begin()), print.slope(axis, corner, k));
  }
  double variance = 0;
  for (const auto& [i, si] : terms)
    for (const auto& [j, sj] : terms) variance += si * sj * e.covariance[i * e.active.size() + j];
  return std::sqrt(std::max(0.0, variance));
}

// board.print anew: lists of corners, in the order of their places.
void upgrade_print(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                   const Explanation& e, manifest::Document& document) {
  manifest::MechanismUse use;
  const auto append = [&](const std::string& key, double value) { use.parameters[key].value.push_back(value); };
  for (std::size_t b = 0; b < input.boards.size(); ++b) {
    const BoardsInput::Board& board = input.boards[b];
    const PrintParameters list = fitted_print(problem, input, b, roles, e);
    std::vector<std::array<double, 3>> stands(list.size());
    for (std::size_t k = 0; k < list.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (list[k][axis] != none) stands[k][axis] = e.values[list[k][axis]];
    stands = board.print.displaced(std::move(stands));
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (list[k][0] == none) continue;
      if (use.on.empty() || use.on.back() != board.name) use.on.push_back(board.name);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string key{camera::print_names[axis]};
        append(key, stands[k][axis]);
        use.sigma[key].push_back(print_sigma(board.print, list, k, axis, e));
      }
      append("column", static_cast<double>(board.places[k][0]));
      append("row", static_cast<double>(board.places[k][1]));
      append("of", static_cast<double>(use.on.size() - 1));
    }
  }
  if (!use.on.empty()) document.mechanisms[mechanism::board_print().id] = use;
}

}  // namespace

void upgrade_boards(const Problem& problem, const BoardsInput& input, const std::vector<BoardRole>& roles,
                    const Explanation& e, manifest::Document& document) {
  const Observations& o = problem.observations();
  for (std::size_t c = 0; c < input.cameras.size(); ++c) {
    manifest::Camera& section = document.cameras.at(input.cameras[c].name);
    upgrade_camera(problem, input, c, roles, e, section);
    section.rms_px = rms(input, o, e, [&](std::size_t v) { return input.views[v].camera == c; });
  }
  for (std::size_t p = 0; p < roles.size(); ++p) {
    if (roles[p].board == none || roles[p].column >= camera::CornerColumn::motion) continue;
    if (!(input.boards[roles[p].board].warped || is_named(problem, e, mechanism::board_warp().id))) continue;
    manifest::Board& section = document.boards.at(input.boards[roles[p].board].name);
    const std::string axis = roles[p].column == BoardColumn::warp ? "x_m" : "y_m";
    section.warp[axis] = manifest::Parameter(e.values[p]);
    section.sigma[axis] = {e.sigma[p]};
  }
  upgrade_mechanisms(problem, input, roles, e, document);
  upgrade_print(problem, input, roles, e, document);
  for (std::size_t v = 0; v < input.views.size(); ++v) {
    const auto listed = manifest::index_of_image(document, input.views[v].image);
    if (!listed) continue;
    manifest::ImageEntry& image = document.images[*listed];
    upgrade_image(input, v, roles, e, image);
    image.rms_px = rms(input, o, e, [&](std::size_t other) { return other == v; });
  }
  camera::place_images(document, "explain");
}

}  // namespace gonio::explain
