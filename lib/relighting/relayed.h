// Light by way of other surfaces, at one state of the scene.
//
// A facet's irradiance from a source of unit emission is a polynomial in the surfaces' albedos, colour by colour
// (light_cache.h): it costs a sum of some dozen terms for every facet and source, and depends on nothing but albedos.
// What scales a source (intensity, colour) multiplies it afterwards.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "relighting/light_cache.h"
#include "relighting/recordings.h"
#include "relighting/scene_state.h"

namespace gonio::relighting {

// The polynomials' monomials at the albedos of a state.
class Transport {
 public:
  Transport(const SceneState& state, const render::Monomials& monomials);
  std::size_t terms() const { return values_.size(); }
  // The constant term is what an ambient source sends straight: no light between surfaces.
  Rgb operator()(const float* coefficient) const;
  // All that it depends on.
  std::vector<double> key() const;

 private:
  double strength_;
  std::vector<Rgb> values_;
};

// Of the facets of picked pixels, in order, and of an image's lights, then of the ambient light where there is one:
// [facet][source], per unit emission.
struct Relayed {
  std::size_t sources = 0;
  std::vector<Rgb> irradiance;
  std::vector<Rgb> mirrored;  // as ViewCache::mirrored; empty unless asked for
};

// Sources of an image: places in the cache's tables.
std::vector<std::size_t> sources_of(const SceneState& state, const Recording& image);

// Appends one facet's.
void add_relayed(const ViewCache& cache, const Transport& transport, std::span<const std::size_t> sources,
                 std::size_t lights, bool mirrored, std::size_t facet, Relayed& light);
Relayed relayed(const ViewCache& cache, const Transport& transport, std::span<const std::size_t> sources,
                std::size_t lights, bool mirrored, std::span<const std::uint32_t> picked);

// Emission of an image's sources.
std::vector<Rgb> emission_of(const SceneState& state, const Recording& image);

}  // namespace gonio::relighting
