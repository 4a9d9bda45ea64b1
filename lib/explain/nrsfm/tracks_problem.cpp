// See tracks_problem.h.
#include "explain/nrsfm/tracks_problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/explanation.h"
#include "explain/nrsfm/tracks_outcome.h"
#include "explain/own_tests.h"
#include "nrsfm/manifest_sequences.h"

namespace gonio::explain {
namespace {

using namespace tracks;

constexpr double depth_start = 0.05, depth_most = 0.8;  // kappa times the largest radius
constexpr double most_log_scale = 1.5;
constexpr double false_alarm = 0.01;  // of tracks.outliers, a sequence

const mechanism::Mechanism& declared(const char* id) {
  const mechanism::Mechanism* m = mechanism::find_mechanism(id);
  if (m == nullptr) throw Error(Exit::internal, "explain", std::string("mechanism ") + id + " is not registered");
  return *m;
}

// What takes part in the race: everything but observations that do not follow.
Solved sound(const Solved& solved, const Outlying& outlying) {
  Solved s = solved;
  s.sequence = without(solved.sequence, outlying.runs);
  return s;
}

class TracksProblem final : public Problem, public OwnTests {
 public:
  explicit TracksProblem(TracksInput input)
      : input_(std::move(input)),
        outlying_(find_outlying(input_.solved, false_alarm)),
        model_(solved_model(sound(input_.solved, outlying_))),
        layout_(model_.layout()) {
    input_.solved = sound(input_.solved, outlying_);
    look();
    start_ = model_.values();
    parameters_.resize(layout_.count);
    name_frames();
    name_shapes();
    name_physics();
    for (std::size_t p = 0; p < layout_.count; ++p)
      parameters_[p].start += start_[p], parameters_[p].neutral = start_[p];
    choose_base();
    name_outliers();
    observe();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    model_.predict(values, group, seen_[group], prediction);
  }
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    model_.jacobian(values, group, seen_[group], columns, derivatives);
  }

  std::string domain() const override { return "nrsfm"; }
  std::string unit() const override { return track_unit(input_.solved.sequence); }
  std::string score_name() const override { return "RMS reprojection error"; }
  std::string group_noun() const override { return "point"; }
  Importance importance() const override { return Importance::share_of_residual; }

  std::optional<Calibration> calibration(std::size_t parameter) const override {
    const auto& pinhole = input_.solved.sequence.pinhole;
    if (parameter == layout_.perspective && pinhole) return Calibration{1 / pinhole->fx_px, {}};
    return std::nullopt;  // priors hold gauge freedoms only
  }
  std::string remarks(const Explanation& e) const override { return tracks_remarks(view(), e); }
  void apply(const Explanation& e, manifest::Document& document) const override { upgrade_tracks(view(), e, document); }
  std::vector<std::size_t> tested() const override {
    return outlying_.runs.empty() ? std::vector<std::size_t>{} : std::vector<std::size_t>{candidates_.size() - 1};
  }
  void conclude(Explanation& e) const override {
    conclude_shapes(view(), e);
    if (outlying_.runs.empty()) return;
    conclude_outliers(view(), candidates_.size() - 1, e);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_tracks(view(), e);
  }

 private:
  TracksView view() const { return {*this, input_, model_, layout_, seen_, start_, outlying_}; }

  // In which frames, by place, every point that takes part is seen.
  void look() {
    const SolvedModel& m = model_.start();
    for (const Eigen::Index p : m.points) {
      seen_.emplace_back();
      for (Eigen::Index f = 0; f < m.frame_count(); ++f)
        if (input_.solved.sequence.visible(m.frames[static_cast<std::size_t>(f)], p)) seen_.back().push_back(f);
    }
  }

  std::string frame_name(std::size_t f) const { return "frame-" + std::to_string(model_.start().frames[f]) + "/"; }

