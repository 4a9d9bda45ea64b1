// Model "markers": spheres glued to pieces that were scanned elsewhere, seen in calibrated photographs of the scene
// into which the pieces were put back (reassembly/marker_rows.h has the columns). The base model:
//   u = project(camera, world_from_camera^-1 world_from_object x)
// with the pose of a piece free where the manifest states its sigma (it was estimated) and held where it does not (it
// was known); with the cameras' poses and the tomograph's centres x free within their stated sigmas: an error of one
// camera is in all of its rows, and one of a centre in all views, and neither is physics that was left out. Table
// parameters PIECE/shift_z_m = 0 hold a single number of a pose: a lid that stands by contact.
//
// What may be left out acts in this order: ct.scale and marker.offset in the piece's frame, geometry.pose and
// geometry.contact on the piece, marker.refracted on the line of sight. A piece that was
// nudged between two sittings (images' `group`) is a geometry.pose that acts in one of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "explain/tables/marker_scene.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/pixel_rows.h"
#include "explain/tables/table_model.h"
#include "manifest/document.h"
#include "manifest/sections/object.h"
#include "manifest/sections/table.h"
#include "reassembly/mechanisms/marker_offset.h"
#include "reassembly/mechanisms/marker_refracted.h"
#include "scene/placement.h"
#include "volume/mechanisms/ct_scale.h"

namespace gonio::mechanism {
const Mechanism& geometry_contact();
const Mechanism& geometry_pose();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

constexpr double pose_step_m = 1e-4, pose_step_rad = 1e-3;
using Values = std::span<const double>;

// Where a parameter acts; what is not said is no limit.
struct Reach {
  std::size_t view = Table::none, piece = Table::none, marker = Table::none;
  std::string sitting{};
  bool behind_glass = false;
};

class Markers final : public PixelRows {
 public:
  Markers(const manifest::Document& document, const std::string& name, const Table& table)
      : PixelRows(table, "markers", "markers"), name_(name), scene_(marker_scene(document, table)) {
    bind_poses(document.tables.at(name), table);
    bind_known(table);
    bind_tomograph();
    bind_pieces(table);
    check_sight(table);
    bind_conditions();
  }

  // Fitted poses go back to the objects, with their sigmas.
  void apply(Values values, std::span<const double> sigma, manifest::Document& document) const override {
    for (std::size_t piece = 0; piece < scene_.pieces.size(); ++piece) {
      const std::size_t* own = &pose_[6 * piece];
      if (std::none_of(own, own + 6, [&](std::size_t p) { return values[p] != 0 || sigma[p] > 0; })) continue;
      for (manifest::Object& object : document.objects) {
        if (object.id != scene_.pieces[piece].object) continue;
        auto& pose = object.world_from_object.emplace();
        const scene::Instance moved = base_instance(values, piece);
        static_cast<Rigid<frame::World, frame::Object>&>(pose) = moved.world_from_object;
        const auto three = [&](std::size_t k) { return Vec3{sigma[own[k]], sigma[own[k + 1]], sigma[own[k + 2]]}; };
        pose.sigma = sigma_at_origin(moved, three(0), three(3));
      }
    }
  }
  bool is_of_manifest(const Candidate& candidate) const override {
    return std::ranges::none_of(moves_, [&](const Move& m) {
      return !m.sitting.empty() && std::ranges::find(m.places, candidate.parameters[0]) != m.places.end();
    });
  }

 private:
  static constexpr std::size_t none = Table::none;
  // A mechanism that moves a whole piece: scene/placement.h has its equation.
  struct Move {
    const mechanism::Mechanism* mechanism;
    std::size_t piece;
    std::string sitting;              // empty: in all
    std::vector<std::size_t> places;  // one per number of the mechanism; none: neutral
  };

  bool reaches(std::size_t parameter, std::size_t row) const override {
    const Reach& reach = reach_[parameter];
    const Sighting& s = scene_.rows[row];
    return (reach.view == none || reach.view == s.view) && (reach.piece == none || reach.piece == s.piece) &&
           (reach.marker == none || reach.marker == s.marker) && (!reach.behind_glass || s.behind_glass) &&
           (reach.sitting.empty() || reach.sitting == scene_.views[s.view].sitting);
  }
  std::size_t add(Parameter parameter, Reach reach, const Table* table) {
    reach_.push_back(std::move(reach));
    const std::size_t own = reach_.size() - 1;
    if (table != nullptr) parameter.groups = groups_reached(*table, [&](std::size_t r) { return reaches(own, r); });
    parameters_.push_back(std::move(parameter));
    return parameters_.size() - 1;
  }

