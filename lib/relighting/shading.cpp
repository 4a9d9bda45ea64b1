#include "relighting/shading.h"

#include <algorithm>
#include <cmath>

#include "light/mechanisms/light_inverse_square.h"
#include "light/mechanisms/light_lobe.h"
#include "light/turn.h"
#include "relighting/lamp_shadows.h"

namespace gonio::relighting {
namespace {

constexpr std::size_t radius_count = radii_m.size();
constexpr double grazing = 1e-3;  // mean directions of a patch are kept this far above its mean plane

Vec3 above_horizon(Vec3 w) {
  return w.z >= grazing ? w : normalized(Vec3{w.x, w.y, grazing});
}

// Direction to a light and its falloff at a point: 1 / d^2, or 1 for directional lights.
struct Aim {
  Vec3 wi;
  double falloff;
};
Aim aim(const LightSource& light, Vec3 point_m) {
  if (light.directional) {
    if (light.nearness_per_m == 0) return {light.direction, 1};
    const Vec3 to_light =
        equation::light_inverse_square_arm(light.nearness_per_m, light.direction, point_m - light.centre_m);
    const double square = dot(to_light, to_light);
    return {to_light / std::sqrt(square), 1 / square};
  }
  const Vec3 to_light = light.position_m - point_m;
  const double square = dot(to_light, to_light);
  return {to_light / std::sqrt(square), 1 / square};
}

// Lamps face the scene's centre, or beside it by the tilts of light.lobe.
Vec3 lobe_axis(Vec3 position_m, Vec3 centre_m, std::span<const double> lobe) {
  return light::turned_with(normalized(centre_m - position_m), position_m, lobe[mechanism::lobe_tilt_x],
                            lobe[mechanism::lobe_tilt_y], centre_m);
}

}  // namespace

RadiusWeights::RadiusWeights(double radius_m) {
  if (radius_m <= 0) return;
  const double r = std::min(radius_m, radii_m.back());
  std::size_t i = 0;
  while (i + 2 < radius_count && radii_m[i + 1] <= r) ++i;
  const double h = radii_m[i + 1] - radii_m[i], t = (r - radii_m[i]) / h, t2 = t * t, t3 = t2 * t;
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 2, radius_count - 1);
  first = before;
  count = after - before + 1;
  weight = {0, 0, 0, 0};
  const auto add = [&](std::size_t node, double w) { weight[node - before] += w; };
  const double slope0 = (t3 - 2 * t2 + t) * h / (radii_m[i + 1] - radii_m[before]);
  const double slope1 = (t3 - t2) * h / (radii_m[after] - radii_m[i]);
  add(i, 2 * t3 - 3 * t2 + 1 - slope1);
  add(i + 1, 3 * t2 - 2 * t3 + slope0);
  add(before, -slope0);
  add(after, slope1);
}

std::vector<float> facet_sums(const ViewCache& cache) {
  const std::size_t stride = cache.patches.empty() ? 0 : cache.direct.size() / cache.patches.size();
  std::vector<float> sums(cache.facets.size() * stride);
  for (std::size_t f = 0; f < cache.facets.size(); ++f)
    for (std::size_t k = 0; k < stride; ++k) {
      double sum = 0;
      for (std::size_t p = 0; p < cache.facets[f].patches; ++p) {
        const std::size_t patch = cache.facets[f].first_patch + p;
        sum += double{cache.patches[patch].weight} * cache.direct[patch * stride + k];
      }
      sums[f * stride + k] = static_cast<float>(sum);
    }
  return sums;
}

struct Shader::Lamp {
  std::size_t light;
  RadiusWeights radius;
  LightSource source;  // turned and moved
  bool turned;
  std::span<const double> profile;  // amounts of light.lobe, if any
  Vec3 axis;                        // away from the lamp
  double lobe(Vec3 wi) const { return profile.empty() ? 1 : equation::light_lobe(-dot(wi, axis), profile); }
};

