// Diffusion theory in one band of a homogeneous medium behind a smooth interface: what both dipoles are built from.
//   sigma_s' = (1 - g) sigma_s,  sigma_t' = sigma_s' + sigma_a,  alpha' = sigma_s' / sigma_t'
//   D = 1 / (3 sigma_t'),  sigma_tr = sqrt(sigma_a / D)
// Boundary: Fresnel moments C_1 = integral of F c dc, C_2 = integral of F c^2 dc over the cosine c in [0, 1] on the
// inside (d'Eon & Irving 2011, section 4; their fits are not used: the integrals are Gauss quadratures exact to 1e-10).
// By reversibility they are integrals over the outside, where nothing is reflected totally: c_in dc_in = c dc / eta^2.
//   C_phi = (1 - 2 C_1) / 4,  C_E = (1 - 3 C_2) / 2,  exitance M = C_phi fluence + C_E n.(-D grad fluence)
#pragma once
#include <utility>
#include <vector>

#include "geom/vector.h"

namespace gonio::surface {

struct InteriorFresnel {
  double c_phi = 0.25, c_e = 0.5;  // of eta = 1
  double transmits_in = 1;         // integral of T cos / pi from outside: 4 C_phi(1 / eta)
  explicit InteriorFresnel(double eta);
};

struct DipoleMedium {
  double sigma_t_reduced = 0, albedo_reduced = 0, diffusion_m = 0, sigma_tr = 0;  // 1/m, 1, m, 1/m
  double sigma_a = 0, sigma_s = 0, g = 0;
  DipoleMedium(double sigma_a_per_m, double sigma_s_per_m, double asymmetry);
  bool scatters() const { return albedo_reduced > 0; }
};

// Nodes and weights of Gauss & Legendre on [0, 1].
std::vector<std::pair<double, double>> gauss_legendre(int count);

}  // namespace gonio::surface
