// What geometry decides about the recordings, computed once: which surfaces the sampled pixels see, how much of every
// light reaches them directly, and how light travels between surfaces. A prediction for any albedos, intensities,
// surface terms, sizes and small turns of the lights then costs microseconds a pixel.
//
//   pixel  a sampled pixel of one view; `sky` is the share of it that sees no surface
//   facet  the part of a pixel that shows one surface
//   patch  the part of a facet in one of 4 x 4 equal squares of the pixel, of fewer where the normal hardly turns: mean
//          position, normal and direction to the eye (unit vectors, world frame, metres). Glossy terms are evaluated
//          per patch.
//
// Direct light: per patch and light the mean of V cos(theta) / d^2 over its sub-samples (1/m^2; directional lights: V
// cos), which times the intensity is the irradiance, for a list of radii of the light: exact for small lights (radius
// 0), and for spheres of that radius with the same intensity. A sphere that stands wholly above the horizon and
// unhidden gives the irradiance of the small light exactly (Lambert 1760), so only penumbrae and terminators are
// integrated.
//
// Indirect light: per facet and source a polynomial in the albedos of the surfaces (render/geometry_cache.h), from
// diffuse paths; the constant term of the ambient source is the visible sky. `mirrored` is the same for what arrives
// from about the mirror direction. Paths that are glossy twice are left out. `indirect_sigma` is the Monte Carlo error
// at albedo 1/2. `lit` says where the light went first that comes by way of others, for lamps that do not shine all
// round: of each surface that it met first the sum of the unit directions from the lamp, weighted by what arrives at
// albedo 1/2, and of the weights.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "relighting/recordings.h"
#include "render/geometry_cache.h"

namespace gonio::relighting {

inline constexpr std::array<double, 11> radii_m = {0,     0.003, 0.006, 0.012, 0.018, 0.025,
                                                   0.033, 0.042, 0.052, 0.064, 0.08};

struct LightSource {
  bool directional = false;
  Vec3 position_m;  // small and spherical lights
  Vec3 direction;   // directional lights: unit, from the scene to the light
  // A directional light that is near after all stands at 1 / nearness from the centre (light.inverse-square).
  Vec3 centre_m;
  double nearness_per_m = 0;
};

struct Patch {
  float weight = 0;  // share of the pixel
  Vec3 position_m, normal, wo;
};
struct Facet {
  std::uint32_t surface = 0;
  float weight = 0;  // share of the pixel
  std::uint32_t first_patch = 0, patches = 0;
  Rgb tint{1, 1, 1};     // of a textured surface: its albedo here over the texture's mean (relighting/textures.h)
  float tint_sigma = 0;  // one standard deviation of it, of the most uncertain channel
};
struct Pixel {
  int x = 0, y = 0;
  float sky = 0;  // share that sees no surface
  std::uint32_t first_facet = 0, facets = 0;
};

// Sources are the lights in their order, then the ambient light.
struct ViewCache {
  std::vector<Pixel> pixels;
  std::vector<Facet> facets;
  std::vector<Patch> patches;
  std::vector<float> direct;   // [patch][light][radius]
  std::vector<float> visible;  // [patch][light]: share of the small light that is not hidden
  // Of lamps that stand elsewhere: relighting/lamp_shadows.h; empty: none were cast.
  std::vector<std::int32_t> shadow_table;  // [facet][light]: which table; -1: nothing changes
  std::vector<std::uint8_t> shadows;       // [table][node]
  std::vector<float> indirect;             // [facet][source][monomial]
  std::vector<float> mirrored;  // [facet][source][monomial]: pi times the mean radiance about the mirror direction
  std::vector<float> lit;       // [facet][light][surface]: x, y, z, weight; directional lights: zeros
  std::vector<float> indirect_sigma;  // [facet][source]
  std::vector<float> direct_sigma;    // [facet][light]: error of the mean over the sub-samples
  std::vector<float>
      margin;  // [facet][light]: angle from the light to the nearest edge that hides it, rad; NaN: none near
};

struct CacheOptions {
  int samples = 8;        // sub-samples of a pixel, along each side
  int paths = 512;        // a facet; 0: no light by way of surfaces, whose tables stay empty
  int patches = 4;        // of a pixel, along each side; fewer where the normal hardly turns
  bool penumbrae = true;  // false: small lights only, at every radius
  bool shadows = false;   // of lamps that stand elsewhere
  // Sub-samples are moved by this far at least and at most, evenly over that ring of the picture: what lies about a
  // pixel.
  double inner_px = 0, outer_px = 0;
  std::uint64_t seed = 1;
};

// `chosen`: (x, y) of the pixels to compute.
ViewCache build_cache(const render::RayCaster& caster, const View& view, std::span<const LightSource> lights,
                      const render::Monomials& monomials, std::span<const std::array<int, 2>> chosen,
                      const CacheOptions& options);

}  // namespace gonio::relighting
