// Parameters and candidates of the boards domain: what the sections give, and beside it every mechanism of the registry
// that these tables can show. Which parameters a mechanism has here follows from the columns that they move.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "camera/board_projection.h"
#include "explain/boards/boards_outcome.h"

namespace gonio::mechanism {
const Mechanism& board_print();
const Mechanism& board_shape();
const Mechanism& board_warp();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using camera::BoardColumn;
using camera::CornerColumn;
using camera::LensTerm;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t none = static_cast<std::size_t>(-1);
constexpr std::array<const char*, 6> pose_names = {"rotation_x_rad",  "rotation_y_rad",  "rotation_z_rad",
                                                   "translation_x_m", "translation_y_m", "translation_z_m"};

bool is_lens(std::size_t column) {
  return column >= BoardColumn::distortion && column < BoardColumn::rotation;
}
// A board whose base model has the sag has these two terms of its shape already.
bool is_sag(std::size_t column) {
  return column == camera::corner_column("z20_m") || column == camera::corner_column("z02_m");
}

// Typical size of a change.
double size_of(std::size_t column) {
  if (is_lens(column)) return 0.01;
  if (column < CornerColumn::scale) return 1e-4;  // warp and motion, m
  if (column < CornerColumn::bias) return 1e-3;   // scale, pupil, colour
  if (column < CornerColumn::by_temperature) return 0.1;
  if (column >= CornerColumn::shape) return 1e-4;
  if (column >= CornerColumn::port) return 0.01;  // index, m, rad, a share
  const bool by_time = column >= CornerColumn::by_time;
  const bool focal = column == CornerColumn::by_temperature || column == CornerColumn::by_time;
  return (focal ? 1e-5 : 0.02) * (by_time ? 0.01 : 1);
}

class Declaration {
 public:
  explicit Declaration(const BoardsInput& input) : input_(input) {
    for (std::size_t c = 0; c < input_.cameras.size(); ++c) declare_camera(c);
    for (std::size_t b = 0; b < input_.boards.size(); ++b) declare_board(b);
    for (const BoardsInput::Given& given : input_.given) declare_given(given);
    for (std::size_t v = 0; v < input_.views.size(); ++v) declare_view(v);
    for (const mechanism::Mechanism* m : mechanism::all_mechanisms())
      if (std::find(m->domains.begin(), m->domains.end(), "boards") != m->domains.end()) declare_mechanism(*m);
  }

  BoardParameters result;

 private:
  std::size_t declare(Parameter parameter, BoardRole role) {
    result.parameters.push_back(std::move(parameter));
    result.roles.push_back(role);
    return result.parameters.size() - 1;
  }
  // Groups that a camera or a board takes part in; empty where that is all of them.
  template <class Same>
  std::vector<std::size_t> groups_where(Same same) const {
    std::vector<std::size_t> groups;
    for (std::size_t v = 0; v < input_.views.size(); ++v)
      if (same(input_.views[v])) groups.push_back(v);
    return groups.size() == input_.views.size() ? std::vector<std::size_t>{} : groups;
  }
  std::vector<std::size_t> groups_of(const BoardRole& role) const {
    return groups_where([&](const BoardsInput::View& v) {
      return (role.camera == none || v.camera == role.camera) && (role.board == none || v.board == role.board);
    });
  }
  void declare_base(const std::string& name, const std::string& unit, double value, double lower, double upper,
                    double size, BoardRole role, std::optional<double> prior = {}) {
    result.base.push_back(declare({name, unit, value, value, lower, upper, size, prior, groups_of(role)}, role));
  }

  void declare_camera(std::size_t c) {
    const BoardsInput::Camera& own = input_.cameras[c];
    const camera::Intrinsics& k = own.intrinsics;
    const std::array<double, 4> start = {k.fx_px, k.fy_px, k.cx_px, k.cy_px};
    const std::string prefix = "cameras/" + own.name + "/";
    // Views that leave the camera open (all frontal, from one range) leave it where its section puts it, roughly; views
    // that determine it are moved by a thousandth of their own uncertainty.
    const double half_px = 0.5 * std::hypot(own.width_px, own.height_px);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string name = prefix + std::string(camera::pinhole_names[i]);
      if (own.held)
        declare_held(name, "px", start[i], own.sigma[i], 1, {c, none, none, i});
      else
        declare_base(name, "px", start[i], i < 2 ? 0.2 * start[i] : -infinity, i < 2 ? 5 * start[i] : infinity, 1,
                     {c, none, none, i}, i < 2 ? 0.3 * start[i] : half_px);
    }
    for (const std::size_t t : own.terms) {
      const std::string name = prefix + std::string(camera::distortion_names[t]);
      const BoardRole role{c, none, none, BoardColumn::distortion + t};
      if (own.held)
        declare_held(name, "1", k.distortion[t], own.sigma[4 + t], 0.01, role);
      else if (t == LensTerm::fisheye)  // between perspective and equidistant: beyond, a lens shows nothing
        declare_base(name, "1", k.distortion[t], 0, 1, 0.01, role);
      else
        declare_base(name, "1", k.distortion[t], -infinity, infinity, 0.01, role);
    }
  }
  // What other views say of a number: it stays within four of its standard errors, whatever it could repair here.
  void declare_held(const std::string& name, const std::string& unit, double value, double sigma, double size,
                    BoardRole role) {
    declare_base(name, unit, value, value - 4 * sigma, value + 4 * sigma, size, role, sigma);
  }

