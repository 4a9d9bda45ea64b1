// Model "probe": highlights of lamps on mirror balls, seen by calibrated cameras (probe/highlight_rows.h has the
// columns). The base model takes every lamp as infinitely far, in a free direction u of two numbers; a lamp that the
// manifest has at a place, or whose inverse distance q the table's parameters hold, is at that:
//   way = u - q (c - o),   u_px, v_px = project(the ball's point that mirrors the way into the camera),
// c the ball's centre, o the middle of all balls (probe/mirror_ball.h solves for the point). What is known of a centre
// with an error is free within it: three whitened numbers for each ball.
//
// What may be left out: probe.distance (one q for all lamps, or one for each), probe.centre (of each ball: its place,
// its radius, or both), lens.radial of a camera whose lens has no radial term.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/pixel_rows.h"
#include "explain/tables/probe_scene.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/table.h"
#include "probe/highlight_rows.h"
#include "probe/mechanisms/probe_distance.h"
#include "probe/unwrap.h"

namespace gonio::mechanism {
const Mechanism& lens_radial();
const Mechanism& probe_centre();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

using Values = std::span<const double>;
constexpr std::size_t none = Table::none;
constexpr double direction_step = 1e-2, distance_step_per_m = 0.1, centre_step_m = 1e-4, lens_step = 0.01;
constexpr double largest_change = 0.3;  // of a ball's radius
constexpr std::array<std::size_t, 3> radial_terms = {camera::LensTerm::k1, camera::LensTerm::k2, camera::LensTerm::k3};

struct Reach {  // where a parameter acts; none: everywhere
  std::size_t lamp = none, ball = none, camera = none;
};

class Probe final : public PixelRows {
 public:
  Probe(const manifest::Document& document, const std::string& name, const Table& table)
      : PixelRows(table, "probe", "highlights"), name_(name), scene_(probe_scene(document, name, table)) {
    bind_lamps(document.tables.at(name), table);
    bind_balls(table);
    bind_distance(table);
    for (std::size_t b = 0; b < scene_.balls.size(); ++b) bind_centre(b, table);
    for (std::size_t c = 0; c < scene_.cameras.size(); ++c) bind_lens(c, table);
    believe();
    bind_conditions();
  }

  std::string remarks(std::span<const std::string> named, Values values, std::span<const double> sigma) const override {
    if (std::ranges::find(named, mechanism::probe_distance().id) == named.end()) return {};
    std::string text;
    for (std::size_t l = 0; l < scene_.lamps.size(); ++l) {
      const double q = inverse_distance(values, l), width = inverse_distance_sigma(values, sigma, l);
      if (!(q > 0)) continue;
      text += (text.empty() ? "From the balls' middle, lamps stand at " : ", ") +
              inference::estimate_in_words(1 / q, width / (q * q), "m") + " (" + scene_.lamps[l].name + ")";
    }
    return text.empty() ? text : text + ".";
  }

  // Directions and places of the manifest's lights; the inverse distances of other lamps as the table's parameters.
  void apply(Values values, std::span<const double> sigma, manifest::Document& document) const override {
    for (std::size_t l = 0; l < scene_.lamps.size(); ++l) {
      const double q = inverse_distance(values, l), width = inverse_distance_sigma(values, sigma, l);
      const ProbeLamp& lamp = scene_.lamps[l];
      const Vec3 u = direction(values, l);
      const double st = sigma[lamp_place_[l]], sb = sigma[lamp_place_[l] + 1];
      const FittedLamp fitted{scene_.middle_m, u, lamp.frame.t * st, lamp.frame.b * sb, q, width};
      if (lamp.in_manifest)
        write_back(fitted, document.lights.at(lamp.name));
      else if (q != 0)
        store_parameter(document.tables.at(name_), lamp.name + "/inverse_distance_per_m", q, width);
    }
  }
  // Lamps have their places among the lights, or in the table: the mechanism would act twice.
  bool is_of_manifest(const Candidate& candidate) const override {
    return candidate.mechanism != &mechanism::probe_distance();
  }

 private:
  bool reaches(std::size_t parameter, std::size_t row) const override {
    const Reach& reach = reach_[parameter];
    const ProbeRow& s = scene_.rows[row];
    return (reach.lamp == none || reach.lamp == s.lamp) && (reach.ball == none || reach.ball == s.ball) &&
           (reach.camera == none || reach.camera == s.camera);
  }

