// See fit.h.
#include "alignment/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alignment/rim_covariance.h"
#include "alignment/rim_offsets.h"
#include "alignment/seen_points.h"
#include "base/error.h"
#include "base/parallel.h"
#include "linear/solve.h"

namespace gonio::alignment {
namespace {

using Eigen::Index;
constexpr double infinite = std::numeric_limits<double>::infinity();

// One mask that serves under several lamps is one observation, not several: of each sighting, one over how many there
// are of its kind, by points that lie on those of another one of the same rim.
std::vector<double> shares_of(const Question& question, const std::vector<SeenPoints>& seen) {
  std::vector<double> repeated(seen.size(), 1);
  for (std::size_t i = 0; i < seen.size(); ++i)
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const auto& points = question.sightings[i].points;
      if (k == i || points.empty() || !(question.sightings[k].subject == question.sightings[i].subject)) continue;
      std::size_t same = 0;
      for (const RimPoint& p : points) same += seen[k].nearest(p.pixel, p.outward, 0.1).has_value();
      repeated[i] += static_cast<double>(same) / static_cast<double>(points.size());
    }
  for (double& r : repeated) r = 1 / r;
  return repeated;
}

// One sighting's part of the sum: cost, and where slopes are asked for, J'WJ and J'Wr.
struct Part {
  double cost = 0;
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
};

class Rims final : public optim::Descent {
 public:
  Rims(const Question& question, const Setting& start, const Stage& stage, const std::vector<double>& sigma,
       const std::vector<SeenPoints>& seen, const std::vector<double>& shares, FitPath* path = nullptr)
      : q_(question),
        stage_(stage),
        sigma_(sigma),
        seen_(seen),
        shares_(shares),
        path_(path),
        at_(start),
        next_(start) {
    count_ = static_cast<Index>(numbers_of(q_.freedoms));
  }
  const Setting& setting() const { return at_; }
  double cost_at(const Setting& s) const { return sum(s, false).cost; }

  void linearise() override {
    if (path_) path_->rms_px.push_back(rms_offset(at_, q_, path_->reach_px));
    Part all = sum(at_, true);
    h_ = std::move(all.h), g_ = std::move(all.g);
  }
  optim::Proposal propose(double damping) override {
    Eigen::MatrixXd damped = h_;
    for (Index i = 0; i < count_; ++i) damped(i, i) += damping * std::max(h_(i, i), 1e-30);
    const Eigen::VectorXd step = linear::Ldlt(damped).solve(Eigen::VectorXd(-g_));
    next_ = moved(at_, q_.freedoms, {step.data(), step.data() + step.size()});
    const Eigen::VectorXd curved = h_ * step;  // by itself: within the sum GCC 12 takes it for freed
    return {.promised = -(2 * g_.dot(step) + step.dot(curved))};
  }
  double evaluate() override { return cost_at(next_); }
  void accept() override { at_ = next_; }

  Part sum(const Setting& s, bool slopes) const {
    const GroundAxes axes = ground_axes(s);
    Part all = sum_of_points(s, axes, slopes);
    contacts(s, axes, all, slopes);
    priors(s, all, slopes);
    return all;
  }
  Eigen::MatrixXd of_points(const Setting& s) const { return sum_of_points(s, ground_axes(s), true).h; }

