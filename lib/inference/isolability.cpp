// Isolability, judged before any residual is looked at: what of a mechanism's signature survives the free parameters,
// which amplitude could be seen, and which mechanisms look alike in these very recordings.
#include <algorithm>
#include <cmath>

#include "inference/scaling.h"
#include "inference/signature.h"
#include "linear/blocks.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr double alike = 0.9;         // |cos| beyond which two signatures cannot be told apart
constexpr double least_share = 1e-6;  // of a column's squared length that the free parameters leave
constexpr double invisible_share = 1e-3;

// G^-1/2 on the range of G.
Eigen::MatrixXd inverse_root(const Eigen::MatrixXd& gram) {
  const Eigen::VectorXd scale = unit_scale(gram.diagonal());
  const linear::EigenPairs eigen = linear::eigen_of(scale.asDiagonal() * gram * scale.asDiagonal());
  const Eigen::VectorXd root = eigen.values.unaryExpr([](double v) { return v > 1e-9 ? 1 / std::sqrt(v) : 0.0; });
  return scale.asDiagonal() * eigen.vectors * root.asDiagonal();
}

// Noncentrality of a chi-square with so many degrees which its test at `level` finds with 80 % power: mean degrees + l,
// variance 2 (degrees + 2 l), taken as normal; exact for one degree.
double noncentrality(double degrees, double level) {
  const double power = 0.8;
  if (degrees <= 1) return std::pow(stats::detectable_z(level, power), 2);
  const double threshold = stats::chi2_quantile(1 - level, degrees), z = stats::normal_quantile(power);
  double lower = 0, upper = 10 * threshold + 100;
  for (int i = 0; i < 60; ++i) {
    const double l = 0.5 * (lower + upper);
    (degrees + l - z * std::sqrt(2 * (degrees + 2 * l)) < threshold ? lower : upper) = l;
  }
  return upper;
}

// Squared amplitude of a column at which its effect is what matters.
double mattering(const System& system, const Projection& p, const BlockScores& scores, Eigen::Index column,
                 double smallest_effect) {
  if (system.problem().importance() == Importance::share_of_signal) {
    const double raw = scores.raw_surviving(column, column);
    return raw > 0 ? smallest_effect * smallest_effect * scores.norm / raw : 0;
  }
  // The score falls by the share m where the effect adds (1 - m)^-2 - 1 of the noise's mean square.
  const double length = p.surviving(column, column);
  return length > 0 ? (1 / ((1 - smallest_effect) * (1 - smallest_effect)) - 1) * p.rows / length : 0;
}

// Diagonal of G^-1: the largest squared component of an effect of unit length, whatever the other components are.
// Infinite where a direction has no length.
Eigen::VectorXd largest_components(const Eigen::MatrixXd& gram, const Eigen::VectorXd& full) {
  const Eigen::VectorXd scale = unit_scale(full);
  const linear::EigenPairs eigen = linear::eigen_of(scale.asDiagonal() * gram * scale.asDiagonal());
  Eigen::VectorXd result = Eigen::VectorXd::Zero(gram.rows());
  for (Eigen::Index k = 0; k < gram.rows(); ++k)
    for (Eigen::Index d = 0; d < gram.rows(); ++d) {
      const double part = std::pow(scale[k] * eigen.vectors(k, d), 2), length = eigen.values[d];
      if (length > least_share)
        result[k] += part / length;
      else if (part > 1e-9 * scale[k] * scale[k])
        result[k] = std::numeric_limits<double>::infinity();
    }
  return result;
}

// Limits of numbers that are not alone: by noise and by what matters, as for a single one.
std::vector<double> limits_with_others(const System& system, const Projection& p, const BlockScores& scores,
                                       const std::vector<Eigen::Index>& own, double white, double smallest_effect) {
  const Eigen::VectorXd full = p.full.diagonal()(own);
  const Eigen::VectorXd seen = largest_components(p.surviving(own, own), full);
  const bool of_signal = system.problem().importance() == Importance::share_of_signal;
  const Eigen::VectorXd raw =
      of_signal ? largest_components(scores.raw_surviving(own, own), scores.raw_surviving.diagonal()(own)) : seen;
  const double least = of_signal ? smallest_effect * smallest_effect * scores.norm
                                 : (1 / ((1 - smallest_effect) * (1 - smallest_effect)) - 1) * p.rows;
  std::vector<double> limits;
  for (Eigen::Index k = 0; k < seen.size(); ++k) limits.push_back(std::sqrt(std::max(white * seen[k], least * raw[k])));
  return limits;
}

}  // namespace

