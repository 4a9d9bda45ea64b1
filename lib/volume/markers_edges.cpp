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
#include "volume/contour_shape.h"
#include "volume/markers_parts.h"
#include "volume/slabs.h"
#include "volume/threshold.h"

namespace gonio::volume::marker {
namespace {

constexpr double reach = 3, step = 0.5;  // voxels
constexpr double width_guess = 0.85;
constexpr double model_sd = 0.02;        // voxels: what an edge is off by, whatever its noise

double quantile(std::vector<double> v, double share) {
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = v.begin() + static_cast<std::ptrdiff_t>(std::min(v.size() - 1, static_cast<std::size_t>(share * static_cast<double>(v.size()))));
  std::ranges::nth_element(v, at);
  return *at;
}

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
    return {quantile(without, 0.2), quantile(within, 0.5)};
  }

  // The edge along one radius; sigma 0: none.
  RadialEdge edge(const Sphere& s, Vec3 direction, const Levels& levels, std::optional<double> width) const {
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
    const Vec3 along = divided(direction, scale_), first = divided(s.centre + direction * (s.radius + places.front()), scale_);
    const auto covariance = trilinear_covariance(first, along * step, places.size(), noise_.neighbour_correlation);
    ProfileWish wish{noise_.sd, covariance, 1 / s.radius};
    wish.width = width;
    const Edge e = fit_edge(places, values, wish);
    const double rise = levels.object - levels.air, off = std::max(0.7, 0.08 * s.radius);
    if (!e.good || e.object < e.air || std::abs(e.position) > off || std::abs(e.air - levels.air) > 0.3 * rise ||
        std::abs(e.object - levels.object) > 0.35 * rise)
      return {};
    return {direction, s.radius + e.position, e.sigma, e.air, e.object, e.width};
  }

  double at(const Sphere& s, Vec3 direction, double x) const {
    return crop_.block.at(divided(s.centre + direction * (s.radius + x), scale_));
  }

 private:
  const Crop& crop_;
  const NoiseModel& noise_;
  Vec3 scale_;
};

// Edges at the rim of what is hidden are moved by what hides it: where two fifths of a direction's neighbours show none,
// it is not believed either.
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

void collect(Sphere& s, const Rays& rays, std::optional<double> width) {
  const auto count = static_cast<std::size_t>(std::clamp(4 * pi * s.radius * s.radius / 3, 96.0, 1200.0));
  if (s.asked.size() != count) s.asked = even_directions(count);
  s.directions = count;
  const Levels levels = rays.levels(s);
  std::vector<RadialEdge> all(count);
  parallel_for(0, count, [&](std::size_t n) { all[n] = rays.edge(s, s.asked[n], levels, width); }, 32);
  s.covered.assign(count, false);
  std::vector<double> widths;
  for (std::size_t n = 0; n < count; ++n)
    if (all[n].sigma > 0) widths.push_back(all[n].width);
  s.width = quantile(widths, 0.5);
  for (std::size_t n = 0; n < count; ++n)
    s.covered[n] = all[n].sigma > 0 && all[n].width < 1.8 * s.width && all[n].width > 0.5 * s.width;
  leave_rims_out(s);
  s.edges.clear();
  for (std::size_t n = 0; n < count; ++n)
    if (s.covered[n]) s.edges.push_back(all[n]);
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
    const double limit = 2.5 * std::max(1.0, quantile(z, 0.5) / 0.6745);
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
  const Eigen::Matrix4d inverse = linear::solve_ldlt(Eigen::MatrixXd(a), Eigen::MatrixXd(Eigen::MatrixXd::Identity(4, 4)));
  const double more = std::max(1.0, squares / std::max(1.0, static_cast<double>(n) - 4));
  const Eigen::Matrix4d c = more * inverse * b * inverse;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s.covariance[static_cast<std::size_t>(3 * i + j)] = c(i, j);
  s.sigma_radius = held ? 0 : std::sqrt(std::max(0.0, c(3, 3)));
}

}  // namespace

double room_round(double radius) {
  return 1.35 * std::abs(radius) + 6;
}

