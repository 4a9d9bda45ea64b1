// A sphere by the edges of the volume along its radii: least squares, and a covariance that knows that neighbouring
// edges are fitted to the same voxels.
//
//   minimise  sum w_i rho(|q_i - c| - R)^2,   q_i = where the edge in direction d_i lies
//   covariance = A^-1 B A^-1,  A = sum w_i J_i J_i',  B = sum_ij w_i w_j J_i J_j' sigma_i sigma_j corr(q_i - q_j)
//
// Two edges beside one another are the same linear functional of the noise, moved: their errors correlate as trilinear
// samples as far apart do, averaged over where in a voxel they lie.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "stats/intervals.h"
#include "volume/contour_shape.h"
#include "volume/markers_parts.h"
#include "volume/threshold.h"

namespace gonio::volume::marker {
namespace {

constexpr double reach = 3, step = 0.5;  // voxels
constexpr double width_guess = 0.85;
constexpr double alike = 0.05;     // of the step: sd of the plateaus round one marker
constexpr double model_sd = 0.02;  // voxels: what an edge is off by, whatever its noise

// Correlation of errors as far apart along one axis as the table's index says, in twentieths of a voxel.
class Sharing {
 public:
  explicit Sharing(const NoiseModel& noise) {
    const AxisCovariance axis(noise.neighbour_correlation);
    constexpr int phases = 10;
    for (int n = 0; n < 20 * 8; ++n) {
      double sum = 0;
      for (int p = 0; p < phases; ++p) sum += axis((p + 0.5) / phases, (p + 0.5) / phases + n / 20.0);
      table_.push_back(sum / phases);
    }
    const double whole = table_[0];
    for (double& t : table_) t /= whole;
  }
  double operator()(Vec3 apart) const { return along(apart.x) * along(apart.y) * along(apart.z); }

 private:
  double along(double d) const {
    const auto n = static_cast<std::size_t>(std::lround(20 * std::abs(d)));
    return n < table_.size() ? table_[n] : 0;
  }
  std::vector<double> table_;
};

struct Levels {
  double air = 0, object = 0;
};

class Rays {
 public:
  Rays(const Crop& crop, const NoiseModel& noise, Vec3 scale) : crop_(crop), noise_(noise), scale_(scale) {}

  // What the sphere and its surroundings have as values: medians just within, the lower quarter just without.
  Levels levels(const Sphere& s) const {
    std::vector<double> within, without;
    for (const Vec3 d : s.asked) {
      const double v = at(s, d, -std::min(2.0, 0.6 * s.radius)), w = at(s, d, 2.5);
      if (std::isfinite(v)) within.push_back(v);
      if (std::isfinite(w)) without.push_back(w);
    }
    return {stats::quantile(without, 0.2), stats::median(within)};
  }

  // The edge along one radius; sigma 0: none.
  RadialEdge edge(const Sphere& s, Vec3 direction, const Levels& levels, std::optional<double> width,
                  bool settled) const {
    std::vector<double> places, values;
    const double inner = std::min(reach, 0.85 * s.radius), third = levels.air + 0.3 * (levels.object - levels.air);
    bool fallen = false;
    for (double x = -std::floor(inner / step) * step; x <= reach + 1e-9; x += step) {
      const double v = at(s, direction, x);
      if (!std::isfinite(v)) {
        if (x < 0) return {};
        break;
      }
      if (fallen && v > third && x > 0.5) break;  // another body begins
      fallen = fallen || (x > 0 && v < third);
      places.push_back(x), values.push_back(v);
    }
    if (places.empty() || places.back() < 1.4) return {};
    const Vec3 along = divided(direction, scale_),
               first = divided(s.centre + direction * (s.radius + places.front()), scale_);
    const auto covariance = trilinear_covariance(first, along * step, places.size(), noise_.neighbour_correlation);
    ProfileWish wish{noise_.sd, covariance, 1 / s.radius};
    wish.width = width;
    wish.width_share = 0.25;  // slices are sharper along the axis than within
    const double plateau_sd = alike * std::abs(levels.object - levels.air);
    if (settled) wish.air = Known{levels.air, plateau_sd}, wish.object = Known{levels.object, plateau_sd};
    const Edge e = fit_edge(places, values, wish);
    const double rise = levels.object - levels.air, off = std::max(0.7, 0.08 * s.radius);
    // What lies before it is no air where it is not like that round the rest: the foot of something lighter than the
    // marker, whose smear draws the edge inwards. Such edges stand on one side, and would push the centre to the other.
    const double most = settled ? 2 * alike : 0.3;
    if (!e.good || e.object < e.air || std::abs(e.position) > off || std::abs(e.air - levels.air) > most * rise ||
        std::abs(e.object - levels.object) > 0.35 * rise)
      return {};
    return {direction, s.radius + e.position, e.sigma, e.air, e.object, e.width, e.excess};
  }