  std::size_t add(Parameter p, Reach reach, const Table& table) {
    reach_.push_back(reach);
    const std::size_t own = parameters_.size();
    p.groups = groups_reached(table, [&](std::size_t r) { return reaches(own, r); });
    parameters_.push_back(std::move(p));
    return own;
  }
  std::size_t add_base(const std::string& name, const std::string& unit, double size, Reach reach, const Table& table) {
    Parameter p;
    p.name = name, p.unit = unit, p.size = size;
    base_.push_back(add(std::move(p), reach, table));
    return base_.back();
  }
  std::size_t add_declared(const mechanism::Mechanism& m, std::size_t k, const std::string& on, double size,
                           Reach reach, const Table& table) {
    const mechanism::Parameter& d = m.parameters.at(k);
    const std::string prefix = m.id + "." + (on.empty() ? "" : on + "/");
    return add({prefix + d.name, d.unit, d.start, d.neutral, d.lower, d.upper, size, {}, {}}, reach, table);
  }

  void bind_lamps(const manifest::Table& section, const Table& table) {
    for (std::size_t l = 0; l < scene_.lamps.size(); ++l) {
      const ProbeLamp& lamp = scene_.lamps[l];
      lamp_place_.push_back(add_base("lamps/" + lamp.name + "/towards_1", "1", direction_step, {.lamp = l}, table));
      add_base("lamps/" + lamp.name + "/towards_2", "1", direction_step, {.lamp = l}, table);
      // Free where it was found before.
      ModelParameter q =
          model_parameter(section, name_, lamp.name + "/inverse_distance_per_m", "1/m", lamp.inverse_distance_per_m,
                          lamp.in_manifest && lamp.inverse_distance_per_m > 0);
      const mechanism::Parameter& d = mechanism::probe_distance().parameters[0];
      q.parameter.lower = std::max(q.parameter.lower, d.lower),
      q.parameter.upper = std::min(q.parameter.upper, d.upper);
      q.parameter.size = distance_step_per_m;
      const bool far = !q.free && q.parameter.start == 0;
      own_distance_.push_back(far ? none : add(std::move(q.parameter), {.lamp = l}, table));
      if (q.free) base_.push_back(own_distance_.back());
    }
    extra_distance_.assign(scene_.lamps.size(), none);
  }
  void bind_balls(const Table& table) {
    for (std::size_t b = 0; b < scene_.balls.size(); ++b) {
      known_.push_back(none);
      centre_.push_back({none, none, none, none});
      if (!scene_.balls[b].uncertain) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t place =
            add_base("balls/" + scene_.balls[b].name + format("/centre_%zu", k + 1), "1", 1, {.ball = b}, table);
        parameters_[place].prior_sigma = 1;
        if (k == 0) known_[b] = place;
      }
    }
  }
  void bind_distance(const Table& table) {
    const mechanism::Mechanism& m = mechanism::probe_distance();
    const auto far = std::ranges::count(own_distance_, none);
    if (far == 0) return;
    shared_distance_ = add_declared(m, 0, "", distance_step_per_m, {}, table);
    candidates_.push_back({&m, {}, {shared_distance_}, m.id});
    if (far < 2) return;
    Candidate each{&m, {}, {}, m.id, true};  // another form of the same, and so on the same targets
    for (std::size_t l = 0; l < scene_.lamps.size(); ++l)
      if (own_distance_[l] == none) {
        extra_distance_[l] = add_declared(m, 0, scene_.lamps[l].name, distance_step_per_m, {.lamp = l}, table);
        each.parameters.push_back(extra_distance_[l]);
      }
    candidates_.push_back(std::move(each));
  }
  void bind_centre(std::size_t b, const Table& table) {
    const mechanism::Mechanism& m = mechanism::probe_centre();
    const std::string on = "ball " + scene_.balls[b].name;
    const double most = largest_change * scene_.balls[b].stated.radius_m;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t place = add_declared(m, k, on, centre_step_m, {.ball = b}, table);
      parameters_[place].lower = std::max(parameters_[place].lower, -most);
      parameters_[place].upper = std::min(parameters_[place].upper, most);
      centre_[b][k] = place;
    }
    const auto [x, y, z, radius] = centre_[b];
    candidates_.push_back({&m, {on}, {radius}, m.id + " " + on});
    candidates_.push_back({&m, {on}, {x, y, z}, m.id + " " + on, true});
    candidates_.push_back({&m, {on}, {x, y, z, radius}, m.id + " " + on, true});
  }
  void bind_lens(std::size_t c, const Table& table) {
    lens_.push_back(none);
    const auto& terms = scene_.cameras[c].camera.intrinsics().distortion;
    if (scene_.cameras[c].camera.orthographic() || terms[camera::LensTerm::fisheye] != 0 ||
        std::ranges::any_of(radial_terms, [&](std::size_t t) { return terms[t] != 0; }))
      return;
    const mechanism::Mechanism& m = mechanism::lens_radial();
    Candidate candidate{&m, {scene_.cameras[c].name}, {}, {}};
    for (std::size_t k = 0; k < radial_terms.size(); ++k)
      candidate.parameters.push_back(add_declared(m, k, scene_.cameras[c].name, lens_step, {.camera = c}, table));
    lens_.back() = candidate.parameters[0];
    candidates_.push_back(std::move(candidate));
  }

  static double at(Values values, std::size_t place) { return place == none ? 0 : values[place]; }
  Vec3 direction(Values values, std::size_t lamp) const {
    const Basis& f = scene_.lamps[lamp].frame;
    return normalized(f.n + f.t * values[lamp_place_[lamp]] + f.b * values[lamp_place_[lamp] + 1]);
  }
  double inverse_distance(Values values, std::size_t lamp) const {
    if (own_distance_[lamp] != none) return values[own_distance_[lamp]];
    return at(values, shared_distance_) + at(values, extra_distance_[lamp]);
  }
  double inverse_distance_sigma(Values values, std::span<const double> sigma, std::size_t lamp) const {
    if (own_distance_[lamp] != none) return sigma[own_distance_[lamp]];
    return at(values, shared_distance_) != 0 ? sigma[shared_distance_] : at(sigma, extra_distance_[lamp]);
  }
  probe::Ball ball_of(Values values, std::size_t b) const {
    const ProbeBall& ball = scene_.balls[b];
    probe::Ball moved = ball.stated;
    for (std::size_t k = 0; k < 3 && known_[b] != none; ++k) moved.centre_m += ball.root[k] * values[known_[b] + k];
    const auto& own = centre_[b];
    moved.centre_m += Vec3{at(values, own[0]), at(values, own[1]), at(values, own[2])};
    moved.radius_m += at(values, own[3]);
    return moved;
  }
  std::optional<Vec2> through_lens(Values values, std::size_t c, const ImageView& view, Vec3 world_m) const {
    const Vec3 seen = inverse(view.world_from_camera) * world_m;
    if (lens_[c] == none || (values[lens_[c]] == 0 && values[lens_[c] + 1] == 0 && values[lens_[c] + 2] == 0))
      return view.camera.project(seen);
    camera::Intrinsics lens = view.camera.intrinsics();
    for (std::size_t k = 0; k < radial_terms.size(); ++k) lens.distortion[radial_terms[k]] = values[lens_[c] + k];
    return view.camera.with(lens).project(seen);
  }
  struct Spot {
    Vec2 pixel;
    double incidence_rad = 0;
  };
  std::optional<Spot> spot_of(Values values, std::size_t row) const {
    const ProbeRow& s = scene_.rows[row];
    const ImageView& view = scene_.views[s.view];
    const probe::Ball ball = ball_of(values, s.ball);
    const double q = inverse_distance(values, s.lamp);
    const Vec3 way = equation::probe_distance(direction(values, s.lamp), ball.centre_m - scene_.middle_m, q);
    const double length = gonio::norm(way);
    const auto shown = probe::mirror_before(view.camera, view.world_from_camera, ball).shown(way / length, length / q);
    if (!shown) return {};
    const auto pixel = through_lens(values, s.camera, view, shown->point_m);
    if (!pixel) return {};
    return Spot{*pixel, std::acos(std::clamp(shown->cosine, 0.0, 1.0))};
  }
  Vec2 pixel_of(Values values, std::size_t row) const override {
    const auto spot = spot_of(values, row);
    return spot ? spot->pixel : believed_.empty() ? Vec2{std::nan(""), 0} : believed_[row].pixel;
  }

  void believe();
  void bind_conditions();

  std::string name_;
  ProbeScene scene_;
  std::vector<Reach> reach_;                                // one per parameter
  std::vector<std::size_t> lamp_place_, own_distance_;      // one per lamp: of the first tangent; of its own q
  std::size_t shared_distance_ = none;                      // of all that have no own one
  std::vector<std::size_t> extra_distance_, known_, lens_;  // per lamp, ball, camera: of the first number
  std::vector<std::array<std::size_t, 4>> centre_;          // per ball
  std::vector<Spot> believed_;                              // by the base model as the manifest has it
};

