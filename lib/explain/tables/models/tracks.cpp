// Model "tracks": points of a known shape, followed through the frames of a film. The base model is scaled
// orthographic, each frame with a rotation, a scale and a shift of its own:
//   q = R (X - centre),   u = cx + U / (1 + q_z s / f),   U = s q_x + t_x - cx,   and so v,
// where 1 / f = 0 makes every point as far as the frame's centre (tracks.perspective frees it: the scale is f over the
// distance, so that one number serves all frames). A camera with a focal length fixes f. Then the lens about (cx, cy),
// r = |(U, V)| over the focal length (over the picture's width where there is none); then, of tracks that slipped, a
// displacement from a frame on. Columns x_m, y_m, z_m may be the same in all frames (a rigid shape) or not.
// Weak perspective: Hartley & Zisserman 2004, section 6.3.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "camera/lens_terms.h"
#include "explain/tables/table_model.h"
#include "explain/tables/tracks_pose.h"
#include "explain/tables/tracks_slips.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/table.h"
#include "mechanism/mechanism.h"
#include "stats/intervals.h"

namespace gonio::mechanism {
const Mechanism& lens_radial();
const Mechanism& tracks_outliers();
const Mechanism& tracks_perspective();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

constexpr std::size_t fewest_points = 6;  // of a frame: six numbers of pose from twelve coordinates
constexpr std::array<const char*, 6> pose_names = {"rotation_x_rad", "rotation_y_rad", "rotation_z_rad",
                                                   "scale_px_per_m", "x_px",           "y_px"};

class Tracks final : public BoundModel {
 public:
  Tracks(const manifest::Document& document, const std::string& name, const Table& table) : name_(name) {
    if (table.observed.size() != 2)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "model tracks predicts two: u_px and v_px");
    read_rows(table);
    read_camera(document);
    bind_frames(table);
    bind_physics(document, table);
    bind_conditions();
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    std::size_t frame = none;
    Mat3 rotation;
    for (std::size_t r = first; r < last; ++r) {
      if (frame != rows_[r].frame) {
        frame = rows_[r].frame;
        const double* p = &values[6 * frame];
        rotation = matrix_of(quaternion_of_rotation_vector({p[0], p[1], p[2]}) * frames_[frame].rotation);
      }
      const Vec2 pixel = project(values, r, rotation * (rows_[r].point_m - frames_[frame].centre_m));
      prediction[2 * (r - first)] = pixel.x;
      prediction[2 * (r - first) + 1] = pixel.y;
    }
  }
  // Half a square for each of two coordinates: the score is the RMS distance, in pixels.
  std::vector<double> norm() const override { return std::vector<double>(2 * rows_.size(), 0.5); }
  std::vector<double> sigma() const override { return std::vector<double>(2 * rows_.size(), noise_px()); }

  void apply(std::span<const double>, std::span<const double>, manifest::Document&) const override {}

 private:
  static constexpr std::size_t none = Table::none;
  struct Row {
    Vec3 point_m;
    Vec2 pixel;
    std::size_t frame = 0, point = 0;  // in the order in which they appear
  };

  void read_rows(const Table& table) {
    const auto &x = table.needed("x_m", "m"), &y = table.needed("y_m", "m"), &z = table.needed("z_m", "m");
    const auto &frame = table.needed("frame", ""), &point = table.needed("point", "");
    std::map<double, std::size_t> points;
    for (const double p : point) points.try_emplace(p, 0);
    for (auto& [key, place] : points) {
      place = point_names_.size();
      point_names_.push_back(shortest_text(key));
      point_numbers_.push_back(key);
    }
    std::map<double, std::size_t> frames;
    for (const double f : frame) frames.try_emplace(f, 0);
    for (auto& [key, place] : frames) {
      place = frame_names_.size();
      frame_names_.push_back(shortest_text(key));
    }
    for (std::size_t r = 0; r < table.rows(); ++r)
      rows_.push_back({{x[r], y[r], z[r]},
                       {table.values[table.observed[0]][r], table.values[table.observed[1]][r]},
                       frames.at(frame[r]),
                       points.at(point[r])});
  }