  void declare_board(std::size_t b) {
    if (!input_.boards[b].warped) return;
    const camera::BoardWarp& warp = input_.boards[b].warp;
    const std::string prefix = "boards/" + input_.boards[b].name + "/";
    declare_base(prefix + "sag_x_m", "m", warp.sag_x_m, -infinity, infinity, 1e-4, {none, b, none, BoardColumn::warp});
    declare_base(prefix + "sag_y_m", "m", warp.sag_y_m, -infinity, infinity, 1e-4,
                 {none, b, none, BoardColumn::warp + 1});
  }

  // Standard error of a corner's own place before it is seen: what a printer or a ruler leaves.
  static double print_sigma_m(const BoardsInput::Board& board) { return std::max(1e-4, 0.01 * board.square_m); }
  static std::string print_name(const std::string& board, const std::array<long, 2>& place, std::size_t axis) {
    return "boards/" + board + "/" + std::to_string(place[0]) + "," + std::to_string(place[1]) + "." +
           std::string(camera::print_names[axis]);
  }

  void declare_given_print(const BoardsInput::Given& given) {
    const std::size_t b = place_of(true, given.on);
    const BoardsInput::Board& board = input_.boards[b];
    const auto place = std::ranges::find(board.places, *given.place);
    const BoardRole role{none, b, none, given.column, static_cast<std::size_t>(place - board.places.begin())};
    if (place != board.places.end())
      declare_base(print_name(board.name, *place, given.column - CornerColumn::print), "m", given.value, -0.01, 0.01,
                   1e-4, role, print_sigma_m(board));
  }

  void declare_given_motion(const mechanism::Mechanism& m, const BoardsInput::Given& given) {
    for (const mechanism::Parameter& p : m.parameters)
      if (camera::corner_column(p.name) == given.column)
        result.base.push_back(declare({given.on + "/" + p.name,
                                       p.unit,
                                       given.value,
                                       given.value,
                                       p.lower,
                                       p.upper,
                                       size_of(given.column),
                                       {},
                                       {*given.view}},
                                      {none, none, *given.view, given.column}));
  }

  void declare_given(const BoardsInput::Given& given) {
    if (given.place) return declare_given_print(given);
    const mechanism::Mechanism& m = *mechanism::find_mechanism(given.mechanism);
    if (given.view) return declare_given_motion(m, given);
    const bool of_board = m.target == mechanism::Target::board;
    const std::size_t target = place_of(of_board, given.on);
    for (const mechanism::Parameter& p : m.parameters)
      if (camera::corner_column(p.name) == given.column)
        declare_base((of_board ? "boards/" : "cameras/") + given.on + "/" + p.name, p.unit, given.value, p.lower,
                     p.upper, size_of(given.column), role_of(of_board, target, given.column));
  }

  void declare_view(std::size_t v) {
    if (input_.views[v].pose_of != v) return;
    std::vector<std::size_t> groups;
    for (std::size_t w = v; w < input_.views.size(); ++w)
      if (input_.views[w].pose_of == v) groups.push_back(w);
    for (std::size_t i = 0; i < 6; ++i)
      result.base.push_back(declare({input_.views[v].image + "/" + pose_names[i],
                                     i < 3 ? "rad" : "m",
                                     0,
                                     0,
                                     -infinity,
                                     infinity,
                                     1e-3,
                                     {},
                                     groups},
                                    {none, none, v, BoardColumn::rotation + i}));
  }

  std::size_t place_of(bool of_board, const std::string& name) const {
    for (std::size_t b = 0; of_board && b < input_.boards.size(); ++b)
      if (input_.boards[b].name == name) return b;
    for (std::size_t c = 0; !of_board && c < input_.cameras.size(); ++c)
      if (input_.cameras[c].name == name) return c;
    return 0;
  }
  static BoardRole role_of(bool of_board, std::size_t target, std::size_t column) {
    return of_board ? BoardRole{none, target, none, column} : BoardRole{target, none, none, column};
  }