  void name_frames() {
    const std::string unit = track_unit(input_.solved.sequence);
    const SolvedModel& m = model_.start();
    double extent = 0;
    for (const Eigen::MatrixXd& b : m.basis) extent += b.squaredNorm();
    extent_ = std::sqrt(extent / static_cast<double>(3 * m.point_count()));
    const char* axes[] = {"x", "y", "z"};
    for (std::size_t f = 0; f < m.frames.size(); ++f) {
      for (std::size_t i = 0; i < 3; ++i) {
        Parameter& turn = parameters_[layout_.rotation + 3 * f + i];
        turn.name = frame_name(f) + "rotation_" + axes[i] + "_rad", turn.unit = "rad", turn.size = 0.01;
      }
      for (std::size_t i = 0; i < 2; ++i) {
        Parameter& shift = parameters_[layout_.shift + 2 * f + i];
        shift.name = frame_name(f) + axes[i], shift.unit = unit, shift.size = 0.01 * extent_;
      }
      if (f == 0) continue;
      Parameter& scale = parameters_[layout_.scale + f - 1];
      scale.name = frame_name(f) + "log_scale", scale.unit = "1", scale.size = 0.01;
      scale.lower = -most_log_scale, scale.upper = most_log_scale;
    }
  }

  // Shapes and weights may be exchanged, turned and shifted against the frames: a prior about the solver's answer, as
  // wide as the shapes themselves, chooses among what predicts the same.
  void name_shapes() {
    const SolvedModel& m = model_.start();
    for (std::size_t p = layout_.weight; p < layout_.basis; ++p) {
      parameters_[p].name = "weights/" + std::to_string(p - layout_.weight);
      parameters_[p].unit = "1", parameters_[p].size = 0.01;
    }
    const auto terms = static_cast<std::size_t>(m.terms());
    std::vector<double> size(terms, 0.0);
    for (const Eigen::MatrixXd& b : m.basis)
      for (std::size_t k = 0; k < terms; ++k)
        size[k] += b.col(static_cast<Eigen::Index>(k)).squaredNorm() / static_cast<double>(3 * m.point_count());
    for (std::size_t p = 0; p < m.points.size(); ++p)
      for (std::size_t k = 0; k < terms; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          Parameter& b = parameters_[layout_.basis + 3 * (terms * p + k) + axis];
          b.name = "point-" + std::to_string(m.points[p]) + "/shape_" + std::to_string(k) + "xyz"[axis];
          b.unit = track_unit(input_.solved.sequence);
          b.size = 0.01 * std::sqrt(size[k]);
          b.prior_sigma = std::max(std::sqrt(size[k]), 1e-6 * extent_);
          b.groups = {p};
        }
  }

  void name_physics() {
    const std::vector<DeformingModel::Frame> frames = model_.frames(start_);
    double depth = 0;  // or half width, whichever is more: no camera stands within the shape
    for (std::size_t p = 0; p < seen_.size(); ++p)
      for (const Eigen::Index f : seen_[p])
        depth = std::max(depth, model_.in_camera(start_, frames[static_cast<std::size_t>(f)], p).norm());
    const mechanism::Mechanism& m = declared("tracks.perspective");
    Parameter& kappa = parameters_[layout_.perspective];
    kappa.name = m.id + "." + m.parameters[0].name, kappa.unit = "1/" + track_unit(input_.solved.sequence);
    // Negative where the solver's depths are reversed, which an orthographic camera does not see.
    kappa.lower = -depth_most / depth, kappa.upper = depth_most / depth;
    kappa.size = 0.01 / depth;
    kappa.start = depth_start / depth;  // neutral is 0, where the start stands
    if (input_.inverse_focal) start_[layout_.perspective] = *input_.inverse_focal, kappa.start = 0;
  }

  void choose_base() {
    const auto join = [&](std::size_t first, std::size_t last, const char* id, bool known) {
      std::vector<std::size_t> own;
      for (std::size_t p = first; p < last; ++p) own.push_back(p);
      if (known)
        base_.insert(base_.end(), own.begin(), own.end());
      else
        candidates_.push_back({&declared(id), {}, own, {}});
    };
    for (std::size_t p = layout_.rotation; p < layout_.scale; ++p) base_.push_back(p);
    for (std::size_t p = layout_.weight; p < layout_.perspective; ++p) base_.push_back(p);
    join(layout_.perspective, layout_.count, "tracks.perspective", input_.inverse_focal.has_value());
    join(layout_.scale, layout_.weight, "tracks.scale", input_.solved.free_scales);
  }

