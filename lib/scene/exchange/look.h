// A surface in the few terms that other renderers share. Models are recognised by what they state (transmits(),
// subsurface(), names of parameters), not by their ids; what has no counterpart becomes a matte of the same albedo, and
// says so.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "scene/exchange/exchange.h"

namespace gonio::scene {

struct Look {
  enum class Kind { matte, coated, metal, glass, translucent };
  Kind kind = Kind::matte;
  Rgb colour{0.5, 0.5, 0.5};  // matte, coated: albedo; metal: reflectance at normal incidence; translucent: what
                              // comes back of the light that enters
  double sigma_rad = 0;       // matte, coated: slope angle of the facets
  double eta = 1.5;           // coated, glass, translucent: index of the interface, mean of the bands
  double alpha_x = 0, alpha_y = 0, azimuth_rad = 0;  // GGX roughness; 0: smooth
  bool beckmann = false;
  bool own_albedo = false;  // coated: textures of `albedo` hold the base's own, not that seen through the interface
  double coat_eta = 0, coat_alpha = 0;  // metal: of a clear coat over it; 0: none
  bool complex_index = false;           // metal by eta + i k, which formats may be able to say
  Rgb metal_eta, metal_k;
  surface::Medium medium;                          // glass, translucent: the inside
  Rgb diffuse_length_m;                            // translucent: 1 / sigma_tr
  std::map<std::string, const Texture*> textures;  // parameter -> texture, of those that a format may express
  bool rough() const { return alpha_x > 0 || alpha_y > 0; }
  double alpha() const { return std::sqrt(alpha_x * alpha_y); }
};

// `losses` gains what follows from the look being simpler than the surface.
Look look_of(const Appearance& appearance, const Surface& surface, std::vector<Loss>& losses);

// One number for three bands: their own where they agree, else their mean.
inline double level(Rgb v) {
  return v.x == v.y && v.y == v.z ? v.x : mean(v);
}

// A roughness that reflects like Oren and Nayar's `sigma_rad`, as A (1 + ratio s / t): see look.cpp.
struct RoughMatte {
  double scale = 1;  // A
  double ratio = 0;  // B / A
};
RoughMatte rough_matte(double sigma_rad);

// Share of diffuse light that an interface of index eta throws back into the denser side.
double mean_internal_reflectance(double eta);
// Albedo of a matte seen through an interface that throws back `inside` of its light, and the reverse.
inline double albedo_through(double own, double inside) {
  return own * (1 - inside) / (1 - own * inside);
}
inline double albedo_beneath(double seen, double inside) {
  return seen / (1 - inside + seen * inside);
}
inline Rgb albedo_through(Rgb own, double inside) {
  return {albedo_through(own.x, inside), albedo_through(own.y, inside), albedo_through(own.z, inside)};
}
inline Rgb albedo_beneath(Rgb seen, double inside) {
  return {albedo_beneath(seen.x, inside), albedo_beneath(seen.y, inside), albedo_beneath(seen.z, inside)};
}

}  // namespace gonio::scene