 private:
  Part sum_of_points(const Setting& s, const GroundAxes& axes, bool slopes) const {
    std::vector<Part> parts(q_.sightings.size());
    parallel_for(0, parts.size(), [&](std::size_t i) { parts[i] = part(s, axes, i, slopes); });
    Part all;
    if (slopes) all.h = Eigen::MatrixXd::Zero(count_, count_), all.g = Eigen::VectorXd::Zero(count_);
    for (const Part& p : parts) {
      all.cost += p.cost;
      if (slopes && std::isfinite(p.cost)) all.h += p.h, all.g += p.g;
    }
    return all;
  }
  Part part(const Setting& s, const GroundAxes& axes, std::size_t index, bool slopes) const {
    const Sighting& sighting = q_.sightings[index];
    Part p;
    if (slopes) p.h = Eigen::MatrixXd::Zero(count_, count_), p.g = Eigen::VectorXd::Zero(count_);
    const ModelRim rim(s, sighting.subject);
    if (!rim.exists()) return p.cost = infinite, p;
    const double sigma = sigma_[index];
    const Loss loss{(stage_.width_px > 0 ? stage_.width_px : 2.5 * sigma) / sigma, stage_.reach_px / sigma};
    std::vector<double> row(static_cast<std::size_t>(count_));
    const auto add = [&](const RimPlace& place, Vec2 normal, double sign, double offset, double share) {
      p.cost += share * loss.cost(offset);
      if (!slopes) return;
      slopes_of(s, q_.freedoms, axes, sighting.subject.station, sighting.subject.body, sighting.subject.lamp,
                place.mesh_point, normal, row.data());
      const Eigen::Map<const Eigen::VectorXd> j(row.data(), count_);
      const double w = share * loss.weight(offset);
      p.h.selfadjointView<Eigen::Lower>().rankUpdate(j, w / (sigma * sigma));
      p.g += (w * offset * sign / sigma) * j;
    };
    const auto every = static_cast<std::size_t>(stage_.every);
    for (std::size_t i = 0; i < sighting.points.size(); i += every) {
      const RimPoint& point = sighting.points[i];
      if (!point.counts) continue;
      const auto place = rim.nearest(point.pixel, point.outward, stage_.reach_px);
      if (place && !stage_.both_ways && beneath(s, sighting.subject.body, *place)) continue;
      if (place)
        add(*place, place->outward, -1, place->distance_px / sigma, stage_.every);
      else
        p.cost += stage_.every * loss.cost(infinite);
    }
    if (stage_.both_ways) {
      const double spacing = std::max<double>(stage_.every, rim.length_px() / 2000);
      for (const RimPlace& place : rim.places(spacing)) {
        if (sighting.unseen && sighting.unseen(place.pixel)) continue;
        const auto near = seen_[index].nearest(place.pixel, place.outward, stage_.reach_px);
        if (!near) {
          p.cost += spacing * loss.cost(infinite);
          continue;
        }
        const RimPoint& point = sighting.points[*near];
        if (!point.counts) continue;
        const double d = dot(point.outward, place.pixel - point.pixel);
        add(place, point.outward, 1, d / sigma, spacing);
      }
    }
    p.cost *= shares_[index];
    if (slopes) {
      p.h.triangularView<Eigen::StrictlyUpper>() = p.h.transpose();
      p.h *= shares_[index], p.g *= shares_[index];
    }
    return p;
  }

  void contacts(const Setting& s, const GroundAxes& axes, Part& all, bool slopes) const {
    if (!s.ground) return;
    for (const Contact& c : q_.contacts) {
      const auto& points = s.bodies[c.body].shape->positions_m();
      std::size_t lowest = 0;
      double least = infinite;
      for (std::size_t v = 0; v < points.size(); ++v) {
        const double h = height_of(s, c.body, points[v]);
        if (h < least) least = h, lowest = v;
      }
      all.cost += least * least / (c.sigma_m * c.sigma_m);
      if (!slopes) continue;
      std::vector<double> row(static_cast<std::size_t>(count_));
      height_slopes(s, q_.freedoms, axes, c.body, points[lowest], row.data());
      const Eigen::Map<const Eigen::VectorXd> j(row.data(), count_);
      all.h += j * j.transpose() / (c.sigma_m * c.sigma_m);
      all.g += j * (least / (c.sigma_m * c.sigma_m));
    }
  }
  void priors(const Setting& s, Part& all, bool slopes) const {
    const std::vector<double> change = change_between(q_.stated, s, q_.freedoms);
    Index k = 0;
    for (const Freedom& f : q_.freedoms)
      for (std::size_t i = 0; i < f.size(); ++i, ++k) {
        if (!(f.prior_sigma > 0)) continue;
        const double w = 1 / (f.prior_sigma * f.prior_sigma), c = change[static_cast<std::size_t>(k)];
        all.cost += w * c * c;
        if (slopes) all.h(k, k) += w, all.g(k) += w * c;
      }
  }

  const Question& q_;
  const Stage& stage_;
  const std::vector<double>& sigma_;
  const std::vector<SeenPoints>& seen_;
  const std::vector<double>& shares_;
  FitPath* path_;
  Setting at_, next_;
  Index count_ = 0;
  Eigen::MatrixXd h_;
  Eigen::VectorXd g_;
};

}  // namespace

std::vector<Stage> stages_from(double start_px) {
  std::vector<Stage> stages;
  for (double width = start_px / 2; width > 3; width /= 3)
    stages.push_back({.reach_px = 4 * width,
                      .width_px = width,
                      .both_ways = true,
                      .every = 3,
                      .most_steps = 12,
                      .small_fall = 1e-3});
  stages.push_back(
      {.reach_px = 8, .width_px = 1.5, .both_ways = true, .every = 2, .most_steps = 12, .small_fall = 1e-4});
  stages.push_back({.reach_px = 5, .width_px = 0, .most_steps = 15, .small_fall = 1e-6});
  stages.push_back({.reach_px = 5, .width_px = 0, .most_steps = 15, .small_fall = 1e-8});
  return stages;
}

