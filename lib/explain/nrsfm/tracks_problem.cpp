// See tracks_problem.h.
#include "explain/nrsfm/tracks_problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/nrsfm/tracks_outcome.h"
#include "inference/explanation.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& tracks_outliers();
const Mechanism& tracks_perspective();
const Mechanism& tracks_scale();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using gonio::nrsfm::Followed;
using gonio::nrsfm::Layout;
using gonio::nrsfm::Outliers;
using gonio::nrsfm::Run;

constexpr double depth_start = 0.05, depth_most = 0.8;  // kappa times the largest radius
constexpr double most_log_scale = 1.5;

class TracksProblem final : public Problem {
 public:
  explicit TracksProblem(Followed followed)
      : followed_(std::move(followed)),
        outliers_(followed_.outliers),
        layout_(followed_.layout),
        start_(followed_.start) {
    for (const double size : followed_.shape_size) extent_ = std::hypot(extent_, size);
    parameters_.resize(layout_.count);
    name_frames();
    name_shapes();
    name_physics();
    for (std::size_t p = 0; p < layout_.count; ++p)
      parameters_[p].start += start_[p], parameters_[p].neutral = start_[p];
    choose_base();
    const bool free_weights = layout_.basis > layout_.weight;
    lacking_ = free_weights && !followed_.inverse_focal && followed_.near_camera().lacking;
    name_outliers();
    observe();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    followed_.predict(values, group, prediction);
  }
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override {
    followed_.jacobian(values, group, columns, derivatives);
  }

  std::string domain() const override { return "nrsfm"; }
  std::string unit() const override { return track_unit(followed_); }
  std::string score_name() const override { return "RMS reprojection error"; }
  std::string group_noun() const override { return "point"; }
  Importance importance() const override { return Importance::share_of_residual; }

  std::optional<Calibration> calibration(std::size_t parameter) const override {
    if (parameter == layout_.perspective && followed_.pinhole) return Calibration{1 / (*followed_.pinhole)[0], {}};
    return std::nullopt;  // priors hold gauge freedoms only
  }
  std::string remarks(const Explanation& e) const override { return tracks_remarks(view(), e); }
  void apply(const Explanation& e, manifest::Document& document) const override { upgrade_tracks(view(), e, document); }
  // Where shapes are lacking nothing is raced: see conclude_shapes().
  std::vector<std::size_t> tested_apart() const override {
    std::vector<std::size_t> places;
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (lacking_ || (c + 1 == candidates_.size() && !outliers_.runs.empty())) places.push_back(c);
    return places;
  }
  double fit_tolerance() const override { return lacking_ ? 1e-3 : Problem::fit_tolerance(); }
  void conclude(Explanation& e) const override {
    std::optional<std::size_t> perspective;
    for (std::size_t c = 0; c < candidates_.size(); ++c)
      if (candidates_[c].id() == mechanism::tracks_perspective().id) perspective = c;
    conclude_shapes(view(), perspective, e);
    if (outliers_.runs.empty()) return;
    conclude_outliers(view(), candidates_.size() - 1, e);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_tracks(view(), e);
  }

 private:
  TracksView view() const { return {*this, followed_}; }

  std::string frame_name(std::size_t f) const { return "frame-" + std::to_string(followed_.frames[f]) + "/"; }

