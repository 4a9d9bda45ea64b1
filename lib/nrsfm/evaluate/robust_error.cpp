// The least robust error over similarities: starts, both handednesses (errors.h, robust_fit.h). Coordinates are centred
// and divided by their extents (medians, which outliers do not move) before, so that tolerances mean the same in every
// unit; the truth is turned to its principal axes, x onto the truth by Procrustes, and points are sorted by their
// place, so that the search takes the same way however they stood and in whatever order they came.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/error.h"
#include "base/random.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/evaluate/errors.h"
#include "nrsfm/solve/robust_fit.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

constexpr double small_error = 0.25;    // over the truth's extent: below, the Procrustes start lies in the right valley
constexpr Eigen::Index parts = 8;       // of the sequence, whose own Procrustes are further starts
constexpr double rival = 1.5;           // times the best cost: the other handedness is followed to its end, too
constexpr Eigen::Index searched = 800;  // points among which valleys are looked for; all of them decide
constexpr Eigen::Index polishable = 3000;
constexpr int brief = 400;                                // evaluations
constexpr double search_work = 1.6e4, polish_work = 2e6;  // points times starts; points times evaluations

struct Normalized {
  Matched points;  // in the order of the sequence
  Eigen::Vector3d centre_x, centre_q;
  double extent_x = 1, extent_q = 1;
  Eigen::Matrix3d turn_x, turn_q;  // before the search
};

double median_of(const Eigen::VectorXd& v) {
  return stats::median({v.data(), static_cast<std::size_t>(v.size())});
}

// Rows: directions of least to largest spread, each towards the side of the longer tail; right-handed.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3Xd& q) {
  const Eigen::Matrix3Xd centred = q.colwise() - q.rowwise().mean();
  const linear::SymmetricEigen<Eigen::Matrix3d> solver(centred * centred.transpose());
  Eigen::Matrix3d rows = solver.eigenvectors().transpose();
  for (int i = 1; i < 3; ++i)
    if ((rows.row(i) * centred).array().cube().sum() < 0) rows.row(i) *= -1;
  rows.row(0) = rows.row(1).cross(rows.row(2));
  return rows;
}

Normalized normalized(const Shapes& x, const Shapes& truth, bool reflection) {
  check_comparable(x, truth);
  Normalized n{matched(x, truth), {}, {}, 1, 1, {}, {}};
  n.turn_q = principal_axes(n.points.q);
  n.points.q = n.turn_q * n.points.q;
  n.turn_x = procrustes(n.points.x, n.points.q, {.scale = false, .reflection = reflection}).rotation;
  n.points.x = n.turn_x * n.points.x;
  const auto centre = [](Eigen::Matrix3Xd& points, Eigen::Vector3d& middle, double& extent, const char* what) {
    for (int i = 0; i < 3; ++i) middle(i) = median_of(points.row(i).transpose());
    points.colwise() -= middle;
    extent = median_of(points.colwise().norm().transpose());
    if (!(extent > 0)) extent = points.norm() / std::sqrt(static_cast<double>(points.cols()));
    if (!(extent > 1e-300)) throw Error(Exit::data, what, "has all its points in one place");
    points /= extent;
  };
  centre(n.points.x, n.centre_x, n.extent_x, "reconstruction");
  centre(n.points.q, n.centre_q, n.extent_q, "truth");
  return n;
}

Similarity restored(const Similarity& s, const Normalized& n) {
  const linear::JacobiSvd<Eigen::Matrix3d> svd(n.turn_q.transpose() * s.rotation * n.turn_x,
                                               Eigen::ComputeFullU | Eigen::ComputeFullV);
  Similarity out;
  out.rotation = svd.matrixU() * svd.matrixV().transpose();
  out.scale = s.scale * n.extent_q / n.extent_x;
  const Eigen::Vector3d turned = n.extent_q * s.translation + n.centre_q - out.scale * (s.rotation * n.centre_x);
  out.translation = n.turn_q.transpose() * turned;
  return out;
}

// Procrustes of one handedness; a scale of 0 would be a place from which no rotation can be told.
Similarity start_of(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& q, bool mirrored) {
  Similarity s =
      procrustes(mirrored ? Eigen::Matrix3Xd(-x) : x, q, {.scale = true, .reflection = false, .translation = true});
  if (mirrored) s.rotation = -s.rotation;
  s.scale = std::max(s.scale, 0.05);
  return s;
}

