#include "render/subsurface_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "surface/hemisphere.h"

namespace gonio::render {
namespace {

struct Axes {  // of the probes
  std::array<Vec3, 3> along;
  std::array<double, 3> chance{0.7, 0.15, 0.15};
  explicit Axes(Vec3 normal) {
    const Basis basis(normal);
    along = {basis.n, basis.t, basis.b};
  }
};

double mean_density(const surface::Subsurface& beneath, double distance_m) {
  double mean = 0;
  for (int band = 0; band < 3; ++band) mean += beneath.distance_density(band, distance_m) / 3;
  return mean;
}

double density_per_area(const surface::Subsurface& beneath, const Axes& axes, Vec3 arm, Vec3 normal) {
  double density = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 axis = axes.along[k];
    const double distance_m = norm(arm - axis * dot(arm, axis));
    density += axes.chance[k] * std::abs(dot(normal, axis)) * mean_density(beneath, distance_m);
  }
  return density;
}

struct Chosen {
  std::size_t place = 0;
  double chance = 0;  // none of them is within the reach: 0
};
Chosen choose(const surface::Subsurface& beneath, Vec3 exit_m, const std::vector<SurfacePoint>& met, double u) {
  if (met.size() == 1) return {0, 1};
  const auto share = [&](const SurfacePoint& p) {
    return std::sqrt(mean_density(beneath, norm(p.position_m - exit_m)));
  };
  double sum = 0;
  for (const SurfacePoint& p : met) sum += share(p);
  double left = u * sum;
  Chosen chosen;
  for (std::size_t i = 0; i < met.size() && left >= 0; ++i) {
    const double here = share(met[i]);
    if (!(here > 0)) continue;
    chosen = {i, here / sum};
    left -= here;
  }
  return chosen;
}

}  // namespace

SurfacePoint on_side_of(const SurfacePoint& exit, const SurfacePoint& point) {
  return point.outside == exit.outside ? point : beyond(point);
}

std::optional<EntryPoint> draw_entry(const RayCaster& caster, const surface::Subsurface& beneath,
                                     const SurfacePoint& exit, Sampler& sampler) {
  const Axes axes(exit.geometric_normal);
  const Vec2 choice = sampler.two(), disc = sampler.two();
  const double which = sampler.uniform();
  const std::size_t k = choice.x < axes.chance[0] ? 0 : choice.x < axes.chance[0] + axes.chance[1] ? 1 : 2;
  const Basis probe(axes.along[k]);
  const double distance_m = beneath.sample_distance(std::min(2, static_cast<int>(3 * choice.y)), disc.x);
  const double phi = 2 * pi * disc.y, reach_m = beneath.reach_m();
  const double half_m = std::sqrt(std::max(0.0, (reach_m - distance_m) * (reach_m + distance_m)));
  const Vec3 origin_m =
      exit.position_m + (probe.t * std::cos(phi) + probe.b * std::sin(phi)) * distance_m + probe.n * half_m;
  const auto met = caster.crossings(exit.instance, origin_m, -probe.n, 2 * half_m);
  if (met.empty()) return {};
  const Chosen chosen = choose(beneath, exit.position_m, met, which);
  if (!(chosen.chance > 0)) return {};
  const SurfacePoint point = on_side_of(exit, met[chosen.place]);
  const double density = density_per_area(beneath, axes, point.position_m - exit.position_m, point.geometric_normal);
  if (!(density > 0)) return {};
  return EntryPoint{point, 1 / (chosen.chance * density)};
}

Rgb EntryModel::evaluate(const surface::Values& values, Vec3, Vec3 wi) const {
  if (wi.z <= 0) return {};
  const surface::Entrance entrance = beneath_.enter(values, wi, facet_);
  const surface::SubsurfaceEntry entry{entry_.point.position_m, entry_.point.normal, frame_.to_world(entrance.onwards)};
  return beneath_.evaluate(entry, exit_.position_m, exit_.normal) * (entrance.share * entry_.per_area);
}

surface::Sample EntryModel::sample(const surface::Values& values, Vec3 wo, Vec2 u, double) const {
  const Vec3 wi = surface::cosine_direction(u);
  if (wi.z <= 0) return {};
  return {wi, evaluate(values, wo, wi) * pi, surface::cosine_density(wi)};
}

double EntryModel::pdf(const surface::Values&, Vec3, Vec3 wi) const {
  return surface::cosine_density(wi);
}

}  // namespace gonio::render