namespace {

// Down the stages, from `start`: where it ends, the last descent, and each sighting's standard deviation at its last
// stage.
struct Descent {
  Setting setting;
  optim::Descended last;
  std::vector<double> sigma, shares;
};
Descent go_down(const Setting& start, const Question& question, const std::vector<Stage>& stages,
                const std::vector<SeenPoints>& seen, FitPath* path) {
  Descent d{start, {}, std::vector<double>(question.sightings.size(), 1.0), shares_of(question, seen)};
  for (const Stage& stage : stages) {
    if (!(stage.width_px > 0))
      for (std::size_t i = 0; i < d.sigma.size(); ++i)
        d.sigma[i] = offsets_of(d.setting, question.sightings[i], seen[i], stage.reach_px).sigma_px;
    Rims rims(question, d.setting, stage, d.sigma, seen, d.shares, path);
    const double cost = rims.cost_at(d.setting);
    if (!std::isfinite(cost))
      throw Error(Exit::data, "start", "has a rim behind a camera or above its lamp", "state other poses");
    optim::Limits limits;
    limits.most_steps = stage.most_steps, limits.most_refusals = 8;
    limits.small_fall = {stage.small_fall, 0}, limits.small_promise = {stage.small_fall, 0};
    d.last = optim::descend(rims, cost, limits);
    d.setting = rims.setting();
  }
  if (path) path->rms_px.push_back(rms_offset(d.setting, question, path->reach_px));
  return d;
}

std::vector<SeenPoints> seen_points(const Question& question) {
  std::vector<SeenPoints> seen;
  for (const Sighting& s : question.sightings) seen.emplace_back(s.points);
  return seen;
}

}  // namespace

Setting settle_rims(const Setting& start, const Question& question, const std::vector<Stage>& stages, FitPath* path) {
  return go_down(start, question, stages, seen_points(question), path).setting;
}

namespace {

void find_figures(Fitted& f, const Question& question, const std::vector<SeenPoints>& seen, double reach_px) {
  f.sightings.resize(question.sightings.size());
  double squares = 0, counted = 0, explained = 0, met = 0, variance = 0;
  for (std::size_t i = 0; i < f.sightings.size(); ++i) {
    const double share = f.sightings[i].share;
    f.sightings[i] = offsets_of(f.setting, question.sightings[i], seen[i], reach_px);
    f.sightings[i].share = share;
    const SightingFit& s = f.sightings[i];
    const auto n = static_cast<double>(s.counted);
    squares += n * s.rms_px * s.rms_px, variance += n * s.sigma_px * s.sigma_px, counted += n;
    explained += n * s.explained, met += n * s.met;
  }
  if (!(counted > 0)) return;
  f.rms_px = std::sqrt(squares / counted), f.sigma_px = std::sqrt(variance / counted);
  f.explained = explained / counted, f.met = met / counted;
}

}  // namespace

void measure_rims(Fitted& fitted, const Question& question) {
  find_figures(fitted, question, seen_points(question), stages_from(0).back().reach_px);
}

Fitted fit_rims(const Setting& start, const Question& question, const std::vector<Stage>& stages, FitPath* path) {
  const std::vector<SeenPoints> seen = seen_points(question);
  Descent down = go_down(start, question, stages, seen, path);
  Fitted f;
  f.setting = std::move(down.setting), f.descended = down.last, f.cost = down.last.cost;
  const Stage last = stages.back();
  find_figures(f, question, seen, last.reach_px);
  for (std::size_t i = 0; i < f.sightings.size(); ++i)
    down.sigma[i] = f.sightings[i].sigma_px, f.sightings[i].share = down.shares[i];
  if (!question.freedoms.empty()) {
    const Rims rims(question, f.setting, last, down.sigma, seen, down.shares);
    find_covariance(f, question, rims.sum(f.setting, true).h, rims.of_points(f.setting));
  }
  return f;
}

struct RimCost::Known {
  explicit Known(const Question& q) : question(q), seen(seen_points(q)), ones(q.sightings.size(), 1.0) {}
  const Question& question;
  std::vector<SeenPoints> seen;
  std::vector<double> ones;
};

RimCost::RimCost(const Question& question) : known_(std::make_unique<const Known>(question)) {}
RimCost::~RimCost() = default;

double RimCost::of(const Setting& setting, const Stage& stage) const {
  return Rims(known_->question, setting, stage, known_->ones, known_->seen, known_->ones).cost_at(setting);
}

}  // namespace gonio::alignment
