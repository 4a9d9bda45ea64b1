// See rim_covariance.h.
#include "alignment/rim_covariance.h"

#include <algorithm>
#include <cmath>

#include "alignment/rim_components.h"
#include "alignment/seen_points.h"
#include "linear/solve.h"

namespace gonio::alignment {
namespace {

using Eigen::Index;

// Length of rim, px, whose errors are one error: the sum of the autocorrelation over lags of either sign, from products
// of weighted offsets of one loop, until it drowns in noise.
double correlation_length(const std::vector<const Sighting*>& sightings, const std::vector<const SightingFit*>& fits,
                          double numbers) {
  constexpr int most = 60;
  std::vector<double> sums(most + 1, 0), counts(most + 1, 0);
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const auto& points = sightings[k]->points;
    const SightingFit& fit = *fits[k];
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(fit.weight[i] > 0)) continue;
      const double a = fit.weight[i] * fit.offset_px[i] / fit.sigma_px;
      for (std::size_t j = i; j < points.size() && points[j].loop == points[i].loop; ++j) {
        const int lag = static_cast<int>(std::lround(points[j].arc_px - points[i].arc_px));
        if (lag > most) break;
        if (!(fit.weight[j] > 0)) continue;
        sums[static_cast<std::size_t>(lag)] += a * fit.weight[j] * fit.offset_px[j] / fit.sigma_px;
        counts[static_cast<std::size_t>(lag)] += 1;
      }
    }
  }
  // What was fitted took a mode each out of what is left, with the power of `length` points: over short lags their
  // products fall by that share of the variance, `numbers` times.
  double length = 1, points = 0;
  for (const SightingFit* fit : fits) points += static_cast<double>(fit->counted);
  for (int round = 0; round < 5; ++round) {
    const double taken = std::min(0.5, numbers * length / std::max(points, 1.0));
    double sum = 1;
    for (std::size_t lag = 1; lag <= most && counts[lag] > 0; ++lag) {
      const double value = (1 - taken) * sums[lag] / counts[lag] / (sums[0] / counts[0]) + taken;
      if (value < std::max(0.02, 1 / std::sqrt(counts[lag])) + taken) break;
      sum += 2 * value;
    }
    length = sum;
  }
  return length;
}

// Mean square of the weighted offsets, in units of sigma.
double variance_of(const SightingFit& fit, const RimSlopes& along) {
  double sum = 0;
  for (const std::size_t i : along.used)
    sum += fit.weight[i] * fit.weight[i] * fit.offset_px[i] * fit.offset_px[i] / (fit.sigma_px * fit.sigma_px);
  return along.used.empty() ? 0 : sum / static_cast<double>(along.used.size());
}

// M of fit.h for one sighting, by the numbers; `variance`: of weighted offsets in units of sigma.
void add_meat(const Sighting& sighting, const RimSlopes& along, double length_px, double variance,
              Eigen::MatrixXd& meat) {
  const auto& points = sighting.points;
  const auto& used = along.used;
  // An exponential of that length is positive definite whatever the arcs are; the measured autocorrelation need not be.
  const double decay = 2 / std::max(length_px, 1e-3), reach = 6 / decay;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Eigen::VectorXd own = along.slopes.row(static_cast<Index>(i)).transpose();
    Eigen::VectorXd near = 0.5 * own;
    for (std::size_t j = i + 1; j < used.size() && points[used[j]].loop == points[used[i]].loop; ++j) {
      const double lag = points[used[j]].arc_px - points[used[i]].arc_px;
      if (lag > reach) break;
      if (length_px > 1.05) near += std::exp(-decay * lag) * along.slopes.row(static_cast<Index>(j)).transpose();
    }
    meat += variance * (own * near.transpose() + near * own.transpose());
  }
}

// Sum of psi' over the sum of psi / r, for Cauchy's loss at the points' offsets.
double bend_of_loss(const Fitted& f) {
  double bend = 0, weight = 0;
  for (const SightingFit& s : f.sightings)
    for (const double w : s.weight) bend += w * (2 * w - 1), weight += w;  // w = 1 / (1 + s): psi' = (1 - s) w^2
  return weight > 0 ? std::max(0.1, bend / weight) : 1;
}

// How far the errors of two photographs of one rim are one error: correlation of the offsets of points beside each
// other. One mask that serves under several lamps is one observation.
double likeness(const Sighting& a, const SightingFit& fit_a, const Sighting& b, const SightingFit& fit_b) {
  const SeenPoints others(b.points);
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (!(fit_a.weight[i] > 0)) continue;
    const auto k = others.nearest(a.points[i].pixel, a.points[i].outward, 1);
    if (!k || !(fit_b.weight[*k] > 0)) continue;
    const double x = fit_a.weight[i] * fit_a.offset_px[i], y = fit_b.weight[*k] * fit_b.offset_px[*k];
    ab += x * y, aa += x * x, bb += y * y;
  }
  return aa > 0 && bb > 0 ? std::max(0.0, ab / std::sqrt(aa * bb)) : 0;
}