  // One candidate, or one for each unit in which a drift is stated (per kelvin, per second): those are alternatives.
  void declare_mechanism(const mechanism::Mechanism& m) {
    std::vector<std::string> rates;
    for (const mechanism::Parameter& p : m.parameters) {
      const std::string rate = rate_of(p);
      if (std::find(rates.begin(), rates.end(), rate) == rates.end()) rates.push_back(rate);
    }
    for (const std::string& rate : rates) {
      Candidate candidate{&m, {}, {}, rates.size() > 1 ? m.id : ""};
      // A sag, or any smooth shape of which it is a part.
      if (m.id == mechanism::board_warp().id || m.id == mechanism::board_shape().id ||
          m.id == mechanism::board_print().id)
        candidate.family = the_boards_shape;
      const bool of_board = m.target == mechanism::Target::board;
      for (std::size_t t = 0; t < (of_board ? input_.boards.size() : input_.cameras.size()); ++t)
        add_target(m, rate, of_board, t, candidate);
      if (!candidate.parameters.empty()) result.candidates.push_back(std::move(candidate));
    }
  }
  static std::string rate_of(const mechanism::Parameter& p) {
    const std::size_t slash = p.unit.find('/');
    return slash == std::string::npos ? "" : p.unit.substr(slash);
  }

  void add_target(const mechanism::Mechanism& m, const std::string& rate, bool of_board, std::size_t target,
                  Candidate& candidate) {
    const std::string& name = of_board ? input_.boards[target].name : input_.cameras[target].name;
    const std::size_t targets = of_board ? input_.boards.size() : input_.cameras.size();
    const std::size_t before = candidate.parameters.size();
    if (m.id == mechanism::board_print().id) return add_print(m, target, candidate);
    std::vector<std::pair<const mechanism::Parameter*, std::size_t>> motions;
    for (const mechanism::Parameter& p : m.parameters) {
      const auto column = camera::corner_column(p.name);
      if (!column)
        throw Error(Exit::internal, "explain",
                    "mechanism " + m.id + " has no term " + p.name + " in tables of corners");
      const BoardRole role = role_of(of_board, target, *column);
      if (rate_of(p) != rate || !can_be_shown(role)) continue;
      candidate.finer = *column == BoardColumn::distortion + LensTerm::fisheye || *column >= CornerColumn::shape;
      if (CornerColumn::is_motion(*column)) {
        motions.emplace_back(&p, *column);
        continue;
      }
      const std::string prefix = targets > 1 ? (of_board ? "boards/" : "cameras/") + name + "/" : m.id + ".";
      candidate.parameters.push_back(declare(
          {prefix + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size_of(*column), {}, groups_of(role)},
          role));
    }
    add_motions(motions, target, candidate);
    if (candidate.parameters.size() > before) candidate.on.push_back(name);
  }

  // Three numbers of every corner (print_places.h).
  void add_print(const mechanism::Mechanism& m, std::size_t b, Candidate& candidate) {
    const BoardsInput::Board& board = input_.boards[b];
    const bool given =
        std::ranges::any_of(input_.given, [&](const BoardsInput::Given& g) { return g.place && g.on == board.name; });
    if (given || board.places.empty()) return;
    candidate.finer = true;
    candidate.on.push_back(board.name);
    for (std::size_t k = 0; k < board.places.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const mechanism::Parameter& p = m.parameters[axis];
        const BoardRole role{none, b, none, CornerColumn::print + axis, k};
        candidate.parameters.push_back(declare({print_name(board.name, board.places[k], axis), p.unit, 0, 0, p.lower,
                                                p.upper, 1e-4, print_sigma_m(board), groups_of(role)},
                                               role));
      }
    candidate.things = static_cast<double>(candidate.parameters.size() / (3 * candidate.on.size()));
  }

  // Every view has its own motion: nuisance like its pose, under one mechanism.
  void add_motions(const std::vector<std::pair<const mechanism::Parameter*, std::size_t>>& motions, std::size_t camera,
                   Candidate& candidate) {
    if (motions.empty()) return;
    for (std::size_t v = 0; v < input_.views.size(); ++v) {
      if (input_.views[v].camera != camera) continue;
      for (const auto& [p, column] : motions)
        candidate.parameters.push_back(declare({input_.views[v].image + "/" + p->name,
                                                p->unit,
                                                p->start,
                                                p->neutral,
                                                p->lower,
                                                p->upper,
                                                size_of(column),
                                                {},
                                                {v}},
                                               {none, none, v, column}));
    }
  }