// To 2^-24 of the extent: what rounding has made of the same shapes elsewhere becomes the same numbers. Sorted by the
// truth's places.
Matched canonical(const Matched& m) {
  const auto rounded = [](const Eigen::Matrix3Xd& v) {
    constexpr double lift = 1.5 * (1 << 28);  // 2^52 times the step: the sum has no digits below it
    return Eigen::Matrix3Xd((v.array() + lift) - lift);
  };
  const Matched r{rounded(m.x), rounded(m.q), {}};
  std::vector<std::pair<double, Eigen::Index>> places;
  for (Eigen::Index i = 0; i < r.q.cols(); ++i) places.emplace_back(r.q(2, i), i);
  const auto rest = [&r](Eigen::Index i) { return std::tuple(r.q(1, i), r.q(0, i), r.x(2, i), r.x(1, i), r.x(0, i)); };
  std::ranges::sort(places, [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : rest(a.second) < rest(b.second);
  });
  std::vector<Eigen::Index> order;
  for (const auto& [place, i] : places) order.push_back(i);
  return {r.x(Eigen::all, order), r.q(Eigen::all, order), {}};
}

// As many as `work` affords.
int affordable(double work, Eigen::Index points, int least, int most) {
  const double count = work / static_cast<double>(points);
  return static_cast<int>(std::clamp(count, static_cast<double>(least), static_cast<double>(most)));
}

// Every so many points, so that about `searched` stay.
Matched thinned(const Matched& m) {
  const Eigen::Index n = m.x.cols(), step = std::max<Eigen::Index>(1, n / searched);
  Matched out{Eigen::Matrix3Xd(3, n / step), Eigen::Matrix3Xd(3, n / step), {}};
  for (Eigen::Index i = 0; i < n / step; ++i) {
    const Eigen::Index from = i * step + i % step;
    out.x.col(i) = m.x.col(from), out.q.col(i) = m.q.col(from);
  }
  return out;
}

class Search {
 public:
  // `sequence`: all points in the sequence's order, for starts from its parts.
  Search(const Matched& points, const Matched& sequence, const RobustOptions& options)
      : points_(points), sequence_(sequence), options_(options), fit_(points.x, points.q, options.mean) {}

  // From Procrustes of all points with either handedness; where the error is large, from others.
  void look() {
    for (const bool mirrored : {false, true}) {
      if (mirrored && !options_.reflection) continue;
      Similarity start = start_of(points_.x, points_.q, mirrored);
      follow(start);
      start.scale = 1;  // outliers make Procrustes' scale small
      follow(start);
    }
    const double cost = best().state.cost, extent = options_.mean == RobustMean::printed ? cost : std::sqrt(cost);
    const bool poor = extent > small_error;
    const int count =
        affordable(poor ? search_work : search_work / 4, points_.x.cols(), poor ? 20 : 2, poor ? 160 : 32);
    if (poor)
      for (const Similarity& start : starts_of_parts()) follow(start);
    Random random(1, 2018);
    for (int k = starts; k < count; ++k) follow(poor && k % 2 == 0 ? anywhere(random) : nearby(random));
  }
  void follow(const Similarity& start) {
    const RobustFit::Outcome outcome = fit_.minimize(start, options_.most_iterations);
    iterations += outcome.iterations;
    ++starts;
    ends_.push_back(outcome.state);
    enter(outcome);
  }
  void enter(const RobustFit::Outcome& outcome) {
    auto& kept = best_[outcome.state.at.mirrored() ? 1 : 0];
    if (!kept || outcome.state.cost < kept->state.cost) kept = outcome;
  }
  // The lowest places that were found, briefly; then what is best of either handedness.
  void polish() {
    if (points_.x.cols() > polishable) return;
    const int evaluations = affordable(polish_work, points_.x.cols(), 0, 40000);
    std::ranges::stable_sort(ends_, {}, &RobustFit::State::cost);
    const std::size_t count = std::min<std::size_t>(ends_.size(), static_cast<std::size_t>(evaluations / (2 * brief)));
    for (std::size_t k = 0; k < count; ++k) enter({fit_.polished(ends_[k], brief), 0, true});
    for (auto& kept : best_)
      if (kept && kept->state.cost <= best().state.cost * rival)
        kept->state = fit_.polished(kept->state, evaluations / 4);
  }
  // From what another search has found: its best, and the other handedness where that is a rival.
  void follow(const Search& coarse) {
    for (const auto& found : coarse.best_) {
      if (!found) continue;
      if (found->state.cost <= rival * coarse.best().state.cost)
        follow(found->state.at);
      else
        enter({fit_.evaluate(found->state.at), 0, true});
    }
    iterations += coarse.iterations, starts = coarse.starts;
  }
  const RobustFit::Outcome& best() const {
    return best_[0] && (!best_[1] || best_[0]->state.cost <= best_[1]->state.cost) ? *best_[0] : *best_[1];
  }
  const std::optional<RobustFit::Outcome>& of(bool mirrored) const { return best_[mirrored ? 1 : 0]; }
  int iterations = 0, starts = 0;

