// A wider neighbourhood has less noise and more bias. Neighbourhoods grow while the slopes and the height that they
// tell are compatible with those of all narrower ones: the intervals value +- gamma sd have a point in common
// (intersection of confidence intervals, Goldenshluger & Nemirovski 1997, Katkovnik 1999); and while what the quadratic
// leaves is the noise's. The height is held more narrowly: on a ball of radius R a quadratic over a disc of radius r
// lies too far out by the order of r^4 / (48 R^3), everywhere the same way, while its slopes have no bias.
#include "mesh/clean/bandwidth.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/clean/local_quadratic.h"

namespace gonio::mesh {
namespace {

constexpr std::array<double, 7> radii{1.5, 2.0, 2.7, 3.6, 4.8, 6.4, 8.5};  // mean edges
constexpr std::array<double, 3> gammas{2.0, 3.0, 3.0};                     // of the height and both slopes
constexpr double misfit_sd = 6;     // by how many sd the residual's mean square may exceed the noise
constexpr double noise_radius = 3;  // mean edges
constexpr double correlated_within = 2.2;
constexpr std::size_t noise_samples = 3000;

struct Place {
  double u, v, h;
};

class Frame {
 public:
  Frame(const NoisySurface& surface, std::uint32_t face)
      : basis_(surface.faces[face].guide),
        centre_(surface.faces[face].centroid),
        edge_(surface.edge_m),
        per_edge_(1 / surface.edge_m) {}
  Place of(Vec3 p) const {
    const Vec3 local = basis_.to_local(p - centre_) * per_edge_;
    return {local.x, local.y, local.z};
  }
  Vec3 out(double u, double v, double h) const { return centre_ + basis_.to_world({u, v, h}) * edge_; }
  Vec3 direction(Vec3 local) const { return basis_.to_world(local); }

 private:
  Basis basis_;
  Vec3 centre_;
  double edge_, per_edge_;
};

double weight_of(const std::vector<double>& weights, std::uint32_t v) {
  return weights.empty() ? 1 : weights[v];
}

struct NoiseSample {
  double mean_square = 0, correlations = 0;  // correlations: sum over near pairs / (points mean_square)
  bool good = false;
};

NoiseSample sample_noise(const NoisySurface& surface, const std::vector<double>& weights, std::uint32_t face) {
  Neighbourhood around(surface);
  around.start(face);
  around.grow(noise_radius * surface.edge_m);
  const Frame frame(surface, face);
  LocalQuadratic quadratic;
  std::vector<Place> places;
  for (const std::uint32_t v : around.vertices()) {
    const Place at = frame.of(surface.positions_m[v]);
    places.push_back(at);
    quadratic.add(at.u, at.v, at.h, weight_of(weights, v));
  }
  const auto fit = quadratic.fit();
  NoiseSample sample;
  const auto n = static_cast<double>(places.size());
  if (!fit.good || n < 12) return sample;
  sample.good = true;
  sample.mean_square = fit.residual / (n - 6);
  // Residuals of independent errors are correlated by -H = -B (B'B)^-1 B'; that is taken off.
  double sum = 0;
  std::vector<double> left(places.size());
  std::vector<LocalQuadratic::Terms> solved(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double root = std::sqrt(weight_of(weights, around.vertices()[i]));
    left[i] = root * (places[i].h - fit.at(places[i].u, places[i].v));
    const auto t = LocalQuadratic::terms(places[i].u, places[i].v);
    for (std::size_t r = 0; r < 6; ++r) {
      solved[i][r] = 0;
      for (std::size_t c = 0; c < 6; ++c) solved[i][r] += fit.inverse[6 * r + c] * t[c];
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double du = places[i].u - places[j].u, dv = places[i].v - places[j].v;
      if (du * du + dv * dv > correlated_within * correlated_within) continue;
      double hat = 0;
      for (std::size_t r = 0; r < 6; ++r) hat += t[r] * solved[j][r];
      sum += 2 * (left[i] * left[j] + hat * sample.mean_square);
    }
  }
  sample.correlations = sample.mean_square > 0 ? sum / (n * sample.mean_square) : 0;
  return sample;
}

// The intervals of the height and both slopes so far.
class Compatible {
 public:
  bool still(const LocalQuadratic::Fit& fit, double unit_variance) {
    bool compatible = true;
    for (std::size_t i = 0; i < gammas.size(); ++i) {
      const double reach = gammas[i] * std::sqrt(unit_variance * fit.inverse[7 * i]);
      low_[i] = std::max(low_[i], fit.c[i] - reach);
      high_[i] = std::min(high_[i], fit.c[i] + reach);
      compatible = compatible && low_[i] <= high_[i];
    }
    return compatible;
  }

