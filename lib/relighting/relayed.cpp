#include "relighting/relayed.h"

#include <array>
#include <cmath>

namespace gonio::relighting {

Transport::Transport(const SceneState& state, const render::Monomials& monomials) : strength_(state.indirect) {
  const Vec3 oblique{std::sqrt(0.5), 0, std::sqrt(0.5)};
  std::vector<Rgb> albedos;
  for (const SurfaceState& s : state.surfaces)  // what lets light through does not spread it
    albedos.push_back(s.model->transmits() ? Rgb{} : s.model->albedo(s.values, oblique));
  std::array<std::vector<double>, 3> values;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> albedo;
    for (const Rgb& a : albedos) albedo.push_back(a[k]);
    values[static_cast<std::size_t>(k)] = monomials.evaluate(albedo);
  }
  for (std::size_t m = 0; m < monomials.size(); ++m) values_.push_back({values[0][m], values[1][m], values[2][m]});
}

Rgb Transport::operator()(const float* coefficient) const {
  Rgb sum;
  for (std::size_t m = 1; m < values_.size(); ++m) sum += values_[m] * double{coefficient[m]};
  return sum * strength_ + Rgb{coefficient[0], coefficient[0], coefficient[0]};
}

std::vector<double> Transport::key() const {
  std::vector<double> key{strength_};
  for (const Rgb& v : values_) key.insert(key.end(), {v.x, v.y, v.z});
  return key;
}

std::vector<std::size_t> sources_of(const SceneState& state, const Recording& image) {
  std::vector<std::size_t> sources(image.lights.begin(), image.lights.end());
  if (max_component(state.ambient) > 0) sources.push_back(state.lights.size());
  return sources;
}

std::vector<Rgb> emission_of(const SceneState& state, const Recording& image) {
  std::vector<Rgb> emission;
  for (const std::size_t l : image.lights) emission.push_back(state.lights[l].intensity);
  if (max_component(state.ambient) > 0) emission.push_back(state.ambient);
  return emission;
}

void add_relayed(const ViewCache& cache, const Transport& transport, std::span<const std::size_t> sources,
                 std::size_t lights, bool mirrored, std::size_t facet, Relayed& light) {
  for (const std::size_t source : sources) {
    const std::size_t first = (facet * (lights + 1) + source) * transport.terms();
    light.irradiance.push_back(transport(&cache.indirect[first]));
    if (mirrored) light.mirrored.push_back(transport(&cache.mirrored[first]));
  }
}

Relayed relayed(const ViewCache& cache, const Transport& transport, std::span<const std::size_t> sources,
                std::size_t lights, bool mirrored, std::span<const std::uint32_t> picked) {
  Relayed light{sources.size(), {}, {}};
  for (const std::uint32_t p : picked)
    for (std::size_t k = 0; k < cache.pixels[p].facets; ++k)
      add_relayed(cache, transport, sources, lights, mirrored, cache.pixels[p].first_facet + k, light);
  return light;
}

}  // namespace gonio::relighting