  void bind_poses(const manifest::Table& section, const Table& table) {
    for (std::size_t piece = 0; piece < scene_.pieces.size(); ++piece) {
      for (const mechanism::Parameter& declared : mechanism::geometry_pose().parameters) {
        const std::string label = scene_.pieces[piece].object + "/" + declared.name;
        ModelParameter own = model_parameter(section, name_, label, declared.unit, 0, scene_.pieces[piece].estimated);
        own.parameter.size = declared.unit == "m" ? pose_step_m : pose_step_rad;
        own.parameter.name = "objects/" + label;
        pose_.push_back(add(std::move(own.parameter), {.piece = piece}, &table));
        if (own.free) base_.push_back(pose_.back());
        held_.push_back(!own.free);
      }
    }
  }

  // What is known with an error: the cameras' poses, the centres in the tomograph's volume.
  void bind_known(const Table& table) {
    constexpr std::array<const char*, 6> numbers = {
        "rotation_x_rad", "rotation_y_rad", "rotation_z_rad", "x_m", "y_m", "z_m"};
    view_pose_.assign(6 * scene_.views.size(), none);
    for (std::size_t v = 0; v < scene_.views.size(); ++v)
      for (std::size_t k = 0; k < scene_.views[v].sigma.size(); ++k)
        view_pose_[6 * v + k] = add_known("images/" + scene_.views[v].image + "/" + numbers[k], k < 3 ? "rad" : "m",
                                          scene_.views[v].sigma[k], {.view = v}, table);
    centre_.assign(3 * scene_.markers.size(), none);
    for (const Sighting& s : scene_.rows)
      for (std::size_t k = 0; k < 3; ++k)
        if (std::size_t& place = centre_[3 * s.marker + k]; place == none)
          place = add_known("markers/" + scene_.markers[s.marker] + "/" + numbers[3 + k], "m", s.centre_sigma_m,
                            {.marker = s.marker}, table);
  }
  std::size_t add_known(const std::string& name, const std::string& unit, double sigma, Reach reach,
                        const Table& table) {
    if (!(sigma > 0)) return none;
    Parameter p;
    p.name = name, p.unit = unit, p.size = sigma, p.prior_sigma = sigma;
    base_.push_back(add(std::move(p), std::move(reach), &table));
    return base_.back();
  }

  // Enters all numbers of the mechanism, or those of `wanted`, as a candidate on `on`.
  std::vector<std::size_t> propose_mechanism(const mechanism::Mechanism& m, const std::vector<std::string>& on,
                                             const Reach& reach, const Table* table,
                                             const std::vector<bool>& wanted = {}) {
    Candidate candidate{&m, on, {}, {}};
    std::vector<std::size_t> places;
    const std::string prefix = on.empty() ? m.id + "." : m.id + "." + on[0] + "/";
    for (std::size_t k = 0; k < m.parameters.size(); ++k) {
      places.push_back(none);
      if (!wanted.empty() && !wanted[k]) continue;
      const mechanism::Parameter& d = m.parameters[k];
      const double size = std::max(std::abs(d.start - d.neutral), 1e-4);
      places[k] = add({prefix + d.name, d.unit, d.start, d.neutral, d.lower, d.upper, size, {}, {}}, reach, table);
      candidate.parameters.push_back(places[k]);
    }
    candidates_.push_back(std::move(candidate));
    return places;
  }

  void bind_tomograph() {
    const auto any = [&](auto what) { return std::ranges::any_of(scene_.rows, what); };
    if (any([](const Sighting& s) { return s.has_normal; }))
      offset_ = propose_mechanism(mechanism::marker_offset(), {}, {}, nullptr)[0];
    if (any([](const Sighting& s) { return s.behind_glass; }))
      index_ = propose_mechanism(mechanism::marker_refracted(), {}, {.behind_glass = true}, nullptr)[0];
    scale_ = propose_mechanism(mechanism::ct_scale(), {}, {}, nullptr);
    // All lengths alike is the plainer form; both numbers are in the finer one.
    Candidate& both = candidates_.back();
    Candidate plain = both;
    plain.parameters = {scale_[0]};
    both.finer = true;
    candidates_.insert(candidates_.end() - 1, std::move(plain));
  }