  // Their offsets are known before the race and stay where they are.
  void name_outliers() {
    if (outlying_.runs.empty()) return;
    Candidate c{&declared("tracks.outliers"), {}, {}, {}};
    for (const Run& run : outlying_.runs) {
      c.on.push_back(gonio::nrsfm::hidden_name(input_.sequence, run.point, run.first, run.last));
      for (Eigen::Index i = 0; i < 2; ++i) {
        Parameter p;
        p.name = c.on.back() + "/" + c.mechanism->parameters[static_cast<std::size_t>(i)].name;
        p.unit = track_unit(input_.solved.sequence);
        p.start = p.neutral = run.offset(i);
        c.parameters.push_back(parameters_.size());
        parameters_.push_back(std::move(p));
      }
    }
    candidates_.push_back(std::move(c));
  }

  void observe() {
    Observations& o = observations_;
    const SolvedModel& m = model_.start();
    const double sigma = std::max(outlying_.noise, 1e-9 * extent_);
    // Neighbouring frames share their noise; where they are few, the halves of a point need every one.
    const Eigen::Index frames_a_block = m.frame_count() >= 12 + 6 * m.terms() ? 2 : 1;
    std::uint32_t block = 0;
    o.first.push_back(0);
    for (std::size_t p = 0; p < seen_.size(); ++p) {
      o.group.push_back("point " + std::to_string(m.points[p]));
      Eigen::Index before = -1;
      for (const Eigen::Index f : seen_[p]) {
        if (before >= 0 && f / frames_a_block != before / frames_a_block) ++block;
        before = f;
        for (Eigen::Index i = 0; i < 2; ++i) {
          o.value.push_back(input_.solved.sequence.tracks(2 * m.frames[static_cast<std::size_t>(f)] + i, m.points[p]));
          o.sigma.push_back(sigma);
          o.norm.push_back(0.5);
          o.block.push_back(block);
        }
      }
      ++block;
      o.first.push_back(o.value.size());
    }
    observe_conditions();
  }

  void observe_conditions() {
    const std::string unit = track_unit(input_.solved.sequence);
    Condition depth{"tracks.depth", unit, "pose", {}, {}, "1"}, time{"tracks.frame", "", "pose", {}, {}, "1"};
    Condition radius{"camera.image-radius", unit, "lens", {}, {}, unit};
    const SolvedModel& m = model_.start();
    const std::vector<DeformingModel::Frame> frames = model_.frames(start_);
    for (std::size_t p = 0; p < seen_.size(); ++p)
      for (const Eigen::Index f : seen_[p]) {
        const DeformingModel::Frame& frame = frames[static_cast<std::size_t>(f)];
        const Eigen::Vector3d q = model_.in_camera(start_, frame, p);
        const Eigen::Vector2d at = q.head<2>() + frame.shift - m.centre, about = q.head<2>();
        const auto append = [](Condition& c, double value, const Eigen::Vector2d& direction) {
          for (Eigen::Index i = 0; i < 2; ++i) c.values.push_back(value), c.direction.push_back(direction(i));
        };
        append(depth, q.z(), at);
        append(time, static_cast<double>(m.frames[static_cast<std::size_t>(f)]), about);
        append(radius, at.norm(), at.normalized());
      }
    observations_.conditions = {std::move(depth), std::move(time), std::move(radius)};
  }

  TracksInput input_;
  Outlying outlying_;
  DeformingModel model_;
  Layout layout_;
  std::vector<std::vector<Eigen::Index>> seen_;
  std::vector<double> start_;
  double extent_ = 1;  // root mean square of a coordinate
};

}  // namespace

std::unique_ptr<Problem> tracks_problem(TracksInput input) {
  return std::make_unique<TracksProblem>(std::move(input));
}

}  // namespace gonio::explain
