// See outliers.h.
#include "nrsfm/solve/outliers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "nrsfm/solve/robust_tracks.h"

namespace gonio::nrsfm {
namespace {

constexpr int most_rounds = 8;        // until what lies outside stays the same
constexpr Eigen::Index most_gap = 3;  // frames between which a step is one
constexpr double abrupt_share = 0.7;  // of a run's offset: what its ends step by at least

using Flags = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

// Squared residuals freed of leverage: of what took part in the fit it is too small, of what did not too large.
Eigen::ArrayXXd squares_of(const RobustTracks& fit) {
  const SolvedModel& m = fit.model();
  Eigen::ArrayXXd d =
      Eigen::ArrayXXd::Constant(m.frame_count(), m.point_count(), std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index f = 0; f < d.rows(); ++f)
    for (Eigen::Index p = 0; p < d.cols(); ++p) {
      if (!fit.seen(f, p)) continue;
      const double h = fit.leverage(f, p), w = fit.weight(f, p);
      d(f, p) = fit.residual(f, p).squaredNorm() / (w > 0 ? 1 - w * h : 1 + h);
    }
  return d;
}

// Of a coordinate, from a quantile of squared distances, which are exponential where noise is normal.
double variance_of(std::vector<double> squares, double share = 0.5) {
  if (squares.empty()) return 0;
  const auto place = squares.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(squares.size()));
  std::nth_element(squares.begin(), place, squares.end());
  return *place / (-2 * std::log1p(-share));
}

template <class Values>
std::vector<double> finite(const Values& values) {
  std::vector<double> result;
  for (Eigen::Index i = 0; i < values.size(); ++i)
    if (std::isfinite(values(i))) result.push_back(values(i));
  return result;
}

// D of every observation; NaN where not seen.
Eigen::ArrayXXd distances_of(const RobustTracks& fit) {
  Eigen::ArrayXXd d = squares_of(fit);
  const double all = variance_of(finite(d.reshaped()));
  Eigen::ArrayXd of_point(d.cols()), of_frame(d.rows());
  for (Eigen::Index p = 0; p < d.cols(); ++p) of_point(p) = variance_of(finite(d.col(p)), 0.25);
  for (Eigen::Index f = 0; f < d.rows(); ++f) of_frame(f) = variance_of(finite(d.row(f)));
  for (Eigen::Index f = 0; f < d.rows(); ++f)
    for (Eigen::Index p = 0; p < d.cols(); ++p)
      d(f, p) /= std::max({all, of_point(p), of_frame(f), std::numeric_limits<double>::min()});
  return d;
}

// The frame that sees the point before or after, if it is not far; -1 otherwise.
Eigen::Index seen_before(const RobustTracks& fit, Eigen::Index f, Eigen::Index p) {
  for (Eigen::Index g = f - 1; g >= std::max<Eigen::Index>(0, f - most_gap); --g)
    if (fit.seen(g, p)) return g;
  return -1;
}
Eigen::Index seen_after(const RobustTracks& fit, Eigen::Index f, Eigen::Index p) {
  for (Eigen::Index g = f + 1; g < std::min(fit.model().frame_count(), f + 1 + most_gap); ++g)
    if (fit.seen(g, p)) return g;
  return -1;
}

// Residual's step between two frames, both of which see the point.
double step_of(const RobustTracks& fit, Eigen::Index f, Eigen::Index g, Eigen::Index p) {
  return (fit.residual(f, p) - fit.residual(g, p)).norm();
}

// Runs that are as abrupt as slips: at every end that is seen, the step is most of what the run lies off by. What the
// model lacks comes and goes.
Flags abrupt(const RobustTracks& fit, const Flags& outside) {
  Flags kept = Flags::Constant(outside.rows(), outside.cols(), false);
  for (Eigen::Index p = 0; p < outside.cols(); ++p)
    for (Eigen::Index f = 0; f < outside.rows(); ++f) {
      if (!outside(f, p)) continue;
      const Eigen::Index first = f;
      double squares = 0;
      for (; f < outside.rows() && outside(f, p); ++f) squares += fit.residual(f, p).squaredNorm();
      const double least = abrupt_share * std::sqrt(squares / static_cast<double>(f - first));
      const Eigen::Index before = seen_before(fit, first, p), after = seen_after(fit, f - 1, p);
      const bool begins = before >= 0 && step_of(fit, first, before, p) < least;
      const bool ends = after >= 0 && step_of(fit, f - 1, after, p) < least;
      kept.col(p).segment(first, f - first) = (before >= 0 || after >= 0) && !begins && !ends;
    }
  return kept;
}

// Chance of so large a D, or a larger one.
double tail(double d, double freedom) {
  return std::exp(-0.5 * freedom * std::log1p(d / freedom));
}

void gather_runs(const RobustTracks& fit, const Flags& outside, double sigma, Outliers& result) {
  const SolvedModel& m = fit.model();
  double squares = 0;
  for (Eigen::Index p = 0; p < outside.cols(); ++p)
    for (Eigen::Index f = 0; f < outside.rows(); ++f) {
      if (!outside(f, p)) continue;
      Run run;
      run.point = static_cast<std::size_t>(m.points[static_cast<std::size_t>(p)]);
      run.first = static_cast<std::size_t>(m.frames[static_cast<std::size_t>(f)]);
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      double count = 0, variance = 0;
      for (; f < outside.rows() && outside(f, p); ++f, ++count) {
        const Eigen::Vector2d r = fit.residual(f, p);
        sum += r;
        variance += sigma * sigma * (1 + fit.leverage(f, p));
        squares += r.squaredNorm();
        run.last = static_cast<std::size_t>(m.frames[static_cast<std::size_t>(f)]);
      }
      run.offset = {sum.x() / count, sum.y() / count};
      run.sigma = std::sqrt(variance) / count;
      result.runs.push_back(run);
      result.found += static_cast<std::size_t>(count);
    }
  result.rms_offset = result.found == 0 ? 0 : std::sqrt(squares / static_cast<double>(result.found));
}

// Root mean square distance of sound observations on one half of the frames from where the other half puts the point.
double held_out(const RobustTracks& fit, const Flags& outside, bool with) {
  double squares = 0, count = 0;
  for (Eigen::Index p = 0; p < outside.cols(); ++p)
    for (const int half : {0, 1}) {
      Eigen::ArrayXd weights = Eigen::ArrayXd::Zero(outside.rows());
      const auto in_half = [&](Eigen::Index f) {
        return static_cast<int>(split_mix(static_cast<std::uint64_t>(outside.rows() * p + f)) & 1) == half;
      };
      for (Eigen::Index f = 0; f < outside.rows(); ++f)
        weights(f) = fit.seen(f, p) && in_half(f) && (with || !outside(f, p)) ? 1 : 0;
      if (2 * weights.sum() < 1.5 * 3 * double(fit.model().terms())) continue;
      const Eigen::VectorXd shape = fit.shape(p, weights);
      for (Eigen::Index f = 0; f < outside.rows(); ++f) {
        if (!fit.seen(f, p) || in_half(f) || outside(f, p)) continue;
        squares += (fit.track(f, p) - fit.predicted(f, shape)).squaredNorm();
        ++count;
      }
    }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

Outliers find_outliers(const Solved& solved, double false_alarm) {
  RobustTracks fit(solved);
  Eigen::ArrayXXd d = distances_of(fit);
  const double n = static_cast<double>(finite(d.reshaped()).size()), freedom = fit.freedom();
  const double limit = freedom * std::expm1(-2 / freedom * std::log(false_alarm / std::max(1.0, n)));
  Flags outside = d > limit;  // NaN is not
  for (int round = 0; round < most_rounds; ++round) {
    fit.refit(outside);
    d = distances_of(fit);
    const Flags now = d > limit;
    if ((now == outside).all()) break;
    outside = now;
  }
  if (const Flags jumping = abrupt(fit, outside); (jumping != outside).any()) {
    outside = jumping;
    fit.refit(outside);
    d = distances_of(fit);
  }
  Outliers result;
  result.observations = static_cast<std::size_t>(n);
  for (const double one : finite(d.reshaped())) result.p = std::min(result.p, n * tail(one, freedom));
  const double sigma = std::sqrt(variance_of(finite(squares_of(fit).reshaped())));
  gather_runs(fit, outside, sigma, result);
  result.components = fit.components();
  result.noise = noise_of(solved, fit, sigma);
  if (result.found == 0) return result;
  result.held_out_with = held_out(fit, outside, true);
  result.held_out_without = held_out(fit, outside, false);
  return result;
}

Sequence without(const Sequence& sequence, const std::vector<Run>& runs) {
  Sequence s = sequence;
  for (const Run& run : runs)
    for (std::size_t frame = run.first; frame <= run.last; ++frame) {
      const auto f = static_cast<Eigen::Index>(frame), p = static_cast<Eigen::Index>(run.point);
      if (!s.visible(f, p)) continue;
      s.visible(f, p) = false;
      s.tracks.block<2, 1>(2 * f, p).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  return s;
}

}  // namespace gonio::nrsfm
