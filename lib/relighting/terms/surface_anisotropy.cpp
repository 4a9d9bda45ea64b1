// surface.anisotropy of surfaces that have a gloss already: what direct light changes by where the lobe gets a
// direction (surface/gloss_lobes.h), evaluated in the frame of the surface's tangent, of which the cache knows nothing:
// it is looked up once for every patch. Light by way of surfaces is left as it is, and lamps stand where the base model
// has them.
#include <cmath>

#include "base/parallel.h"
#include "relighting/image_model.h"
#include "relighting/surface_rule.h"
#include "relighting/uses.h"
#include "render/vertex.h"

namespace gonio::mechanism {
const Mechanism& surface_anisotropy();
}

namespace gonio::relighting::terms {
namespace {

struct Tangents final : Prepared {
  std::vector<std::vector<Vec3>> of;  // [view][patch]; zero where none was found
};

// What is met a little before the surface is the surface itself.
Vec3 tangent_at(const Setting& s, const Patch& patch) {
  const double before_m = 1e-3 * norm(patch.position_m - s.layout.centre_m) + 1e-5;
  const auto met = s.caster.closest(patch.position_m + patch.wo * before_m, -patch.wo);
  return met && met->distance_m < 3 * before_m ? render::shading_frame(*met).t : Vec3{};
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  auto result = std::make_shared<Tangents>();
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const ViewCache& cache = s.model.cache(v);
    std::vector<Vec3> tangents(cache.patches.size());
    parallel_for(
        0, cache.facets.size(),
        [&](std::size_t f) {
          const Facet& facet = cache.facets[f];
          if (facet.surface != use.targets[0]) return;
          for (std::size_t p = facet.first_patch; p < facet.first_patch + facet.patches; ++p)
            tangents[p] = tangent_at(s, cache.patches[p]);
        },
        64);
    result->of.push_back(std::move(tangents));
  }
  return result;
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  const mechanism::Mechanism& m = mechanism::surface_anisotropy();
  for (std::size_t k = 0; k < s.layout.surfaces.size(); ++k) {
    const SurfaceState& surface = s.layout.start.surfaces[k];
    if (surface.lambertian() || switched_on(s.document, m.id, s.layout.surfaces[k])) continue;
    const surface::Model* model = widened(surface, m);
    if (!model) continue;
    const auto stands = [&](const char* name) {
      return has_parameter(*surface.model, name) && surface.values.scalar(parameter_index(*surface.model, name)) != 0;
    };
    if (stands("anisotropy_0") || stands("anisotropy_45")) continue;
    uses.push_back(target_use(m, {s.layout.surfaces[k]}, {k}, false));
  }
  return uses;
}

// The surface with and without a direction, each with a black and a white base.
struct Pair {
  const surface::Model* model = nullptr;
  surface::Values plain_black, plain_white, black, white;
  bool has_base = false;
  Pair(SurfaceState surface, std::span<const double> amounts) {
    widen(surface, *widened(surface, mechanism::surface_anisotropy()));
    model = surface.model;
    has_base = has_parameter(*model, "albedo");
    plain_black = plain_white = surface.values;
    if (has_base) {
      const std::size_t albedo = parameter_index(*model, "albedo");
      plain_black.v[albedo] = {0, 0, 0};
      plain_white.v[albedo] = {1, 1, 1};
    }
    black = turned(plain_black, amounts);
    white = turned(plain_white, amounts);
  }
  surface::Values turned(surface::Values values, std::span<const double> amounts) const {
    values.v[parameter_index(*model, "anisotropy_0")] = {amounts[0], amounts[0], amounts[0]};
    values.v[parameter_index(*model, "anisotropy_45")] = {amounts[1], amounts[1], amounts[1]};
    return values;
  }
  Scattered change(Vec3 wo, Vec3 wi) const {
    const Rgb gloss = model->evaluate(black, wo, wi) - model->evaluate(plain_black, wo, wi);
    if (!has_base) return {{}, gloss};
    return {model->evaluate(white, wo, wi) - model->evaluate(plain_white, wo, wi) - gloss, gloss};
  }
};

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const auto& tangents = static_cast<const Tangents&>(*use.prepared).of[frame.image.view];
  const SceneLayout& layout = frame.model.layout();
  if (!widened(frame.state.surfaces[use.targets[0]], *use.mechanism)) return;
  const Pair pair(frame.state.surfaces[use.targets[0]], use.amounts(frame.state));
  std::vector<RadiusWeights> radii;
  for (const std::size_t l : frame.image.lights) radii.emplace_back(frame.state.lights[l].radius_m);
  const auto add_facet = [&](std::size_t f, Scattered* direct) {
    const Facet& facet = frame.cache.facets[f];
    for (std::size_t place = facet.first_patch; place < facet.first_patch + facet.patches; ++place) {
      const Patch& patch = frame.cache.patches[place];
      const Vec3 along = tangents[place] - patch.normal * dot(tangents[place], patch.normal);
      if (!(norm(along) > 1e-6)) continue;
      const Basis basis(patch.normal, normalized(along));
      const Vec3 wo = basis.to_local(patch.wo);
      for (std::size_t j = 0; j < shading.lights; ++j) {
        const LightSource& light = layout.lights[frame.image.lights[j]];
        const Vec3 towards = light.directional ? light.direction : normalized(light.position_m - patch.position_m);
        const Vec3 wi = basis.to_local(towards);
        const double irradiance =
            radii[j].of(&frame.cache.direct[(place * layout.lights.size() + frame.image.lights[j]) * radii_m.size()]);
        if (!(irradiance > 0 && wi.z > 0 && wo.z > 0)) continue;
        const Scattered change = pair.change(wo, wi);
        direct[j].base += change.base * (irradiance * patch.weight);
        direct[j].gloss += change.gloss * (irradiance * patch.weight);
      }
    }
  };
  std::size_t slot = 0;
  for (const std::uint32_t p : frame.picked)
    for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
      const std::size_t f = frame.cache.pixels[p].first_facet + k;
      if (frame.cache.facets[f].surface == use.targets[0]) add_facet(f, &shading.direct[slot * shading.lights]);
    }
}

}  // namespace

const Term& surface_anisotropy() {
  static const Term term{
      .mechanism = mechanism::surface_anisotropy,
      .reach = Reach::shade,
      .order = -10,
      .candidates = candidates,
      .prepare = prepare,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