std::vector<Shader::Lamp> Shader::lamps(const SceneState& state) const {
  std::vector<Lamp> all;
  for (const std::size_t l : image_.lights) {
    const LightState& light = state.lights[l];
    const bool moves = light.tilt_x_rad != 0 || light.tilt_y_rad != 0 || !(light.shift_m == Vec3{}) ||
                       light.nearness_per_m != 0 || !light.lobe.empty();
    Lamp lamp{l, RadiusWeights(light.radius_m), moved(layout_.lights[l], light, layout_.centre_m), moves, light.lobe,
              {}};
    if (!lamp.source.directional && !light.lobe.empty())
      lamp.axis = lobe_axis(lamp.source.position_m, layout_.centre_m, light.lobe);
    all.push_back(lamp);
  }
  return all;
}

// Of a lamp with a lobe: what it sends to where its light goes first that reaches the facet by way of others, over what
// it would send there if it shone all round. Directions to one surface are spread about their mean: a quarter of them
// along it, the rest around a cone that has their mean cosine.
double Shader::onward(const Lamp& lamp, std::size_t facet) const {
  if (lamp.profile.empty() || cache_.lit.empty()) return 1;
  constexpr int around = 6;
  constexpr double along = 0.25;
  const std::size_t surfaces = cache_.lit.size() / (4 * layout_.lights.size() * cache_.facets.size());
  const float* lit = &cache_.lit[(facet * layout_.lights.size() + lamp.light) * surfaces * 4];
  double all = 0, left = 0;
  for (std::size_t s = 0; s < surfaces; ++s, lit += 4) {
    const Vec3 sum{lit[0], lit[1], lit[2]};
    const double weight = lit[3], length = norm(sum);
    if (!(weight > 0) || !(length > 0)) continue;
    const Basis about(sum / length);
    const double cosine = std::clamp((length / weight - along) / (1 - along), -1.0, 1.0);
    const double sine = std::sqrt(1 - cosine * cosine);
    double share = along * lamp.lobe(-about.to_world({0, 0, 1}));
    for (int k = 0; k < around; ++k) {
      const double phi = 2 * pi * k / around;
      share += (1 - along) / around * lamp.lobe(-about.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine}));
    }
    all += weight, left += weight * share;
  }
  return all > 0 ? left / all : 1;
}

std::vector<double> Shader::onward(const SceneState& state, std::span<const std::uint32_t> picked) const {
  const std::vector<Lamp> on = lamps(state);
  std::vector<double> shares;
  if (std::ranges::all_of(on, [](const Lamp& lamp) { return lamp.profile.empty(); })) return shares;
  for (const std::uint32_t p : picked)
    for (std::size_t k = 0; k < cache_.pixels[p].facets; ++k)
      for (const Lamp& lamp : on) shares.push_back(onward(lamp, cache_.pixels[p].first_facet + k));
  return shares;
}

// The share of the lamp that is not hidden where it now stands, of a patch that sees `visible` of it where it stood.
double Shader::visible_now(const Lamp& lamp, std::size_t f, double visible) const {
  const std::int32_t table =
      cache_.shadow_table.empty() ? -1 : cache_.shadow_table[f * layout_.lights.size() + lamp.light];
  if (table < 0) return visible;
  const Vec3 at_m = cache_.patches[cache_.facets[f].first_patch].position_m;
  return visible_along(&cache_.shadows[static_cast<std::size_t>(table) * shadow_nodes],
                       aim(layout_.lights[lamp.light], at_m).wi, aim(lamp.source, at_m).wi, visible);
}

Scattered Shader::direct(const SurfaceState& surface, const Extremes& extremes, std::size_t f, const Lamp& lamp) const {
  const std::size_t lights = layout_.lights.size(), l = lamp.light;
  const bool lambertian = surface.lambertian();
  if (lambertian && !lamp.turned) {
    const double base = lamp.radius.of(&sums_[(f * lights + l) * radius_count]) / pi;
    return {{base, base, base}, {}};
  }
  const Facet& facet = cache_.facets[f];
  Scattered sum;
  for (std::size_t place = facet.first_patch; place < facet.first_patch + facet.patches; ++place) {
    const Patch& patch = cache_.patches[place];
    double irradiance = lamp.radius.of(&cache_.direct[(place * lights + l) * radius_count]);
    const Aim now = aim(lamp.source, patch.position_m);
    if (lamp.turned) {
      const Aim was = aim(layout_.lights[l], patch.position_m);
      const double open = std::max(0.0, dot(patch.normal, now.wi)) * now.falloff,
                   change = open - std::max(0.0, dot(patch.normal, was.wi)) * was.falloff;
      const double visible = cache_.visible[place * lights + l];
      const double moved = visible_now(lamp, f, visible) - visible;  // shadows go with the lamp
      irradiance = std::max(0.0, irradiance + visible * change + moved * open) * lamp.lobe(now.wi);
    }
    if (irradiance <= 0) continue;
    const double weighted = irradiance * patch.weight;
    if (lambertian) {
      sum.base += Rgb{1, 1, 1} * (weighted / pi);
      continue;
    }
    const Basis basis(patch.normal);
    const Vec3 wo = above_horizon(basis.to_local(patch.wo)), wi = above_horizon(basis.to_local(now.wi));
    const Scattered f_here =
        extremes.split([&](const surface::Values& v) { return surface.model->evaluate(v, wo, wi); });
    sum.base += f_here.base * weighted;
    sum.gloss += f_here.gloss * weighted;
  }
  return sum;
}