// Of each sighting: by how much its variance grows because others of the same rim err alike.
std::vector<double> repetition(const Question& q, const Fitted& f) {
  std::vector<double> factor(q.sightings.size(), 1);
  for (std::size_t i = 0; i < factor.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (q.sightings[i].subject == q.sightings[k].subject) {
        const double like = likeness(q.sightings[i], f.sightings[i], q.sightings[k], f.sightings[k]);
        factor[i] += like, factor[k] += like;
      }
  return factor;
}

}  // namespace

namespace {

// J'WJ, with small numbers on the diagonal, so that what nothing holds gets a large inverse and no infinite one;
// numbers in units in which each counts alike, so that nothing is lost to rounding.
struct Bread {
  Eigen::VectorXd unit;
  Eigen::MatrixXd inverse;
};
constexpr double ridge = 1e-10;  // as if that much were known, and as badly as that
Bread bread_of(const Eigen::MatrixXd& h) {
  const Index count = h.rows();
  Bread bread{Eigen::VectorXd(count), {}};
  for (Index i = 0; i < count; ++i) bread.unit(i) = 1 / std::sqrt(std::max(h(i, i), 1e-20));
  Eigen::MatrixXd scaled = bread.unit.asDiagonal() * h * bread.unit.asDiagonal();
  scaled.diagonal().array() += ridge;
  const Eigen::MatrixXd inverse = linear::Ldlt(scaled).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(count, count)));
  bread.inverse = bread.unit.asDiagonal() * inverse * bread.unit.asDiagonal();
  return bread;
}

}  // namespace

void find_covariance(Fitted& f, const Question& q, Eigen::MatrixXd h, const Eigen::MatrixXd& by_points) {
  const auto count = static_cast<Index>(numbers_of(q.freedoms));
  Eigen::MatrixXd of_points = Eigen::MatrixXd::Zero(count, count);
  double correlation = 0, weight = 0;
  const std::vector<double> repeated = repetition(q, f);
  std::vector<RimSlopes> slopes;
  for (std::size_t i = 0; i < q.sightings.size(); ++i) slopes.push_back(rim_slopes(f.setting, q, i, f.sightings[i]));
  std::vector<ShortErrors> short_errors(q.sightings.size());
  double all_points = 1;
  for (const SightingFit& fit : f.sightings) all_points += static_cast<double>(fit.counted);
  for (const bool shadows : {false, true}) {
    std::vector<const Sighting*> sightings;
    std::vector<const SightingFit*> fits;
    for (std::size_t i = 0; i < q.sightings.size(); ++i)
      if (q.sightings[i].subject.lamp.has_value() == shadows)
        sightings.push_back(&q.sightings[i]), fits.push_back(&f.sightings[i]);
    if (fits.empty()) continue;
    double points = 0;
    for (const SightingFit* fit : fits) points += static_cast<double>(fit->counted);
    const double length = correlation_length(sightings, fits, static_cast<double>(count) * points / all_points);
    correlation += points * length, weight += points;
    for (std::size_t i = 0; i < q.sightings.size(); ++i) {
      if (q.sightings[i].subject.lamp.has_value() != shadows) continue;
      const SightingFit& fit = f.sightings[i];
      const double variance = repeated[i] * variance_of(fit, slopes[i]);
      short_errors[i] = {length, variance * fit.sigma_px * fit.sigma_px * length};
      add_meat(q.sightings[i], slopes[i], length, variance, of_points);
    }
  }
  // Priors and contacts are independent of all that: their part of M is their part of H. The points' part of H has the
  // weights of the squares; the slope of the loss's own slope is what counts for where the minimum moves (Huber 1964).
  Eigen::MatrixXd meat = h - by_points + of_points;
  h += (bend_of_loss(f) - 1) * by_points;
  f.correlation_px = weight > 0 ? correlation / weight : 0;
  const Bread bread = bread_of(h);
  for (Index i = 0; i < count; ++i) meat(i, i) += ridge / (bread.unit(i) * bread.unit(i));
  // As many numbers as were found are missing among the independent errors that are left.
  const double independent = weight / std::max(1.0, f.correlation_px);
  const double lost = std::min(0.5, static_cast<double>(count) / std::max(1.0, independent));
  const CommonErrors common = common_errors(q, f, slopes, short_errors, bread.inverse);
  f.common_px = std::sqrt(std::max(common.mask_px2[0] + common.piece_px2[0], common.mask_px2[1] + common.piece_px2[1]));
  f.covariance = bread.inverse * (meat / (1 - lost) + common.meat) * bread.inverse;
}

}  // namespace gonio::alignment