std::vector<Crop> crops(io::VolumeSource& source, const std::vector<Candidate>& of, Vec3 scale) {
  const auto& size = source.head().size;
  std::vector<Crop> result(of.size());
  for (std::size_t n = 0; n < of.size(); ++n) {
    const double room = room_round(of[n].radius);
    Block& b = result[n].block;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double last = static_cast<double>(size[a] - 1);
      const double low = std::clamp(std::floor((of[n].centre[axis] - room) / scale[axis]), 0.0, last);
      const double high = std::clamp(std::ceil((of[n].centre[axis] + room) / scale[axis]), 0.0, last);
      b.first[a] = static_cast<std::ptrdiff_t>(low);
      b.size[a] = static_cast<std::size_t>(high - low) + 1;
    }
    const auto end = [&](std::size_t a) { return static_cast<double>(b.first[a]) + static_cast<double>(b.size[a] - 1); };
    b.low = {static_cast<double>(b.first[0]), static_cast<double>(b.first[1]), static_cast<double>(b.first[2])};
    b.high = {end(0), end(1), end(2)};
    result[n].values.resize(b.size[0] * b.size[1] * b.size[2]);
    b.values = result[n].values.data();
  }
  for_each_slab(source, {16, 0, 0}, [&](const Slab& slab) {
    for (Crop& c : result)
      for (std::size_t k = slab.first; k < slab.first + slab.count; ++k) {
        const std::ptrdiff_t z = static_cast<std::ptrdiff_t>(k) - c.block.first[2];
        if (z < 0 || z >= static_cast<std::ptrdiff_t>(c.block.size[2])) continue;
        const float* slice = slab.slice(static_cast<std::ptrdiff_t>(k));
        for (std::size_t y = 0; y < c.block.size[1]; ++y)
          std::copy_n(slice + (static_cast<std::size_t>(c.block.first[1]) + y) * slab.width + c.block.first[0],
                      c.block.size[0],
                      c.values.begin() + static_cast<std::ptrdiff_t>((static_cast<std::size_t>(z) * c.block.size[1] + y) * c.block.size[0]));
      }
  });
  return result;
}

NoiseModel noise_within(const std::vector<Candidate>& spheres, const std::vector<Crop>& all, Vec3 scale,
                        std::optional<double> known_correlation) {
  std::array<double, 4> squares{}, count{};
  for (std::size_t n = 0; n < spheres.size(); ++n) {
    const Block& b = all[n].block;
    const double within = std::abs(spheres[n].radius) - 2.2, without = std::abs(spheres[n].radius) + 3;
    const std::array<std::size_t, 3> stride{1, b.size[0], b.size[0] * b.size[1]};
    std::vector<char> kind(all[n].values.size());  // 1 within, 2 without
    std::vector<double> outside;
    for (std::size_t v = 0; v < kind.size(); ++v) {
      const Vec3 index{b.low.x + static_cast<double>(v % b.size[0]), b.low.y + static_cast<double>(v / stride[1] % b.size[1]),
                       b.low.z + static_cast<double>(v / stride[2])};
      const double r = norm(index * scale - spheres[n].centre);
      kind[v] = r < within ? 1 : r > without ? 2 : 0;
      if (kind[v] == 2) outside.push_back(all[n].values[v]);
    }
    // Of what lies without, only what is as low as most: air.
    const double low = quantile(outside, 0.25), middle = quantile(outside, 0.5), spread = 6 * std::max(1e-30, middle - low);
    for (std::size_t v = 0; v < kind.size(); ++v)
      if (kind[v] == 2 && all[n].values[v] > middle + spread) kind[v] = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const std::size_t lag : {1u, 3u})
        for (std::size_t v = 0; v < kind.size(); ++v) {
          if (v / stride[axis] % b.size[axis] + lag >= b.size[axis]) continue;
          const std::size_t other = v + lag * stride[axis];
          if (kind[v] == 0 || kind[v] != kind[other]) continue;
          const double d = static_cast<double>(all[n].values[v]) - all[n].values[other];
          squares[lag] += d * d / 2, count[lag] += 1;
        }
  }
  if (count[3] < 20) return {};
  // D1 / D3 = (1 - q) / (1 - q^9), which falls with q.
  const double near = squares[1] / count[1], far = squares[3] / count[3], ratio = far > 0 ? near / far : 1;
  double q = known_correlation.value_or(0);
  if (!known_correlation) {
    double low = -0.45, high = 0.95;
    for (int n = 0; n < 50; ++n) {
      q = (low + high) / 2;
      const double foretold = (1 - q) / (q > 0 ? 1 - std::pow(q, 9) : 1);
      (foretold > ratio ? low : high) = q;
    }
  }
  return {std::sqrt(far / (q > 0 ? 1 - std::pow(q, 9) : 1)), q};
}

Sphere refined(const Candidate& start, const Crop& crop, const NoiseModel& noise, Vec3 scale,
               std::optional<double> radius) {
  Sphere s;
  s.centre = start.centre;
  s.radius = std::abs(start.radius);
  s.noise = noise.sd;
  const Rays rays(crop, noise, scale);
  const Sharing sharing(noise);
  std::optional<double> width;
  for (int round = 0; round < 5; ++round) {
    const Vec3 before = s.centre;
    const double radius_before = s.radius;
    collect(s, rays, width);
    if (s.edges.size() < 12) return s;
    std::vector<Vec3> places;
    for (const RadialEdge& e : s.edges) places.push_back(s.centre + e.direction * e.distance);
    const bool held = radius.has_value();
    if (held) s.radius = *radius;
    const std::vector<double> weights = solve(s, places, held);
    state_covariance(s, places, weights, held, sharing, scale);
    width = s.width;
    if (round > 1 && norm(s.centre - before) < 0.003 && std::abs(s.radius - radius_before) < 0.01) break;
  }
  return s;
}

}  // namespace gonio::volume::marker
