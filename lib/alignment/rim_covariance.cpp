// See rim_covariance.h.
#include "alignment/rim_covariance.h"

#include <algorithm>
#include <cmath>

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

// M of fit.h for one sighting, by the numbers, and its variance of weighted offsets in units of sigma.
void add_meat(const Setting& s, const Question& q, std::size_t index, const SightingFit& fit, double length_px,
              double repeated, Eigen::MatrixXd& meat) {
  const Sighting& sighting = q.sightings[index];
  const auto count = static_cast<Index>(numbers_of(q.freedoms));
  const GroundAxes axes = ground_axes(s);
  const ModelRim rim(s, sighting.subject);
  std::vector<std::size_t> used;
  std::vector<Eigen::VectorXd> slopes;
  std::vector<double> row(static_cast<std::size_t>(count));
  Eigen::VectorXd all_along = Eigen::VectorXd::Zero(count);
  double variance = 0, offsets = 0, weights = 0;
  for (std::size_t i = 0; i < sighting.points.size(); ++i) {
    if (!(fit.weight[i] > 0)) continue;
    const auto place =
        rim.nearest(sighting.points[i].pixel, sighting.points[i].outward, std::abs(fit.offset_px[i]) + 1e-6);
    if (!place) continue;
    slopes_of(s, q.freedoms, axes, sighting.subject.station, sighting.subject.body, sighting.subject.lamp,
              place->mesh_point, place->outward, row.data());
    used.push_back(i);
    slopes.push_back(Eigen::Map<const Eigen::VectorXd>(row.data(), count) * (fit.share / fit.sigma_px));
    variance += fit.weight[i] * fit.weight[i] * fit.offset_px[i] * fit.offset_px[i] / (fit.sigma_px * fit.sigma_px);
    all_along += fit.weight[i] * slopes.back();
    offsets += fit.weight[i] * fit.offset_px[i] / fit.sigma_px, weights += fit.weight[i];
  }
  if (used.empty()) return;
  const auto points_used = static_cast<double>(used.size());
  variance /= points_used;
  // A mask that is too wide all around: what its mean offset has beyond the mean of that many independent errors.
  const double common = offsets * offsets / (weights * weights) - variance * length_px / points_used;
  if (common > 0) meat += repeated * common * all_along * all_along.transpose();
  variance *= repeated;
  const auto& points = sighting.points;
  // An exponential of that length is positive definite whatever the arcs are; the measured autocorrelation need not be.
  const double decay = 2 / std::max(length_px, 1e-3), reach = 6 / decay;
  for (std::size_t i = 0; i < used.size(); ++i) {
    Eigen::VectorXd near = 0.5 * slopes[i];
    for (std::size_t j = i + 1; j < used.size() && points[used[j]].loop == points[used[i]].loop; ++j) {
      const double lag = points[used[j]].arc_px - points[used[i]].arc_px;
      if (lag > reach) break;
      if (length_px > 1.05) near += std::exp(-decay * lag) * slopes[j];
    }
    meat += variance * (slopes[i] * near.transpose() + near * slopes[i].transpose());
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

void find_covariance(Fitted& f, const Question& q, Eigen::MatrixXd h, const Eigen::MatrixXd& by_points) {
  const auto count = static_cast<Index>(numbers_of(q.freedoms));
  Eigen::MatrixXd of_points = Eigen::MatrixXd::Zero(count, count);
  double correlation = 0, weight = 0;
  const std::vector<double> repeated = repetition(q, f);
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
    for (std::size_t i = 0; i < q.sightings.size(); ++i)
      if (q.sightings[i].subject.lamp.has_value() == shadows)
        add_meat(f.setting, q, i, f.sightings[i], length, repeated[i], of_points);
  }
  // Priors and contacts are independent of all that: their part of M is their part of H. The points' part of H has the
  // weights of the squares; the slope of the loss's own slope is what counts for where the minimum moves (Huber 1964).
  Eigen::MatrixXd meat = h - by_points + of_points;
  h += (bend_of_loss(f) - 1) * by_points;
  f.correlation_px = weight > 0 ? correlation / weight : 0;
  // In units in which every number counts alike, so that nothing is lost to rounding; what nothing holds gets a large
  // variance; what is not seen at all as well, without its square running over.
  Eigen::VectorXd unit(count);
  for (Index i = 0; i < count; ++i) unit(i) = 1 / std::sqrt(std::max(h(i, i), 1e-20));
  Eigen::MatrixXd scaled = unit.asDiagonal() * h * unit.asDiagonal();
  constexpr double ridge = 1e-10;  // as if that much were known, and as badly as that
  scaled.diagonal().array() += ridge;
  for (Index i = 0; i < count; ++i) meat(i, i) += ridge / (unit(i) * unit(i));
  const Eigen::MatrixXd inverse = linear::Ldlt(scaled).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(count, count)));
  const Eigen::MatrixXd h_inverse = unit.asDiagonal() * inverse * unit.asDiagonal();
  // As many numbers as were found are missing among the independent errors that are left.
  const double independent = weight / std::max(1.0, f.correlation_px);
  const double lost = std::min(0.5, static_cast<double>(count) / std::max(1.0, independent));
  f.covariance = h_inverse * meat * h_inverse / (1 - lost);
}

}  // namespace gonio::alignment
