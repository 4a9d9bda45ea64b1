// The distribution of a relief's normals, and what microfacet roughness describes it.
//
// Slopes s = (dz/dx, dz/dy), x along a row, y up the picture, in the middle of each cell of four measured points; the
// normal is (-sx, -sy, 1) / sqrt(1 + s^2). With q = s' M^-1 s and M = R diag(alpha_u^2, alpha_v^2) R', R the turn by
// the azimuth from +x,
//   GGX       p(s) = 1 / (pi alpha_u alpha_v (1 + q)^2)         Walter et al. 2007; Student's t of two degrees of
//   freedom Beckmann  p(s) = exp(-q) / (pi alpha_u alpha_v)
// Maximum likelihood: M = <2 s s'> for Beckmann, M = <4 s s' / (1 + q)> for GGX, iterated (Lange, Little & Taylor
// 1989). Sigmas are those of the estimating equation (a sandwich: the inverse slope of <g(M)> = 0 about the variance of
// <g>), where the variance takes into account that slopes nearby are alike (areal.h). The tails of GGX have no
// variance, so that its M follows the middle of the slopes, Beckmann's their mean square. `log_likelihood` per slope
// says which fits: larger is better.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/height_map.h"

namespace gonio::relief {

struct SlopeFit {
  std::string distribution;                          // "ggx", "beckmann"
  double alpha_u = 0, alpha_v = 0, azimuth_rad = 0;  // alpha_u >= alpha_v; azimuth of u in (-pi / 2, pi / 2]
  double sigma_alpha_u = 0, sigma_alpha_v = 0, sigma_azimuth_rad = 0;
  double log_likelihood = 0;
  double density(double sx, double sy) const;  // p(s)
};
struct Normals {
  double reach = 0;            // of the histogram: slopes from -reach to reach along both axes
  int side = 0;                // cells along each
  std::vector<double> share;   // of the slopes in each cell, sy-major from the lowest; what lies beyond is not in it
  double beyond = 0;           // share of the slopes outside
  std::vector<SlopeFit> fits;  // the likelier first
  std::size_t slopes = 0;
};
Normals normals_of(const io::HeightMap& treated, int side = 65);

}  // namespace gonio::relief
