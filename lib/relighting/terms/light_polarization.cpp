// light.polarization on cached geometry: each lamp's direct light times 1 + m01 s1 + m02 s2 of the surface's Mueller
// matrix (surface/surface.h), at one direction for a facet. Light by way of surfaces counts as unpolarized. Surfaces
// without an interface lose it all: the question is put where at least one has an interface.
#include <algorithm>

#include "light/polarized_emitter.h"
#include "optics/mueller_algebra.h"
#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_polarization();
}

namespace gonio::relighting::terms {
namespace {

Vec3 towards(const LightSource& light, Vec3 from_m) {
  return light.directional ? light.direction : normalized(light.position_m - from_m);
}

std::vector<Use> candidates(const Setting& s) {
  if (std::ranges::all_of(s.layout.start.surfaces, [](const SurfaceState& surface) { return surface.lambertian(); }))
    return {};
  std::optional<Use> use = lamps_use(s, mechanism::light_polarization(), false, [](const Setting& here, std::size_t l) {
    const LightSource& light = here.layout.lights[l];
    return light.directional || !(light.position_m == here.layout.centre_m);
  });
  if (!use) return {};
  for (std::size_t i = 0; i < use->numbers.size(); ++i)
    use->numbers[i].groups = lit_by(s.recordings, use->targets[i / use->mechanism->parameters.size()]);
  return {*use};
}

Rgb factor(const SurfaceState& surface, const Patch& patch, Vec3 to_light, const light::Sheet& sheet) {
  const Basis frame(patch.normal);
  const Vec3 wo = frame.to_local(patch.wo), wi = frame.to_local(to_light);
  if (!(wo.z > 0 && wi.z > 0)) return {1, 1, 1};
  const Vec3 axis = frame.to_world(optics::scattering_axis(wi, wo));
  const light::Polarization sent = sheet.of(-to_light);
  const optics::Stokes here = optics::frame_change(-to_light, sent.x, axis) * sent.stokes;
  const optics::MuellerRgb matrix = surface.model->mueller(surface.values, wo, wi);
  const auto received = [&](std::size_t band) {
    return 1 + matrix[band](0, 1) * here.s[1] + matrix[band](0, 2) * here.s[2];
  };
  return {received(0), received(1), received(2)};
}

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const SceneLayout& layout = frame.model.layout();
  for (std::size_t t = 0; t < use.targets.size(); ++t) {
    const auto on = std::find(frame.image.lights.begin(), frame.image.lights.end(), use.targets[t]);
    const std::span<const double> degrees = use.amounts(frame.state, t);
    if (on == frame.image.lights.end() || (degrees[0] == 0 && degrees[1] == 0)) continue;
    const auto j = static_cast<std::size_t>(on - frame.image.lights.begin());
    const LightSource& light = layout.lights[use.targets[t]];
    const light::Sheet sheet = light::Sheet::before(towards(light, layout.centre_m), degrees[0], degrees[1]);
    std::size_t slot = 0;
    for (const std::uint32_t p : frame.picked)
      for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
        const Facet& facet = frame.cache.facets[frame.cache.pixels[p].first_facet + k];
        const SurfaceState& surface = frame.state.surfaces[facet.surface];
        if (surface.lambertian()) continue;
        const Patch& patch = frame.cache.patches[facet.first_patch + facet.patches / 2];
        Scattered& direct = shading.direct[slot * shading.lights + j];
        const Rgb by = factor(surface, patch, towards(light, patch.position_m), sheet);
        direct.base *= by;
        direct.gloss *= by;
      }
  }
}

}  // namespace

const Term& light_polarization() {
  static const Term term{
      .mechanism = mechanism::light_polarization,
      .reach = Reach::shade,
      .candidates = candidates,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