  // Does the base model lack it, and do these recordings speak of it?
  bool can_be_shown(const BoardRole& role) const {
    const std::size_t column = role.column;
    const auto says = [&](const BoardsInput::Given& given) {
      if (given.column != column) return false;
      if (given.view) return input_.views[*given.view].camera == role.camera;
      return role.board == none ? role.camera == place_of(false, given.on) : role.board == place_of(true, given.on);
    };
    if (std::ranges::any_of(input_.given, says)) return false;
    if (is_lens(column)) return lacks_lens_term(input_.cameras[role.camera], column - BoardColumn::distortion);
    if (role.board != none && column < CornerColumn::motion) return !input_.boards[role.board].warped;
    if (column == CornerColumn::scale + 1) return false;  // only the ratio of the two shows
    if (column >= CornerColumn::colour && column < CornerColumn::bias) return has_colour(role.camera, column);
    if (column >= CornerColumn::shape) return !is_sag(column) || !input_.boards[role.board].warped;
    if (column >= CornerColumn::focal) return input_.cameras[role.camera].held;
    if (column >= CornerColumn::port) return true;
    if (column >= CornerColumn::by_time) return varies(&BoardsInput::View::later_s);
    if (column >= CornerColumn::by_temperature) return varies(&BoardsInput::View::warmer_K);
    return true;
  }

  // A denominator says how the polynomial falls short: over a moderate field both bow lines alike, and the plain one is
  // to be named first. An equidistant lens has no denominators: they have faded there. Another projection is tried
  // where the lens has none; beside a polynomial it is the finer name (Candidate::finer).
  static bool lacks_lens_term(const BoardsInput::Camera& camera, std::size_t term) {
    const auto has = [&](std::size_t t) {
      return std::find(camera.terms.begin(), camera.terms.end(), t) != camera.terms.end();
    };
    if (has(term)) return false;
    const std::array<double, camera::distortion_terms>& lens = camera.intrinsics.distortion;
    if (term == LensTerm::fisheye) return lens[term] == 0;
    const bool denominator = term >= LensTerm::k4 && term <= LensTerm::k6;
    return !denominator || (has(LensTerm::k1) && lens[term] == 0 && lens[LensTerm::fisheye] < 1);
  }

  // Red and blue against green; where there is no green, blue against red.
  bool has_colour(std::size_t camera, std::size_t column) const {
    std::array<bool, 3> seen{};
    for (const BoardsInput::View& v : input_.views)
      for (const BoardsInput::Corner& c : v.corners)
        if (v.camera == camera) seen[static_cast<std::size_t>(c.colour)] = true;
    const auto [red, green, blue] = seen;
    return column < CornerColumn::colour + 2 ? red && green : blue && (green || red);
  }

  bool varies(double BoardsInput::View::*difference) const {
    return std::any_of(input_.views.begin(), input_.views.end(),
                       [&](const BoardsInput::View& v) { return v.*difference != 0; });
  }

  const BoardsInput& input_;
};

}  // namespace

BoardParameters board_parameters(const BoardsInput& input) {
  return std::move(Declaration(input).result);
}

const camera::CornerModel& BoardScene::of(const BoardsInput::Corner& corner) {
  const std::array<double, 3> own =
      corner.of_board < print_m.size() ? print_m[corner.of_board] : std::array{0., 0., 0.};
  std::ranges::copy(own, model.values.begin() + CornerColumn::print);
  return model;
}

BoardScene board_scene(const BoardsInput& input, const std::vector<BoardRole>& roles, std::span<const double> values,
                       std::size_t group) {
  const BoardsInput::View& view = input.views[group];
  const BoardsInput::Camera& camera = input.cameras[view.camera];
  const BoardsInput::Board& board = input.boards[view.board];
  BoardScene s;
  s.model.extent = board.extent;
  s.model.height_px = camera.height_px;
  s.model.warmer_K = view.warmer_K;
  s.model.later_s = view.later_s;
  auto& v = s.model.values;
  const camera::Intrinsics& k = camera.intrinsics;
  v[0] = k.fx_px, v[1] = k.fy_px, v[2] = k.cx_px, v[3] = k.cy_px;
  std::copy(k.distortion.begin(), k.distortion.end(), v.begin() + BoardColumn::distortion);
  v[BoardColumn::warp] = board.warp.sag_x_m, v[BoardColumn::warp + 1] = board.warp.sag_y_m;
  std::array<double, 6> change{};
  for (std::size_t p = 0; p < roles.size(); ++p) {
    const BoardRole& r = roles[p];
    const bool pose = r.view != none && r.column < BoardColumn::warp;
    if (pose && r.view == view.pose_of) change[r.column - BoardColumn::rotation] = values[p];
    if (r.corner != none) {
      if (r.board != view.board || values[p] == 0) continue;
      s.print_m.resize(board.places.size());
      s.print_m[r.corner][r.column - CornerColumn::print] = values[p];
      continue;
    }
    if ((!pose && r.view == group) || r.camera == view.camera || r.board == view.board) v[r.column] = values[p];
  }
  if (!s.print_m.empty()) s.print_m = board.print.displaced(std::move(s.print_m));
  s.turn = {change[0], change[1], change[2]};
  s.model.pose = camera::moved(view.camera_from_board, change);
  return s;
}

}  // namespace gonio::explain