  double at(const Sphere& s, Vec3 direction, double x) const {
    return crop_.block.at(divided(s.centre + direction * (s.radius + x), scale_));
  }

 private:
  const Crop& crop_;
  const NoiseModel& noise_;
  Vec3 scale_;
};

// Edges at the rim of what is hidden are moved by what hides it: where two fifths of a direction's neighbours show
// none, it is not believed either.
void leave_rims_out(Sphere& s) {
  const double near = std::cos(std::min(1.0, 2.6 / s.radius));
  std::vector<bool> keep(s.asked.size());
  for (std::size_t i = 0; i < s.asked.size(); ++i) {
    int all = 0, missing = 0;
    for (std::size_t j = 0; j < s.asked.size(); ++j)
      if (j != i && dot(s.asked[i], s.asked[j]) > near) ++all, missing += s.covered[j] ? 0 : 1;
    keep[i] = s.covered[i] && 5 * missing < 2 * std::max(1, all);
  }
  s.covered = keep;
}

// `known`: of the round before; then an edge that they do not describe is none (another body is near).
void collect(Sphere& s, const Rays& rays, std::optional<double> width, const std::optional<Levels>& known) {
  const auto count = static_cast<std::size_t>(std::clamp(4 * pi * s.radius * s.radius / 3, 96.0, 1200.0));
  if (s.asked.size() != count) s.asked = even_directions(count);
  s.directions = count;
  const Levels levels = known ? *known : rays.levels(s);
  std::vector<RadialEdge> all(count);
  parallel_for(
      0, count, [&](std::size_t n) { all[n] = rays.edge(s, s.asked[n], levels, width, known.has_value()); }, 32);
  s.covered.assign(count, false);
  std::vector<double> widths, excess;
  for (std::size_t n = 0; n < count; ++n)
    if (all[n].sigma > 0) widths.push_back(all[n].width), excess.push_back(all[n].excess);
  s.width = stats::median(widths);
  // Misfits that all directions share are the model's or the scanner's (streaks); only what stands out is another body.
  const double most = known ? 4 * std::max(1.0, stats::median(excess)) : HUGE_VAL;
  for (std::size_t n = 0; n < count; ++n)
    s.covered[n] =
        all[n].sigma > 0 && all[n].width < 1.8 * s.width && all[n].width > 0.45 * s.width && all[n].excess < most;
  leave_rims_out(s);
  s.edges.clear();
  for (std::size_t n = 0; n < count; ++n)
    if (s.covered[n]) s.edges.push_back(all[n]);
}

Levels levels_of(const std::vector<RadialEdge>& edges) {
  std::vector<double> air, object;
  for (const RadialEdge& e : edges) air.push_back(e.air), object.push_back(e.object);
  return {stats::median(air), stats::median(object)};
}

using Slope = Eigen::Vector4d;
// Of |q - c| - R; R's is zero where it is held.
Slope slope_of(Vec3 from_centre, bool held) {
  const double r = norm(from_centre);
  return {-from_centre.x / r, -from_centre.y / r, -from_centre.z / r, held ? 0.0 : -1.0};
}

// Least squares over the edges, by Huber's weights; leaves the weights.
std::vector<double> solve(Sphere& s, const std::vector<Vec3>& places, bool held) {
  std::vector<double> weights(places.size());
  for (int round = 0; round < 12; ++round) {
    std::vector<double> z;
    for (std::size_t i = 0; i < places.size(); ++i)
      z.push_back(std::abs(norm(places[i] - s.centre) - s.radius) / std::hypot(s.edges[i].sigma, model_sd));
    const double limit = 2.5 * std::max(1.0, stats::median(z) / 0.6745);
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    Slope g = Slope::Zero();
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Vec3 from = places[i] - s.centre;
      const double variance = s.edges[i].sigma * s.edges[i].sigma + model_sd * model_sd, e = norm(from) - s.radius;
      weights[i] = (z[i] > limit ? limit / z[i] : 1) / variance;
      const Slope j = slope_of(from, held);
      a += weights[i] * j * j.transpose();
      g -= weights[i] * j * e;
      sum += weights[i] * e * e, all += weights[i];
    }
    s.rms = std::sqrt(sum / all);
    const Slope change = linear::solve_ldlt(a, g);
    if (!change.allFinite() || change.norm() > s.radius) break;
    s.centre += Vec3{change[0], change[1], change[2]};
    s.radius += change[3];
    if (change.norm() < 1e-6) break;
  }
  return weights;
}

void state_covariance(Sphere& s, const std::vector<Vec3>& places, const std::vector<double>& weights, bool held,
                      const Sharing& sharing, Vec3 scale) {
  const std::size_t n = places.size();
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero(), b = Eigen::Matrix4d::Zero();
  std::vector<Slope> slopes;
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 from = places[i] - s.centre;
    slopes.push_back(slope_of(from, held));
    a += weights[i] * slopes[i] * slopes[i].transpose();
    const double e = norm(from) - s.radius, variance = s.edges[i].sigma * s.edges[i].sigma + model_sd * model_sd;
    squares += std::min(9.0, e * e / variance);
  }
  for (std::size_t i = 0; i < n; ++i) {
    b += weights[i] * weights[i] * model_sd * model_sd * slopes[i] * slopes[i].transpose();
    for (std::size_t j = 0; j <= i; ++j) {
      const double shared = sharing(divided(places[i] - places[j], scale));
      if (shared <= 0) continue;
      const double c = weights[i] * weights[j] * s.edges[i].sigma * s.edges[j].sigma * shared;
      const Eigen::Matrix4d m = c * slopes[i] * slopes[j].transpose();
      b += m;
      if (i != j) b += m.transpose();
    }
  }
  if (held) a(3, 3) = 1;
  const Eigen::Matrix4d inverse =
      linear::solve_ldlt(Eigen::MatrixXd(a), Eigen::MatrixXd(Eigen::MatrixXd::Identity(4, 4)));
  const double more = std::max(1.0, squares / std::max(1.0, static_cast<double>(n) - 4));
  const Eigen::Matrix4d c = more * inverse * b * inverse;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s.covariance[static_cast<std::size_t>(3 * i + j)] = c(i, j);
  s.sigma_radius = held ? 0 : std::sqrt(std::max(0.0, c(3, 3)));
}

}  // namespace

Sphere refined(const Candidate& start, const Crop& crop, const NoiseModel& noise, Vec3 scale,
               std::optional<double> radius) {
  Sphere s;
  s.centre = start.centre;
  s.radius = std::abs(start.radius);
  s.noise = noise.sd;
  const Rays rays(crop, noise, scale);
  const Sharing sharing(noise);
  std::optional<double> width;
  std::optional<Levels> levels;
  for (int round = 0; round < 5; ++round) {
    const Vec3 before = s.centre;
    const double radius_before = s.radius;
    collect(s, rays, width, levels);
    if (s.edges.size() < 12) return s;
    std::vector<Vec3> places;
    for (const RadialEdge& e : s.edges) places.push_back(s.centre + e.direction * e.distance);
    const bool held = radius.has_value();
    if (held) s.radius = *radius;
    const std::vector<double> weights = solve(s, places, held);
    state_covariance(s, places, weights, held, sharing, scale);
    width = s.width;
    levels = levels_of(s.edges);
    if (round > 1 && norm(s.centre - before) < 0.003 && std::abs(s.radius - radius_before) < 0.01) break;
  }
  return s;
}

}  // namespace gonio::volume::marker