 private:
  std::array<double, 3> low_{-1e300, -1e300, -1e300}, high_{1e300, 1e300, 1e300};
};

LocalSurface local_surface(const NoisySurface& surface, const VertexNoise& noise, const std::vector<double>& weights,
                           Neighbourhood& around, std::uint32_t face) {
  const Frame frame(surface, face);
  const double sigma = noise.sigma_m / surface.edge_m, variance = sigma * sigma * noise.inflation;
  LocalQuadratic quadratic;
  Compatible values;
  LocalSurface best;
  std::size_t added = 0;
  around.start(face);
  for (const double radius : radii) {
    around.grow(radius * surface.edge_m);
    const bool more = added < around.vertices().size();
    for (; added < around.vertices().size(); ++added) {
      const std::uint32_t v = around.vertices()[added];
      const Place at = frame.of(surface.positions_m[v]);
      quadratic.add(at.u, at.v, at.h, weight_of(weights, v));
    }
    if (!more && around.exhausted()) break;
    const auto fit = quadratic.fit();
    if (!fit.good || quadratic.points() < 8) continue;
    const double freedom = quadratic.points() - 6;
    const double limit = sigma * sigma * (1 + misfit_sd * std::sqrt(2 * noise.inflation / freedom));
    const bool fits = values.still(fit, variance) && fit.residual / freedom <= limit;
    if (!fits && best.radius > 0) break;
    for (std::size_t i = 0; i < 6; ++i) best.c[i] = static_cast<float>(fit.c[i]);
    best.variance = static_cast<float>(fit.variance_of_height());
    best.radius = static_cast<float>(radius);
    if (!fits) break;
  }
  return best;
}

}  // namespace

VertexNoise noise_of(const NoisySurface& surface, const std::vector<double>& weights) {
  const std::size_t count = surface.triangles.size(), step = std::max<std::size_t>(1, count / noise_samples);
  std::vector<NoiseSample> samples((count + step - 1) / step);
  parallel_for(
      0, samples.size(),
      [&](std::size_t i) { samples[i] = sample_noise(surface, weights, static_cast<std::uint32_t>(i * step)); }, 64);
  std::erase_if(samples, [](const NoiseSample& s) { return !s.good; });
  if (samples.empty()) return {};
  // Where the object bends within the neighbourhood the residual is not the noise's: the median, and for correlations
  // the half below it.
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end(),
                   [](const NoiseSample& a, const NoiseSample& b) { return a.mean_square < b.mean_square; });
  VertexNoise noise{surface.edge_m * std::sqrt(middle->mean_square), 1};
  double sum = 0;
  for (auto s = samples.begin(); s != middle; ++s) sum += s->correlations;
  if (middle != samples.begin())
    noise.inflation = std::clamp(1 + sum / static_cast<double>(middle - samples.begin()), 1.0, 8.0);
  return noise;
}

std::vector<LocalSurface> local_surfaces(const NoisySurface& surface, const VertexNoise& noise,
                                         const std::vector<double>& weights) {
  std::vector<LocalSurface> all(surface.triangles.size());
  constexpr std::size_t block = 2048;
  parallel_for(0, (all.size() + block - 1) / block, [&](std::size_t b) {
    Neighbourhood around(surface);
    for (std::size_t f = b * block; f < std::min(all.size(), (b + 1) * block); ++f)
      all[f] = local_surface(surface, noise, weights, around, static_cast<std::uint32_t>(f));
  });
  return all;
}

SurfacePoint over(const NoisySurface& surface, const LocalSurface& local, std::uint32_t face, Vec3 p) {
  const Frame frame(surface, face);
  const Place at = frame.of(p);
  const auto& c = local.c;
  const double u = at.u, v = at.v;
  const double h = c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v;
  const Vec3 slope{-(c[1] + 2 * c[3] * u + c[4] * v), -(c[2] + c[4] * u + 2 * c[5] * v), 1};
  return {frame.out(u, v, h), frame.direction(normalized(slope))};
}

}  // namespace gonio::mesh
