// A wider neighbourhood has less noise and more bias. Neighbourhoods grow while the slopes and the height that they
// tell are compatible with those of all narrower ones: the intervals value +- gamma sd have a point in common
// (intersection of confidence intervals, Goldenshluger & Nemirovski 1997, Katkovnik 1999); and while what the quadratic
// leaves is the noise's. Both by what errors that neighbours share do to fits (noise.h): taken for independent, they
// make narrow fits look certain, and every wider one like a contradiction. The height is held more narrowly: on a ball
// of radius R a quadratic over a disc of radius r lies too far out by the order of r^4 / (48 R^3), everywhere the same
// way, while its slopes have no bias.
#include "mesh/clean/bandwidth.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/clean/local_frame.h"
#include "mesh/clean/local_quadratic.h"

namespace gonio::mesh {
namespace {

// Of the height and both slopes. A disc half as wide again has a slope whose sd is about half as large: by 1.25 sd on
// both sides the two may differ by 2.2 sd of their difference.
constexpr std::array<double, 3> gammas{2.0, 1.25, 1.25};
constexpr double misfit_sd = 6;  // by how many sd the residual's mean square may exceed the noise

double weight_of(const std::vector<double>& weights, std::uint32_t v) {
  return weights.empty() ? 1 : weights[v];
}

// The intervals of the height and both slopes so far.
class Compatible {
 public:
  bool still(const LocalQuadratic::Fit& fit, double variance, const std::array<double, 3>& inflation) {
    bool compatible = true;
    for (std::size_t i = 0; i < gammas.size(); ++i) {
      const double reach = gammas[i] * std::sqrt(variance * inflation[i] * fit.inverse[7 * i]);
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
  const LocalFrame frame(surface, face);
  const double variance = std::pow(noise.sigma_m / surface.edge_m, 2);
  LocalQuadratic quadratic;
  Compatible values;
  LocalSurface best;
  std::size_t added = 0;
  around.start(face);
  for (std::size_t r = 0; r < fit_radii.size(); ++r) {
    const double radius = fit_radii[r];
    const VertexNoise::Fitted& foretold = noise.fitted[r];
    around.grow(radius * surface.edge_m);
    const bool more = added < around.vertices().size();
    for (; added < around.vertices().size(); ++added) {
      const std::uint32_t v = around.vertices()[added];
      const LocalPlace at = frame.of(surface.positions_m[v]);
      quadratic.add(at.u, at.v, at.h, weight_of(weights, v));
    }
    if (!more && around.exhausted()) break;
    const auto fit = quadratic.fit();
    if (!fit.good || quadratic.points() < 8) continue;
    const double freedom = quadratic.points() - 6;
    const double limit =
        variance * (foretold.left + misfit_sd * foretold.left_sd * std::sqrt(foretold.freedom / freedom));
    const bool fits = values.still(fit, variance, foretold.inflation) && fit.residual / freedom <= limit;
    if (!fits && best.radius > 0) break;
    for (std::size_t i = 0; i < 6; ++i) best.c[i] = static_cast<float>(fit.c[i]);
    best.variance = static_cast<float>(fit.variance_of_height());
    best.radius = static_cast<float>(radius);
    if (!fits) break;
  }
  return best;
}

}  // namespace

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
  const LocalFrame frame(surface, face);
  const LocalPlace at = frame.of(p);
  const auto& c = local.c;
  const double u = at.u, v = at.v;
  const double h = c[0] + c[1] * u + c[2] * v + c[3] * u * u + c[4] * u * v + c[5] * v * v;
  const Vec3 slope{-(c[1] + 2 * c[3] * u + c[4] * v), -(c[2] + c[4] * u + 2 * c[5] * v), 1};
  return {frame.out(u, v, h), frame.direction(normalized(slope))};
}

}  // namespace gonio::mesh
