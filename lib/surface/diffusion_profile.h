// The normalised diffusion profile of Christensen & Burley, "Approximate reflectance profiles for efficient subsurface
// scattering" (2015): how light that enters a translucent half space at a point is spread over where it leaves.
//   R(r) = A s (exp(-s r / l) + exp(-s r / (3 l))) / (8 pi l r)
//   s = 3.5 + 100 (A - 0.33)^4             A the albedo
// l is the diffuse mean free path, 1 / sqrt(3 sigma_a sigma_t'), after which diffuse light has fallen to 1 / e: what
// renderers call the radius of scattering. r is the distance on the surface, m. The plane's integral of R is A.
#pragma once
#include <cmath>

namespace gonio::surface {

inline double diffusion_scale(double albedo) {
  const double square = (albedo - 0.33) * (albedo - 0.33);
  return 3.5 + 100 * square * square;
}

// Share of what leaves that does so within r of where it entered; 1 for l = 0.
inline double diffusion_within(double r_m, double mean_free_path_m, double albedo) {
  if (mean_free_path_m <= 0) return 1;
  const double x = diffusion_scale(albedo) * r_m / mean_free_path_m;
  return 1 - 0.25 * std::exp(-x) - 0.75 * std::exp(-x / 3);
}

}  // namespace gonio::surface