  // Principal point and, of a perspective camera, focal length and radial terms. Without a camera: the middle of all
  // tracks.
  void read_camera(const manifest::Document& document) {
    Vec2 least = rows_[0].pixel, most = least;
    for (const Row& row : rows_) {
      least = {std::min(least.x, row.pixel.x), std::min(least.y, row.pixel.y)};
      most = {std::max(most.x, row.pixel.x), std::max(most.y, row.pixel.y)};
    }
    centre_ = (least + most) * 0.5;
    nominal_focal_ = std::max(1.0, most.x - least.x);
    const std::string& name = document.tables.at(name_).camera;
    if (name.empty()) return;
    const auto found = document.cameras.find(name);
    const std::string place = manifest::place(document, "/cameras/" + name);
    if (found == document.cameras.end())
      throw Error(Exit::data, place, "is not described", "describe it in cameras, or leave the table's camera out");
    const manifest::Camera& camera = found->second;
    camera_ = name;
    if (camera.width_px > 0 && camera.height_px > 0) {
      centre_ = {0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1)};
      nominal_focal_ = camera.width_px;
    }
    if (camera.cx_px.given()) centre_.x = camera.cx_px.scalar();
    if (camera.cy_px.given()) centre_.y = camera.cy_px.scalar();
    if (camera.model == "orthographic" || !camera.fx_px.given()) return;
    nominal_focal_ = camera.fx_px.scalar();
    inverse_focal_ = 1 / nominal_focal_;
    for (std::size_t k = 0; k < radial_.size(); ++k)
      if (const auto term = camera.distortion.find(radial_names[k]); term != camera.distortion.end())
        radial_[k] = term->second.scalar(), knows_lens_ = true;
  }

  void bind_frames(const Table& table) {
    for (std::size_t f = 0; f < frame_names_.size(); ++f) {
      std::vector<Vec3> points;
      std::vector<Vec2> pixels;
      std::vector<std::size_t> groups;
      for (std::size_t g = 0; g < table.group.size(); ++g)
        for (std::size_t r = table.first[g]; r < table.first[g + 1]; ++r) {
          if (rows_[r].frame != f) continue;
          points.push_back(rows_[r].point_m);
          pixels.push_back(rows_[r].pixel);
          if (groups.empty() || groups.back() != g) groups.push_back(g);
        }
      if (points.size() < fewest_points)
        throw Error(Exit::data, table.place,
                    "frame " + frame_names_[f] + " has " + std::to_string(points.size()) + " points (at least " +
                        std::to_string(fewest_points) + ")",
                    "leave the frame out");
      frames_.push_back(weak_pose(points, pixels));
      const WeakPose& pose = frames_.back();
      const std::array<double, 6> start = {0, 0, 0, pose.scale_px_per_m, pose.shift_px.x, pose.shift_px.y};
      const std::array<double, 6> size = {1e-2, 1e-2, 1e-2, 0.01 * pose.scale_px_per_m, 1, 1};
      for (std::size_t i = 0; i < 6; ++i) {
        Parameter p;
        p.name = "frame-" + frame_names_[f] + "/" + pose_names[i];
        p.unit = i < 3 ? "rad" : i == 3 ? "px/m" : "px";
        p.start = p.neutral = start[i];
        if (i == 3) p.lower = 1e-3 * start[i], p.upper = 1e3 * start[i];
        p.size = size[i];
        p.groups = groups;
        base_.push_back(parameters_.size());
        parameters_.push_back(std::move(p));
      }
    }
  }

  // Enters the mechanism's parameters under `prefix` and returns the place of the first.
  std::size_t declare(const mechanism::Mechanism& m, const std::string& prefix, double size,
                      const std::vector<std::size_t>& groups, Candidate& candidate) {
    const std::size_t first = parameters_.size();
    for (const mechanism::Parameter& declared : m.parameters) {
      candidate.parameters.push_back(parameters_.size());
      parameters_.push_back({prefix + declared.name,
                             declared.unit,
                             declared.start,
                             declared.neutral,
                             declared.lower,
                             declared.upper,
                             size,
                             {},
                             groups});
    }
    return first;
  }
  void bind_physics(const manifest::Document&, const Table& table) {
    if (inverse_focal_ == 0) {
      Candidate c{&mechanism::tracks_perspective(), {}, {}, {}};
      perspective_ = declare(*c.mechanism, c.mechanism->id + ".", 1e-4, {}, c);
      candidates_.push_back(std::move(c));
    }
    if (!knows_lens_) {
      Candidate c{&mechanism::lens_radial(), {}, {}, {}};
      lens_ = declare(*c.mechanism, c.mechanism->id + ".", 0.01, {}, c);
      candidates_.push_back(std::move(c));
    }
    bind_slips(table);
  }

  void bind_slips(const Table& table) {
    Candidate c{&mechanism::tracks_outliers(), {}, {}, {}};
    for (const Slip& slip : suspects()) {
      std::vector<std::size_t> groups;
      for (std::size_t g = 0; g < table.group.size(); ++g)
        for (std::size_t r = table.first[g]; r < table.first[g + 1]; ++r)
          if (rows_[r].point == slip.point && rows_[r].frame >= slip.from && (groups.empty() || groups.back() != g))
            groups.push_back(g);
      if (groups.size() < 2) continue;  // no frame could be left out
      if (groups.size() == table.group.size()) groups.clear();
      const std::string& name = point_names_[slip.point];
      c.on.push_back("point " + name + " from frame " + frame_names_[slip.from]);
      slips_.push_back({slip, declare(*c.mechanism, "point-" + name + "/", 1, groups, c)});
    }
    if (!c.parameters.empty()) candidates_.push_back(std::move(c));
  }

  // Slips of the base model's residuals; then, since a perspective or a lens hides them there, those of what smooth
  // functions of the shape's coordinates leave frame by frame: one after the other, as each bends these functions.
  std::vector<Slip> suspects() const {
    const std::vector<double> residual = base_residuals();
    std::vector<TrackPoint> plain;
    for (std::size_t r = 0; r < rows_.size(); ++r)
      plain.push_back({rows_[r].frame, rows_[r].point, {residual[2 * r], residual[2 * r + 1]}});
    std::vector<Slip> slips = find_slips(plain, frames_.size(), point_names_.size());
    while (slips.size() < most_slips) {
      const std::vector<Slip> more = find_slips(beyond_projections(slips), frames_.size(), point_names_.size());
      if (more.empty()) break;
      slips.push_back(more[0]);
    }
    return slips;
  }
  std::vector<TrackPoint> beyond_projections(const std::vector<Slip>& without) const {
    std::vector<TrackPoint> result;
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      const FrameRows frame = rows_of(f, without);
      const std::vector<double> left = beyond_quadratic(frame.points, frame.pixels);
      for (std::size_t k = 0; 2 * k < left.size(); ++k)
        result.push_back({f, rows_[frame.rows[k]].point, {left[k], left[frame.rows.size() + k]}});
    }
    return result;
  }
  // Of one frame, in pixels about its middle: places in the camera's axes, and where they are seen.
  struct FrameRows {
    std::vector<std::size_t> rows;
    std::vector<Vec3> points;
    std::vector<Vec2> pixels;
  };
  FrameRows rows_of(std::size_t frame, const std::vector<Slip>& without) const {
    FrameRows result;
    const WeakPose& pose = frames_[frame];
    const Mat3 rotation = matrix_of(pose.rotation);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const auto slipped = [&](const Slip& s) { return s.point == rows_[r].point; };
      if (rows_[r].frame != frame || std::any_of(without.begin(), without.end(), slipped)) continue;
      result.rows.push_back(r);
      result.points.push_back(rotation * (rows_[r].point_m - pose.centre_m) * pose.scale_px_per_m);
      result.pixels.push_back(rows_[r].pixel - pose.shift_px);
    }
    return result;
  }

  std::vector<double> base_residuals() const {
    std::vector<double> values, residual(2 * rows_.size());
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    predict(values, 0, rows_.size(), residual);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      residual[2 * r] = rows_[r].pixel.x - residual[2 * r];
      residual[2 * r + 1] = rows_[r].pixel.y - residual[2 * r + 1];
    }
    return residual;
  }

  Vec2 project(std::span<const double> values, std::size_t row, Vec3 q) const {
    const double* p = &values[6 * rows_[row].frame];
    const double inverse = perspective_ == none ? inverse_focal_ : values[perspective_];
    const double nearness = 1 / std::max(1e-3, 1 + q.z * p[3] * inverse);
    Vec2 at = Vec2{p[3] * q.x + p[4] - centre_.x, p[3] * q.y + p[5] - centre_.y} * nearness;
    std::array<double, 3> k = radial_;
    for (std::size_t i = 0; i < 3 && lens_ != none; ++i) k[i] = values[lens_ + i];
    const double r2 = dot(at, at) / (nominal_focal_ * nominal_focal_);
    at = at * (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])));
    Vec2 pixel = centre_ + at;
    for (const auto& [slip, place] : slips_)
      if (rows_[row].point == slip.point && rows_[row].frame >= slip.from)
        pixel = pixel + Vec2{values[place], values[place + 1]};
    return pixel;
  }

  // What quadratic functions of the shape's coordinates leave, frame by frame, is no projection's.
  double noise_px() const;

  void bind_conditions() {
    Condition depth{"tracks.depth", "m", "pose", {}, {}, "1"};
    Condition radius{"camera.image-radius", "half width", "lens", {}, {}, "px"};
    Condition row{"camera.image-y", "px", "sensor", {}, {}, "px"};  // what a row shifts along itself: read out late
    std::vector<double> values, prediction(2 * rows_.size());
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    predict(values, 0, rows_.size(), prediction);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const WeakPose& frame = frames_[rows_[r].frame];
      const Vec2 at = Vec2{prediction[2 * r], prediction[2 * r + 1]} - centre_;
      const double length = norm_of(at);
      const auto append = [&](Condition& c, double value, Vec2 direction) {
        c.values.push_back(value);
        c.direction.push_back(direction.x);
        c.direction.push_back(direction.y);
      };
      append(depth, (matrix_of(frame.rotation) * (rows_[r].point_m - frame.centre_m)).z, at);
      append(radius, length / (0.5 * nominal_focal_), length > 0 ? at * (1 / length) : Vec2{0, 0});
      append(row, prediction[2 * r + 1], {1, 0});
    }
    conditions_ = {std::move(depth), std::move(radius), std::move(row)};
    bind_slipped();
  }
  // Which of the tracks that may have slipped: the point's number, from its frame on, along its own step. Made of the
  // base model's residuals like the candidate itself, whose six widths are what noise hardly does; absent without it.
  void bind_slipped() {
    if (slips_.empty()) return;
    Condition point{"tracks.point", "1", "sensor", {}, {}, "px"};
    for (const Row& row : rows_) {
      point.values.push_back(std::nan(""));
      Vec2 towards;
      for (const auto& [slip, place] : slips_)
        if (row.point == slip.point && row.frame >= slip.from)
          point.values.back() = point_numbers_[row.point], towards = slip.towards;
      point.direction.push_back(towards.x);
      point.direction.push_back(towards.y);
    }
    conditions_.push_back(std::move(point));
  }
  static double norm_of(Vec2 v) { return std::hypot(v.x, v.y); }

  static constexpr std::array<const char*, 3> radial_names = {"k1", "k2", "k3"};
  std::string name_, camera_;
  std::vector<Row> rows_;
  std::vector<std::string> point_names_, frame_names_;
  std::vector<double> point_numbers_;
  std::vector<WeakPose> frames_;
  std::vector<std::pair<Slip, std::size_t>> slips_;  // and the place of its parameters
  Vec2 centre_;
  double inverse_focal_ = 0, nominal_focal_ = 1;
  std::array<double, 3> radial_{};
  bool knows_lens_ = false;
  std::size_t perspective_ = none, lens_ = none;
};

double Tracks::noise_px() const {
  std::vector<double> left;
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    const FrameRows frame = rows_of(f, {});
    const std::vector<double> own = beyond_quadratic(frame.points, frame.pixels);
    left.insert(left.end(), own.begin(), own.end());
  }
  return left.size() < 30 ? 1 : std::max(1e-6, stats::robust_sigma(left));
}

}  // namespace

const Model& tracks() {
  static const Model model{
      .name = "tracks",
      .sentence = "Points of a known shape followed through frames: scaled orthographic, each frame with its own pose.",
      .columns = {{"frame", "", "whose pose it has"},
                  {"point", "", "of the shape, the same in all frames"},
                  {"x_m", "m", "of the point, in the shape's frame"},
                  {"y_m", "m", "of the point, in the shape's frame"},
                  {"z_m", "m", "of the point, in the shape's frame"}},
      .score_name = "RMS reprojection error",
      .unit = "px",
      .group_noun = "frame",
      .group = "frame",
      .importance = Importance::share_of_residual,
      .bind = bind_as<Tracks>};
  return model;
}

}  // namespace gonio::explain::tables
