// The errors of a surface's vertices along its normals: how large they are, over what distance they are alike, and what
// that does to the quadratics that are fitted to them.
//
// Errors are a part of each vertex' own and a part that neighbours share, because their edges were read from the same
// voxels: means over discs of one diameter, whose correlation is the share that two discs have in common,
//   C(d) / sigma^2 = (1 - shared) [d = 0] + shared k(d / reach),   k(t) = 2 / pi (acos t - t sqrt(1 - t^2)).
// A quadratic over a disc that is not much wider than `reach` takes most of the shared part for shape: what it leaves
// is too small, and its slope errs by more than independent errors of that size would make it. Both are traces of C,
//   E[r'r] = tr (I - H) C,  H = B A^-1 B', A = B'B;   cov(c) = A^-1 B'CB A^-1   (generalised least squares' sandwich)
// and so the two parts can be told from what is left, and the slopes' errors be stated for every width.
#pragma once
#include <array>
#include <vector>

#include "mesh/clean/neighbourhood.h"

namespace gonio::mesh {

constexpr std::array<double, 7> fit_radii{1.5, 2.0, 2.7, 3.6, 4.8, 6.4, 8.5};  // mean edges

struct VertexNoise {
  double sigma_m = 0;
  double shared = 0;   // of the variance
  double reach_m = 0;  // beyond it no error is shared
  // Of a quadratic over each of fit_radii, for sigma 1: the degrees of freedom that are left (points less six), the
  // mean square of what is left over them, the sd of that, and by how much height and both slopes vary more than with
  // independent errors.
  struct Fitted {
    double freedom = 1, left = 1, left_sd = 0;
    std::array<double, 3> inflation{1, 1, 1};
  };
  std::array<Fitted, fit_radii.size()> fitted{};
  double inflation() const { return fitted.back().inflation[0]; }  // of means over many
};

// What who measured the vertices says of their errors; 0: nothing.
struct StatedNoise {
  double sigma_m = 0;  // of a vertex of weight 1
  double alike_m = 0;  // distance over which errors are shared
};
// `weights`: of the vertices, inversely as their variances, or none.
VertexNoise noise_of(const NoisySurface& surface, const std::vector<double>& weights, const StatedNoise& stated);

}  // namespace gonio::mesh
