// surface.fluorescence in three bands: what the shortest band brings returns in the two longer ones,
//   radiance_c += emission E_blue exp(-(wavelength_c - emission_centre_m)^2 / (2 emission_width_m^2)) / pi,  c red,
//   green
// a triangular re-radiation matrix (Donaldson 1954), E_blue the irradiance by lamps and surroundings, whatever the
// albedo. Under lamps of one colour it is a change of the albedo, and not asked for. Two numbers can be had of two
// bands: the width is the declaration's. Where a pixel shows a matte surface alone, its own blue tells E_blue, light by
// way of surfaces included; elsewhere lamps and open sky alone excite.
#include "surface/mechanisms/surface_fluorescence.h"

#include <algorithm>
#include <cmath>

#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

// Dominant wavelengths of the primaries of Rec. 709, m.
constexpr double red_m = 611.4e-9, green_m = 549.1e-9;

// Does blue bring more under one lamp than under another, for what green or red brings?
bool colours_differ(const Setting& s) {
  constexpr double least = 0.02;
  Rgb low{1e30, 1e30, 1e30}, high{0, 0, 0};
  for (const LightState& light : s.layout.start.lights) {
    const Rgb i = light.intensity;
    const Rgb excites{i.x > 0 ? i.z / i.x : 0, i.y > 0 ? i.z / i.y : 0, 0};
    low = {std::min(low.x, excites.x), std::min(low.y, excites.y), 0};
    high = {std::max(high.x, excites.x), std::max(high.y, excites.y), 0};
  }
  return high.x > (1 + least) * low.x || high.y > (1 + least) * low.y;
}

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  if (!colours_differ(s)) return uses;
  for (std::size_t k = 0; k < s.layout.surfaces.size(); ++k) {
    if (!has_parameter(*s.layout.start.surfaces[k].model, "albedo") ||
        switched_on(s.document, mechanism::surface_fluorescence().id, s.layout.surfaces[k]))
      continue;
    Use use = target_use(mechanism::surface_fluorescence(), {s.layout.surfaces[k]}, {k}, false);
    Number &centre = use.numbers[1], &width = use.numbers[2];
    centre = {0.5 * (red_m + green_m), 0.5 * (red_m + green_m), 4.8e-7, 6.8e-7};
    width.neutral = width.start;  // without emission neither counts
    width.free = false;
    uses.push_back(use);
  }
  return uses;
}

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const std::span<const double> a = use.amounts(frame.state);
  if (a[0] == 0) return;
  const auto band = [&](double wavelength_m) { return equation::surface_fluorescence(a[0], a[1], a[2], wavelength_m); };
  const Rgb sent{band(red_m), band(green_m), 0};
  const SurfaceState& surface = frame.state.surfaces[use.targets[0]];
  const Rgb albedo = surface.values.rgb(parameter_index(*surface.model, "albedo"));
  const bool matte = surface.lambertian() && albedo.z > 0;
  const std::size_t lights = frame.model.layout().lights.size(), terms = frame.model.monomials().size();
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    if (matte && pixel.facets == 1 && pixel.sky == 0) {
      if (frame.cache.facets[pixel.first_facet].surface != use.targets[0]) continue;
      const double irradiance = pi * radiance[3 * i + 2] / albedo.z;
      for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] += sent[static_cast<int>(c)] * irradiance;
      continue;
    }
    double exciting = 0;
    for (std::size_t k = 0; k < pixel.facets; ++k) {
      const std::size_t f = pixel.first_facet + k;
      const Facet& facet = frame.cache.facets[f];
      if (facet.surface != use.targets[0]) continue;
      double sum = frame.cache.indirect[(f * (lights + 1) + lights) * terms] * frame.state.ambient.z;
      for (const std::size_t l : frame.image.lights)
        sum += frame.model.small_light(frame.image.view, f, l) * frame.state.lights[l].intensity.z;
      exciting += facet.weight * sum;
    }
    if (exciting == 0) continue;
    const Rgb more = sent * exposure_of(frame.state, frame.image, frame.number, pixel) * exciting;
    for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] += more[static_cast<int>(c)];
  }
}

}  // namespace

const Term& surface_fluorescence() {
  static const Term term{
      .mechanism = mechanism::surface_fluorescence,
      .reach = Reach::add,
      .candidates = candidates,
      .add = add,
  };
  return term;
}

}  // namespace gonio::relighting::terms