Subspace::Subspace(const Projection& p, std::vector<Eigen::Index> own)
    : columns(std::move(own)), root(inverse_root(p.surviving(columns, columns))) {}

double look_alike(const Projection& p, const Subspace& a, const Subspace& b) {
  const Eigen::MatrixXd c = a.root.transpose() * p.surviving(a.columns, b.columns) * b.root;
  const double rank = static_cast<double>(std::min(a.columns.size(), b.columns.size()));
  return std::min(1.0, std::sqrt(c.squaredNorm() / rank));
}

std::vector<double> inflation(const System& system, const Projection& p, const Structures& structures,
                              const BlockScores& scores) {
  std::vector<double> result(system.problem().candidates().size(), 0.0);
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    if (structures.list[s].kind != Structure::Kind::mechanism) continue;
    double largest = 1;
    for (const Eigen::Index c : p.foreign(structures, s))
      if (p.surviving(c, c) > least_share * p.full(c, c))
        largest = std::max(largest, scores.variance[c] / p.surviving(c, c));
    result[structures.list[s].index] = largest;
  }
  return result;
}

namespace {

// Among those that are visible, each pair once.
void find_look_alikes(const Projection& p, const std::vector<std::vector<Eigen::Index>>& places,
                      std::vector<Isolability>& result) {
  std::vector<std::size_t> visible;
  std::vector<Subspace> subspaces;
  for (std::size_t k = 0; k < result.size(); ++k)
    if (result[k].visible) {
      visible.push_back(k);
      subspaces.emplace_back(p, places[k]);
    }
  for (std::size_t b = 0; b < visible.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      const double c = look_alike(p, subspaces[a], subspaces[b]);
      if (!(c > alike)) continue;
      result[visible[a]].look_alikes.emplace_back(result[visible[b]].candidate, c);
      result[visible[b]].look_alikes.emplace_back(result[visible[a]].candidate, c);
    }
}

}  // namespace

std::vector<Isolability> isolability(const System& system, const Projection& p, const Structures& structures,
                                     const BlockScores& scores, const std::vector<double>& inflation,
                                     const Options& options) {
  std::vector<Isolability> result;
  std::vector<std::vector<Eigen::Index>> places;
  const auto looks = std::count_if(structures.list.begin(), structures.list.end(), [](const Structure& s) {
    return s.kind == Structure::Kind::mechanism || s.kind == Structure::Kind::curve;
  });
  const double level =
      -std::expm1(std::log1p(-options.level) / static_cast<double>(std::max<std::ptrdiff_t>(1, looks)));
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    if (structures.list[s].kind != Structure::Kind::mechanism) continue;
    Isolability entry;
    entry.candidate = structures.list[s].index;
    places.push_back(p.foreign(structures, s));
    const std::vector<Eigen::Index>& own = places.back();
    const Eigen::MatrixXd root = inverse_root(p.full(own, own));
    const linear::EigenPairs shares = linear::eigen_of(root.transpose() * p.surviving(own, own) * root);
    entry.surviving_share = std::sqrt(std::clamp(shares.largest(), 0.0, 1.0));
    entry.visible = false;
    const Candidate& candidate = system.problem().candidates()[entry.candidate];
    const double white = noncentrality(static_cast<double>(own.size()), level);
    const double inflated = std::max(1.0, inflation[entry.candidate]);
    for (std::size_t k = 0; k < own.size(); ++k) {
      const double length = p.surviving(own[k], own[k]);
      const Parameter& parameter = system.problem().parameters()[candidate.parameters[k]];
      const double by_noise =
          length > least_share * p.full(own[k], own[k]) ? white / length : std::numeric_limits<double>::infinity();
      const double least = mattering(system, p, scores, own[k], options.smallest_effect);
      entry.detection_limit.push_back(std::sqrt(std::max(by_noise * inflated, least)));
      const double reach = std::max(parameter.upper - parameter.neutral, parameter.neutral - parameter.lower);
      // Whether it could be seen is asked of the noise alone: an effect that is there, and strong, is itself what
      // correlates the residuals of a block, and must not hide itself.
      if (std::sqrt(std::max(by_noise, least)) < reach && entry.surviving_share > invisible_share) entry.visible = true;
    }
    entry.limit_with_others =
        own.size() > 1 ? limits_with_others(system, p, scores, own, white * inflated, options.smallest_effect)
                       : entry.detection_limit;
    result.push_back(std::move(entry));
  }
  find_look_alikes(p, places, result);
  return result;
}

}  // namespace gonio::inference