 private:
  // Parts of the sequence: a reconstruction that holds together there may be torn elsewhere.
  std::vector<Similarity> starts_of_parts() const {
    std::vector<Similarity> out;
    const auto& frame = sequence_.frame;
    const auto begin_of = [&](Eigen::Index k) {
      return std::ranges::lower_bound(frame, k * (frame.back() + 1) / parts) - frame.begin();
    };
    for (Eigen::Index k = 0; k < parts; ++k) {
      const Eigen::Index first = begin_of(k), count = begin_of(k + 1) - first;
      if (count < 4) continue;
      const Matched part = canonical({sequence_.x.middleCols(first, count), sequence_.q.middleCols(first, count), {}});
      for (const bool mirrored : {false, true})
        if (!mirrored || options_.reflection) out.push_back(start_of(part.x, part.q, mirrored));
    }
    return out;
  }
  // Tenths of a radian and of the extent away from what is best so far, of either handedness where they are rivals.
  Similarity nearby(Random& random) const {
    Step p;
    for (int i = 0; i < 7; ++i) p(i) = (i > 3 ? 0.2 : 0.4) * random.normal();
    const auto& other = of(!best().state.at.mirrored());
    const bool turn = random.uniform() < 0.5 && other && other->state.cost <= rival * best().state.cost;
    return stepped(turn ? other->state.at : best().state.at, p);
  }
  Similarity anywhere(Random& random) const {
    Eigen::Vector4d q;
    for (int i = 0; i < 4; ++i) q(i) = random.normal();
    const double hand = options_.reflection && random.uniform() < 0.5 ? -1 : 1;
    return {std::exp(0.4 * random.normal()), hand * Eigen::Quaterniond(q.normalized()).toRotationMatrix(),
            Eigen::Vector3d::Zero()};
  }

  const Matched &points_, &sequence_;
  RobustOptions options_;
  RobustFit fit_;
  std::array<std::optional<RobustFit::Outcome>, 2> best_;  // rotation, reflection
  std::vector<RobustFit::State> ends_;                     // of every start
};

double value_of(double cost, double extent, RobustMean mean) {
  return mean == RobustMean::printed ? std::sqrt(extent * cost) : extent * std::sqrt(cost);
}

double estimated_share(const Shapes& truth, Eigen::Index both) {
  Eigen::Index known = 0;
  for (Eigen::Index f = 0; f < truth.rows() / 3; ++f)
    for (Eigen::Index p = 0; p < truth.cols(); ++p) known += is_finite(shape_of(truth, f).col(p)) ? 1 : 0;
  return static_cast<double>(both) / static_cast<double>(known);
}

// Of the points as they are, not rounded; where rounding is not small beside the error, at its own minimum.
RobustFit::Outcome exact(const RobustFit::Outcome& found, const Matched& points, const RobustOptions& options) {
  constexpr double well_above = 1e-4;  // of the extent
  RobustFit fit(points.x, points.q, options.mean);
  RobustFit::Outcome out = found;
  out.state = fit.evaluate(found.state.at);
  if (value_of(out.state.cost, 1, RobustMean::root_mean_square) > well_above) return out;
  const RobustFit::Outcome own = fit.minimize(found.state.at, options.most_iterations);
  return own.state.cost < out.state.cost ? own : out;
}

}  // namespace

RobustError robust_error(const Shapes& x, const Shapes& truth, const RobustOptions& options) {
  const Normalized n = normalized(x, truth, options.reflection);
  const Matched points = canonical(n.points);
  const bool thin = points.x.cols() >= 2 * searched;
  const Matched few = thin ? thinned(points) : Matched{};
  Search search(points, n.points, options);
  if (thin) {
    Search coarse(few, n.points, options);
    coarse.look();
    search.follow(coarse);
  } else {
    search.look();
  }
  search.polish();
  const RobustFit::Outcome best = exact(search.best(), n.points, options);
  const bool mirrored = best.state.at.mirrored();
  RobustError out;
  out.value = value_of(best.state.cost, n.extent_q, options.mean);
  out.whisker = n.extent_q * best.state.whisker;
  out.truncated = static_cast<double>(best.state.beyond) / static_cast<double>(n.points.x.cols());
  out.estimated = estimated_share(truth, n.points.x.cols());
  out.alignment = restored(best.state.at, n);
  out.other_hand = std::numeric_limits<double>::quiet_NaN();
  if (const auto& other = search.of(!mirrored)) {
    out.other_hand = value_of(other->state.cost, n.extent_q, options.mean);
    out.other = restored(other->state.at, n);
  }
  out.iterations = search.iterations;
  out.starts = search.starts;
  out.converged = best.converged;
  return out;
}

double robust_measure(const Shapes& x, const Shapes& truth, RobustMean mean) {
  check_comparable(x, truth);
  const Matched m = matched(x, truth);
  RobustFit fit(m.x, m.q, mean);
  return std::sqrt(fit.evaluate(Similarity{}).cost);
}

}  // namespace gonio::nrsfm