  // A pose that is free already hides what moves a piece: the candidate stands there all the same, so that the answer
  // is that it cannot be told.
  void bind_pieces(const Table& table) {
    std::vector<std::string> sittings;
    for (const MarkerView& v : scene_.views)
      if (std::ranges::find(sittings, v.sitting) == sittings.end()) sittings.push_back(v.sitting);
    for (std::size_t piece = 0; piece < scene_.pieces.size(); ++piece) {
      const std::string& object = scene_.pieces[piece].object;
      std::vector<bool> held(held_.begin() + static_cast<std::ptrdiff_t>(6 * piece),
                             held_.begin() + static_cast<std::ptrdiff_t>(6 * piece + 6));
      if (std::ranges::none_of(held, std::identity{})) held.clear();
      add_move(mechanism::geometry_pose(), piece, "", {object}, table, held);
      add_move(mechanism::geometry_contact(), piece, "", {object}, table);
      for (std::size_t k = 1; k < sittings.size(); ++k)
        add_move(mechanism::geometry_pose(), piece, sittings[k], {object + " in images " + sittings[k]}, table);
    }
  }
  void add_move(const mechanism::Mechanism& m, std::size_t piece, const std::string& sitting,
                const std::vector<std::string>& on, const Table& table, const std::vector<bool>& wanted = {}) {
    const Reach reach{.piece = piece, .sitting = sitting};
    std::vector<std::size_t> places = propose_mechanism(m, on, reach, &table, wanted);
    moves_.push_back({&m, piece, sitting, std::move(places)});
  }

  static double at(Values values, std::size_t place) { return place == none ? 0 : values[place]; }

  scene::Instance base_instance(Values values, std::size_t piece) const {
    std::array<double, 6> numbers{};
    for (std::size_t k = 0; k < 6; ++k) numbers[k] = values[pose_[6 * piece + k]];
    return scene::moved(scene_.pieces[piece].instance, mechanism::geometry_pose(), numbers);
  }
  Rigid<frame::World, frame::Object> pose_of(Values values, const Sighting& s) const {
    scene::Instance instance = base_instance(values, s.piece);
    for (const Move& move : moves_) {
      if (move.piece != s.piece || (!move.sitting.empty() && move.sitting != scene_.views[s.view].sitting)) continue;
      std::vector<double> amounts;
      for (const std::size_t place : move.places) amounts.push_back(at(values, place));
      instance = scene::moved(instance, *move.mechanism, amounts);
    }
    return instance.world_from_object;
  }
  Rigid<frame::World, frame::Camera> camera_pose(Values values, std::size_t view) const {
    Rigid<frame::World, frame::Camera> pose = scene_.views[view].world_from_camera;
    const std::size_t* own = &view_pose_[6 * view];
    if (own[0] == none && own[3] == none) return pose;
    const Vec3 turn{at(values, own[0]), at(values, own[1]), at(values, own[2])};
    pose.rotation = quaternion_of_rotation_vector(turn) * pose.rotation;
    pose.translation_m += Vec3{at(values, own[3]), at(values, own[4]), at(values, own[5])};
    return pose;
  }
  // In the piece's frame.
  Vec3 centre_of(Values values, const Sighting& s) const {
    const std::size_t* own = &centre_[3 * s.marker];
    const Vec3 x = equation::ct_scale_undone(s.centre_m, at(values, scale_[0]), at(values, scale_[1]));
    const Vec3 off{at(values, own[0]), at(values, own[1]), at(values, own[2])};
    return equation::marker_offset(x, s.normal, at(values, offset_)) + off;
  }
  std::optional<Vec2> project(Values values, const Sighting& s, Vec3 world_m) const {
    const auto camera = camera_pose(values, s.view);
    const MarkerView& view = scene_.views[s.view];
    if (s.behind_glass && index_ != none) {
      const Vec3 straight_to = scene_.pieces[s.piece].instance.world_from_object * s.centre_m;
      world_m = equation::marker_refracted(camera.translation_m, world_m, view.world_from_camera.translation_m,
                                           straight_to, s.glass, values[index_]);
    }
    return view.camera.project(inverse(camera) * world_m);
  }
  Vec2 pixel_of(Values values, std::size_t row) const override {
    const Sighting& s = scene_.rows[row];
    const auto pixel = project(values, s, pose_of(values, s) * centre_of(values, s));
    return pixel.value_or(believed_.empty() ? Vec2{std::nan(""), 0} : believed_[row]);
  }
  std::vector<double> neutral() const {
    std::vector<double> values;
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    return values;
  }

