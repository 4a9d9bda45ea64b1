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
  Rgb colour{0.5, 0.5, 0.5};  // matte, coated: albedo; metal: reflectance at normal incidence; translucent: the same
                              // that a dipole reflects diffusely, for light that falls in along the normal
  double sigma_rad = 0;       // matte, coated: slope angle of the facets
  double eta = 1.5;           // coated, glass, translucent: index of the interface, mean of the bands
  double alpha_x = 0, alpha_y = 0, azimuth_rad = 0;  // GGX roughness; 0: smooth
  bool beckmann = false;
  bool complex_index = false;  // metal by eta + i k, which formats may be able to say
  Rgb metal_eta, metal_k;
  surface::Medium medium;                          // glass, translucent: the inside
  Rgb diffuse_length_m;                            // translucent: 1 / sigma_tr
  std::map<std::string, const Texture*> textures;  // parameter -> texture, of those that a format may express
  bool rough() const { return alpha_x > 0 || alpha_y > 0; }
  double alpha() const { return std::sqrt(alpha_x * alpha_y); }
};

// `losses` gains what follows from the look being simpler than the surface. `pointer`: "/surfaces/id".
Look look_of(const Surface& surface, const std::string& pointer, std::vector<Loss>& losses);

// A roughness that reflects like Oren and Nayar's `sigma_rad`, as A (1 + ratio s / t): see look.cpp.
struct RoughMatte {
  double scale = 1;  // A
  double ratio = 0;  // B / A
};
RoughMatte rough_matte(double sigma_rad);

// Share of diffuse light that an interface of index eta throws back into the denser side.
double mean_internal_reflectance(double eta);

}  // namespace gonio::scene