  void name_frames() {
    const std::string unit = track_unit(followed_);
    const char* axes[] = {"x", "y", "z"};
    for (std::size_t f = 0; f < followed_.frames.size(); ++f) {
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
    for (std::size_t p = layout_.weight; p < layout_.basis; ++p) {
      parameters_[p].name = "weights/" + std::to_string(p - layout_.weight);
      parameters_[p].unit = "1", parameters_[p].size = 0.01;
    }
    const std::size_t terms = followed_.terms;
    const std::vector<double>& size = followed_.shape_size;
    for (std::size_t p = 0; p < followed_.points.size(); ++p)
      for (std::size_t k = 0; k < terms; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          Parameter& b = parameters_[layout_.basis + 3 * (terms * p + k) + axis];
          b.name = "point-" + std::to_string(followed_.points[p]) + "/shape_" + std::to_string(k) + "xyz"[axis];
          b.unit = track_unit(followed_);
          b.size = 0.01 * std::max(size[k], 1e-6 * extent_);
          b.prior_sigma = std::max(size[k], 1e-6 * extent_);
          b.groups = {p};
        }
  }

  void name_physics() {
    double depth = 0;  // or half width, whichever is more: no camera stands within the shape
    for (std::size_t p = 0; p < followed_.points.size(); ++p)
      for (const Followed::Place& place : followed_.places(start_, p))
        depth = std::max(depth, std::hypot(place.camera[0], place.camera[1], place.camera[2]));
    const mechanism::Mechanism& m = mechanism::tracks_perspective();
    Parameter& kappa = parameters_[layout_.perspective];
    kappa.name = m.id + "." + m.parameters[0].name, kappa.unit = "1/" + track_unit(followed_);
    // Negative where the solver's depths are reversed, which an orthographic camera does not see.
    kappa.lower = -depth_most / depth, kappa.upper = depth_most / depth;
    kappa.size = 0.01 / depth;
    kappa.start = depth_start / depth;  // neutral is 0, where the start stands
    if (followed_.inverse_focal) start_[layout_.perspective] = *followed_.inverse_focal, kappa.start = 0;
  }

  void choose_base() {
    const auto join = [&](std::size_t first, std::size_t last, const mechanism::Mechanism& m, bool known) {
      std::vector<std::size_t> own;
      for (std::size_t p = first; p < last; ++p) own.push_back(p);
      if (known)
        base_.insert(base_.end(), own.begin(), own.end());
      else
        candidates_.push_back({&m, {}, own, {}});
    };
    for (std::size_t p = layout_.rotation; p < layout_.scale; ++p) base_.push_back(p);
    for (std::size_t p = layout_.weight; p < layout_.perspective; ++p) base_.push_back(p);
    join(layout_.perspective, layout_.count, mechanism::tracks_perspective(), followed_.inverse_focal.has_value());
    join(layout_.scale, layout_.weight, mechanism::tracks_scale(), followed_.free_scales);
  }

  // Their offsets are known before the race and stay where they are.
  void name_outliers() {
    if (outliers_.runs.empty()) return;
    Candidate c{&mechanism::tracks_outliers(), {}, {}, {}};
    for (const Run& run : outliers_.runs) {
      c.on.push_back(gonio::nrsfm::hidden_name(followed_.sequence, run.point, run.first, run.last));
      for (std::size_t i = 0; i < 2; ++i) {
        Parameter p;
        p.name = c.on.back() + "/" + c.mechanism->parameters[i].name;
        p.unit = track_unit(followed_);
        p.start = p.neutral = run.offset[i];
        c.parameters.push_back(parameters_.size());
        parameters_.push_back(std::move(p));
      }
    }
    candidates_.push_back(std::move(c));
  }

  void observe() {
    Observations& o = observations_;
    const double sigma = std::max(outliers_.noise, 1e-9 * extent_);
    // Neighbouring frames share their noise; where they are few, the halves of a point need every one.
    const std::size_t frames_a_block = followed_.frames.size() >= 12 + 6 * followed_.terms ? 2 : 1;
    std::uint32_t block = 0;
    o.first.push_back(0);
    for (std::size_t p = 0; p < followed_.points.size(); ++p) {
      o.group.push_back("point " + std::to_string(followed_.points[p]));
      const std::vector<std::size_t>& seen = followed_.seen(p);
      const std::vector<double> tracks = followed_.observed(p);
      for (std::size_t k = 0; k < seen.size(); ++k) {
        if (k > 0 && seen[k] / frames_a_block != seen[k - 1] / frames_a_block) ++block;
        for (std::size_t i = 0; i < 2; ++i) {
          o.value.push_back(tracks[2 * k + i]);
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
    const std::string unit = track_unit(followed_);
    Condition depth{"tracks.depth", unit, "pose", {}, {}, "1"}, time{"tracks.frame", "", "pose", {}, {}, "1"};
    Condition radius{"camera.image-radius", unit, "lens", {}, {}, unit};
    const auto append = [](Condition& c, double value, double x, double y) {
      c.values.insert(c.values.end(), {value, value});
      c.direction.insert(c.direction.end(), {x, y});
    };
    for (std::size_t p = 0; p < followed_.points.size(); ++p) {
      const std::vector<Followed::Place> places = followed_.places(start_, p);
      for (std::size_t k = 0; k < places.size(); ++k) {
        const auto [x, y] = places[k].picture;
        const double r = std::hypot(x, y), frame = static_cast<double>(followed_.frames[followed_.seen(p)[k]]);
        append(depth, places[k].camera[2], x, y);
        append(time, frame, places[k].camera[0], places[k].camera[1]);
        append(radius, r, r > 0 ? x / r : 0, r > 0 ? y / r : 0);
      }
    }
    observations_.conditions = {std::move(depth), std::move(time), std::move(radius)};
  }

  Followed followed_;
  const Outliers& outliers_;
  const Layout& layout_;
  std::vector<double> start_;
  double extent_ = 0;  // root mean square of a coordinate
  bool lacking_ = false;
};

}  // namespace

std::unique_ptr<Problem> tracks_problem(Followed followed) {
  return std::make_unique<TracksProblem>(std::move(followed));
}

}  // namespace gonio::explain