  void check_sight(const Table& table) {
    const std::vector<double> values = neutral();
    std::vector<Vec2> believed;
    for (std::size_t r = 0; r < scene_.rows.size(); ++r) {
      believed.push_back(pixel_of(values, r));
      const Sighting& s = scene_.rows[r];
      if (!std::isfinite(believed.back().x))
        throw Error(Exit::data, table.place,
                    "has marker \"" + scene_.markers[s.marker] + "\" in image \"" + scene_.views[s.view].image +
                        "\", behind whose camera it stands",
                    "check world_from_camera of the image and world_from_object of the piece");
    }
    believed_ = std::move(believed);
  }

  void bind_conditions();

  std::string name_;
  MarkerScene scene_;
  std::vector<Reach> reach_;                     // one per parameter
  std::vector<std::size_t> pose_;                // six per piece
  std::vector<bool> held_;                       // likewise
  std::vector<std::size_t> view_pose_, centre_;  // six per view, three per marker; none: known exactly
  std::size_t offset_ = none, index_ = none;     // places of parameters
  std::vector<std::size_t> scale_{none, none};
  std::vector<Move> moves_;
  std::vector<Vec2> believed_;  // by the base model as the manifest has it
};

// Each is a curve in metres along a direction of which the pictures say how many pixels a metre is.
void Markers::bind_conditions() {
  const std::vector<double> values = neutral();
  const auto make = [](const char* name, const char* unit, const char* stage, const char* curve) {
    return Condition{name, unit, stage, {}, {}, curve};
  };
  Condition facing = make("surface.exitance-angle", "rad", "geometry", "m"),
            height = make("marker.height", "m", "pose", "m"),
            size = make("marker.distance-from-origin", "m", "tomograph", "m"),
            axial = make("volume.height", "m", "tomograph", "m"), path = make("glass.path", "m", "geometry", "px"),
            angle = make("glass.incidence", "rad", "geometry", "px");
  const auto append = [](Condition& c, double value, Vec2 direction) {
    c.values.push_back(value);
    c.direction.insert(c.direction.end(), {direction.x, direction.y});
  };
  std::vector<double> bent = values;
  if (index_ != none) bent[index_] = parameters_[index_].start;
  constexpr double step_m = 1e-5;
  for (std::size_t r = 0; r < scene_.rows.size(); ++r) {
    const Sighting& s = scene_.rows[r];
    const auto pose = pose_of(values, s);
    const Vec3 world = pose * s.centre_m, eye = scene_.views[s.view].world_from_camera.translation_m;
    const Vec3 sight = normalized(world - eye);
    const auto along = [&](Vec3 w) {
      const auto moved = project(values, s, world + w * step_m);
      return moved ? (*moved - believed_[r]) * (1 / step_m) : Vec2{};
    };
    const double length = gonio::norm(s.centre_m);
    append(facing, s.has_normal ? std::acos(std::clamp(-dot(pose.rotate(s.normal), sight), -1.0, 1.0)) : std::nan(""),
           along(pose.rotate(s.normal)));
    append(height, world.z, along({0, 0, 1}));
    append(size, length, length > 0 ? along(pose.rotate(s.centre_m / length)) : Vec2{});
    append(axial, s.centre_m.z, along(pose.rotate({0, 0, 1})));
    const Vec2 moved = s.behind_glass ? pixel_of(bent, r) - believed_[r] : Vec2{};
    const double shift = gonio::norm(moved);
    const Vec2 towards = shift > 0 ? moved * (1 / shift) : Vec2{};
    append(path, s.behind_glass ? s.glass[0].path_m : std::nan(""), towards);
    append(angle, s.behind_glass ? std::acos(std::min(1.0, std::abs(dot(s.glass[0].in, sight)))) : std::nan(""),
           towards);
  }
  conditions_ = {std::move(facing), std::move(height), std::move(size), std::move(axial)};
  if (index_ != none) conditions_.insert(conditions_.end(), {std::move(path), std::move(angle)});
}

std::vector<Column> columns_of_model() {
  std::vector<Column> columns;
  for (const reassembly::MarkerColumn& c : reassembly::marker_columns())
    columns.push_back({c.name, c.unit, c.meaning, c.needed});
  return columns;
}

}  // namespace

const Model& markers() {
  static const Model model{
      .name = "markers",
      .sentence = "Markers on pieces that were scanned elsewhere, seen in photographs of the scene they were put into.",
      .columns = columns_of_model(),
      .score_name = "RMS reprojection error",
      .unit = "px",
      .group_noun = "marker",
      .group = "marker",
      .importance = Importance::share_of_residual,
      .reads_light = false,
      .bind = bind_as<Markers>};
  return model;
}

}  // namespace gonio::explain::tables