// Where the base model as it stands sees every highlight.
void Probe::believe() {
  std::vector<double> values;
  for (const Parameter& p : parameters_) values.push_back(p.neutral);
  for (const std::size_t p : base_) values[p] = parameters_[p].start;
  std::vector<Spot> believed;
  for (std::size_t r = 0; r < scene_.rows.size(); ++r) {
    const auto spot = spot_of(values, r);
    const ProbeRow& s = scene_.rows[r];
    if (!spot)
      throw Error(Exit::data, scene_.place,
                  "has lamp \"" + scene_.lamps[s.lamp].name + "\" in image \"" + scene_.views[s.view].image +
                      "\", where ball " + scene_.balls[s.ball].name + " cannot show it",
                  "check which highlights are of one lamp, and the image's world_from_camera");
    believed.push_back(*spot);
  }
  believed_ = std::move(believed);
}

// Curves along directions of which the model says how many pixels their unit is: inverse distances of single lamps,
// metres of the ball.
void Probe::bind_conditions() {
  std::vector<double> values;
  for (const Parameter& p : parameters_) values.push_back(p.neutral);
  Condition lamp{"light.identity", "1", "light", {}, {}, "1/m"};
  Condition incidence{"surface.incidence-angle", "rad", "pose", {}, {}, "px"};
  Condition radius{"camera.image-radius", "half width", "lens", {}, {}, "px"};
  std::array<Condition, 3> shifts{Condition{"probe.shift-x", "rad", "pose", {}, {}, "m"},
                                  Condition{"probe.shift-y", "rad", "pose", {}, {}, "m"},
                                  Condition{"probe.shift-z", "rad", "pose", {}, {}, "m"}};
  const auto append = [](Condition& c, double value, Vec2 along) {
    c.values.push_back(value);
    c.direction.insert(c.direction.end(), {along.x, along.y});
  };
  const auto unit = [](Vec2 v) { return gonio::norm(v) > 0 ? v * (1 / gonio::norm(v)) : Vec2{}; };
  for (std::size_t r = 0; r < scene_.rows.size(); ++r) {
    const ProbeRow& s = scene_.rows[r];
    const ImageView& view = scene_.views[s.view];
    const Spot& spot = believed_[r];
    const Vec2 off = spot.pixel - view.camera.principal_point_px();
    const Vec3 centre = inverse(view.world_from_camera) * scene_.balls[s.ball].stated.centre_m;
    const std::size_t q = own_distance_[s.lamp] == none ? shared_distance_ : own_distance_[s.lamp];
    append(lamp, static_cast<double>(s.lamp), slope_of(values, q, r));
    append(incidence, spot.incidence_rad, unit(spot.pixel - view.camera.project(centre).value_or(spot.pixel)));
    append(radius, gonio::norm(off) / (0.5 * view.camera.width_px()), unit(off));
    for (std::size_t k = 0; k < 3; ++k) append(shifts[k], spot.incidence_rad, slope_of(values, centre_[s.ball][k], r));
  }
  conditions_ = {std::move(lamp), std::move(incidence), std::move(radius)};
  conditions_.insert(conditions_.end(), shifts.begin(), shifts.end());
}

std::vector<Column> columns_of_model() {
  std::vector<Column> columns;
  for (const probe::HighlightColumn& c : probe::highlight_columns())
    columns.push_back({c.name, c.unit, c.meaning, c.needed});
  return columns;
}

}  // namespace

const Model& probe() {
  static const Model model{.name = "probe",
                           .sentence =
                               "Highlights of lamps on mirror balls: lamps that are infinitely far, each in a "
                               "direction of its own.",
                           .columns = columns_of_model(),
                           .score_name = "RMS distance of highlights",
                           .unit = "px",
                           .group_noun = "view",
                           .group = "view",
                           .importance = Importance::share_of_residual,
                           .reads_light = false,
                           .bind = bind_as<Probe>};
  return model;
}

}  // namespace gonio::explain::tables
