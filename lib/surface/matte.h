// Matte reflection in the forms that have been published, by one number, the facets' slope sigma, rad. With
// a = max(theta_i, theta_o), b = min(theta_i, theta_o), c = cos(phi_i - phi_o), s = sigma^2, rho the albedo:
//
//   form 0   Oren & Nayar 1994, equation 30, their qualitative model: surface/oren_nayar.h
//   form 1   their functional one, equations 27 and 28. It follows V-grooves within some per cent where equation 30
//            leaves out what lies opposite to the lamp; light that two facets have sent on goes with rho^2:
//            pi f = rho [C1 + c C2 tan b + (1 - |c|) C3 tan((a + b) / 2)]
//                   + 0.17 rho^2 s / (s + 0.13) (1 - c (2 b / pi)^2),   C1 = 1 - 0.5 s / (s + 0.33),
//            C2 = 0.45 s / (s + 0.09) (sin a - [c < 0] (2 b / pi)^3),   C3 = 0.125 s / (s + 0.09) (4 a b / pi^2)^2
//   form 2   Fujii 2012, "improved", which Cycles' Diffuse BSDF has; sigma is its roughness, 0 to 1:
//            pi f = rho (1 + sigma t) / (1 + (1 / 2 - 2 / (3 pi)) sigma),   q = wi.wo - wiz woz,
//            t = q / max(wiz, woz) where q > 0, else q
//
// All are Lambert's law at sigma = 0, reciprocal, and none is below 0. The functional one returns up to 4.8 % more than
// it receives of a white surface (sigma = 0.3): by what a surface would return beyond its albedo it is divided.
#pragma once
#include "geom/vector.h"
#include "manifest/model.h"
#include "surface/oren_nayar.h"

namespace gonio::surface {

// The parameter of models that tells the forms apart.
inline manifest::ParameterInfo matte_form_parameter() {
  return {.name = "matte_form",
          .unit = "1",
          .preset = 0,
          .lower = 0,
          .upper = 2,
          .meaning =
              "law of the rough base: 0 Oren & Nayar's qualitative one, 1 their full one with light between the "
              "facets, 2 Fujii's (Blender's); without effect where sigma_rad is 0"};
}

class Matte {
 public:
  Matte(double sigma_rad, double form);
  // A base times its albedo, in 1/sr, and pi times that. Directions above the horizon.
  Rgb brdf(Rgb albedo, Vec3 wo, Vec3 wi) const;
  Rgb weight(Rgb albedo, Vec3 wo, Vec3 wi) const;
  // Directional-hemispherical reflectance; of form 1 from a table, to 2e-3.
  Rgb reflectance(Rgb albedo, double cosine) const;
  // Does it grow in proportion to the albedo?
  bool proportional() const { return form_ != 1; }
  bool has_slopes() const { return form_ == 0; }  // surface/oren_nayar.h has them in closed form

 private:
  Rgb other_weight(Rgb albedo, Vec3 wo, Vec3 wi) const;
  double sigma_;
  int form_;
  OrenNayar qualitative_;
};

}  // namespace gonio::surface