Scattered Shader::scattered(const SurfaceState& surface, const Facet& facet) const {
  if (surface.lambertian()) return {{1, 1, 1}, {}};
  return scattered_towards(surface, seen_from(facet));
}

Vec3 Shader::seen_from(const Facet& facet) const {
  const Patch& patch = cache_.patches[facet.first_patch];
  return above_horizon(Basis(patch.normal).to_local(patch.wo));
}

std::size_t Shader::facets_of(std::span<const std::uint32_t> picked) const {
  std::size_t facets = 0;
  for (const std::uint32_t p : picked) facets += cache_.pixels[p].facets;
  return facets;
}

Shading Shader::direct_alone(const SceneState& state, std::span<const std::uint32_t> picked) const {
  Shading shading;
  const std::vector<Lamp> on = lamps(state);
  shading.lights = on.size();
  shading.direct.resize(facets_of(picked) * shading.lights);
  for (std::uint32_t s = 0; s < state.surfaces.size(); ++s) again(state, picked, s, on, shading);
  return shading;
}

Shading Shader::operator()(const SceneState& state, std::span<const std::uint32_t> picked) const {
  Shading shading = direct_alone(state, picked);
  shading.indirect.resize(facets_of(picked));
  for (std::uint32_t s = 0; s < state.surfaces.size(); ++s) send_on_again(state, picked, s, shading);
  shading.onward = onward(state, picked);
  return shading;
}

void Shader::again(const SceneState& state, std::span<const std::uint32_t> picked, std::uint32_t surface,
                   Shading& shading) const {
  again(state, picked, surface, lamps(state), shading);
  send_on_again(state, picked, surface, shading);
}

void Shader::again(const SceneState& state, std::span<const std::uint32_t> picked, std::uint32_t surface,
                   std::span<const Lamp> on, Shading& shading) const {
  const SurfaceState& its = state.surfaces[surface];
  const Extremes extremes(its);
  std::size_t slot = 0;
  for (const std::uint32_t p : picked)
    for (std::size_t k = 0; k < cache_.pixels[p].facets; ++k, ++slot) {
      const std::size_t f = cache_.pixels[p].first_facet + k;
      if (cache_.facets[f].surface != surface) continue;
      for (std::size_t i = 0; i < on.size(); ++i)
        shading.direct[slot * on.size() + i] = direct(its, extremes, f, on[i]);
    }
}

void Shader::send_on_again(const SceneState& state, std::span<const std::uint32_t> picked, std::uint32_t surface,
                           Shading& shading) const {
  const SurfaceState& its = state.surfaces[surface];
  const bool lambertian = its.lambertian();
  const std::shared_ptr<const ScatteredBy> by_cosine = scattered_.of(its, picked.size());
  std::size_t slot = 0;
  for (const std::uint32_t p : picked)
    for (std::size_t k = 0; k < cache_.pixels[p].facets; ++k, ++slot) {
      const Facet& facet = cache_.facets[cache_.pixels[p].first_facet + k];
      if (facet.surface != surface) continue;
      shading.indirect[slot] = lambertian  ? Scattered{{1, 1, 1}, {}}
                               : by_cosine ? (*by_cosine)(seen_from(facet))
                                           : scattered_towards(its, seen_from(facet));
    }
}

}  // namespace gonio::relighting
