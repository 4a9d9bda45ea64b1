// The least robust error over similarities: starts, both handednesses (errors.h, robust_fit.h). Coordinates are centred
// and divided by their rms extents before, so that tolerances mean the same in every unit.
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "nrsfm/errors.h"
#include "nrsfm/robust_fit.h"

namespace gonio::nrsfm {
namespace {

constexpr double small_error =
    0.2;                           // over the truth's rms extent: below, the Procrustes start lies in the right valley
constexpr Eigen::Index parts = 8;  // of the sequence, whose own Procrustes are further starts
constexpr std::size_t tried = 4;   // of those starts, the best
constexpr double hopeless = 4;     // times the other hand's cost

struct Normalized {
  Matched points;
  Eigen::Vector3d centre_x, centre_q;
  double extent_x = 1, extent_q = 1;
};

Normalized normalized(const Shapes& x, const Shapes& truth) {
  check_comparable(x, truth);
  Normalized n{matched(x, truth), {}, {}, 1, 1};
  const auto centre = [](Eigen::Matrix3Xd& points, Eigen::Vector3d& mean, double& extent, const char* what) {
    mean = points.rowwise().mean();
    points.colwise() -= mean;
    extent = std::sqrt(points.squaredNorm() / static_cast<double>(points.cols()));
    if (!(extent > 1e-300)) throw Error(Exit::data, what, "has all its points in one place");
    points /= extent;
  };
  centre(n.points.x, n.centre_x, n.extent_x, "reconstruction");
  centre(n.points.q, n.centre_q, n.extent_q, "truth");
  return n;
}

Similarity restored(const Similarity& s, const Normalized& n) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(s.rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Similarity out;
  out.rotation = svd.matrixU() * svd.matrixV().transpose();
  out.scale = s.scale * n.extent_q / n.extent_x;
  out.translation = n.extent_q * s.translation + n.centre_q - out.scale * out.rotation * n.centre_x;
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

// Starts from parts of the sequence: a reconstruction that holds together there may be torn elsewhere.
std::vector<Similarity> starts_of_parts(const Matched& m, bool mirrored) {
  std::vector<Similarity> starts;
  const Eigen::Index n = m.x.cols();
  for (Eigen::Index k = 0; k < parts; ++k) {
    const Eigen::Index first = k * n / parts, count = (k + 1) * n / parts - first;
    if (count >= 4) starts.push_back(start_of(m.x.middleCols(first, count), m.q.middleCols(first, count), mirrored));
  }
  return starts;
}

class Search {
 public:
  Search(const Normalized& n, const RobustOptions& options)
      : n_(n), options_(options), fit_(n.points.x, n.points.q, options.mean) {}

  void run() {
    const std::array<Similarity, 2> first = {start_of(n_.points.x, n_.points.q, false),
                                             start_of(n_.points.x, n_.points.q, true)};
    std::size_t hand = 0;
    if (options_.reflection && fit_.evaluate(first[1]).cost < fit_.evaluate(first[0]).cost) hand = 1;
    keep(first[hand], 0);
    if (options_.reflection) keep(first[1 - hand], hopeless * best().state.cost);
    const double extent = options_.mean == RobustMean::printed ? best().state.cost : std::sqrt(best().state.cost);
    if (extent > small_error) search_parts();
  }
  const RobustFit::Outcome& best() const {
    return other() && other()->state.cost < one().state.cost ? *other() : one();
  }
  const std::optional<RobustFit::Outcome>& of(bool mirrored) const { return best_[mirrored ? 1 : 0]; }
  int iterations = 0, starts = 0;

 private:
  const RobustFit::Outcome& one() const { return best_[0] ? *best_[0] : *best_[1]; }
  const std::optional<RobustFit::Outcome>& other() const { return best_[1]; }

  void keep(const Similarity& start, double limit) {
    const RobustFit::Outcome outcome = fit_.minimize(start, options_.most_iterations, limit);
    iterations += outcome.iterations;
    ++starts;
    auto& kept = best_[outcome.state.at.mirrored() ? 1 : 0];
    if (!kept || outcome.state.cost < kept->state.cost) kept = outcome;
  }

  void search_parts() {
    std::vector<RobustFit::State> candidates;
    for (const bool mirrored : {false, true}) {
      if (mirrored && !options_.reflection) continue;
      for (const Similarity& start : starts_of_parts(n_.points, mirrored)) candidates.push_back(fit_.evaluate(start));
    }
    std::ranges::stable_sort(candidates, {}, &RobustFit::State::cost);
    for (std::size_t k = 0; k < std::min(tried, candidates.size()); ++k) keep(candidates[k].at, 0);
  }

  const Normalized& n_;
  RobustOptions options_;
  RobustFit fit_;
  std::array<std::optional<RobustFit::Outcome>, 2> best_;  // rotation, reflection
};

double value_of(double cost, double extent, RobustMean mean) {
  return mean == RobustMean::printed ? std::sqrt(extent * cost) : extent * std::sqrt(cost);
}

double estimated_share(const Shapes& truth, Eigen::Index both) {
  Eigen::Index known = 0;
  for (Eigen::Index f = 0; f < truth.rows() / 3; ++f)
    for (Eigen::Index p = 0; p < truth.cols(); ++p) known += shape_of(truth, f).col(p).allFinite() ? 1 : 0;
  return static_cast<double>(both) / static_cast<double>(known);
}

}  // namespace

RobustError robust_error(const Shapes& x, const Shapes& truth, const RobustOptions& options) {
  const Normalized n = normalized(x, truth);
  Search search(n, options);
  search.run();
  const RobustFit::Outcome& best = search.best();
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
