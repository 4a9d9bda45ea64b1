// Fits of the MERL materials that two papers published, as "measured-like" materials for tests and studies. No program
// needs them. Rows: brdf/merl-published-fits (DATA/README.md).
//
// Both are matte plus one microfacet lobe, f = k_d / pi + F D G / (pi cos_i cos_o), c = cos theta_h, t = tan theta_h:
//
// Bagher, Soler & Holzschuch 2012, "Accurate fitting of measured reflectances using a shifted gamma micro-facet
// distribution": D = rho_s P(t^2) / (pi c^4), P(x) = kap exp(-u) / u^p with u = alpha + x / alpha. 2 pi times the
// integral of P(t^2) / (pi c^4) cos sin d theta is the integral of P over x, 1 for kap = 1 / (alpha Gamma(1 - p,
// alpha)); a test holds the tabulated kap to that, and with it the reading of u. F = f0 - f1 cos_d + (1 - f0) (1 -
// cos_d)^5, their extension of Schlick's. G = G1(theta_i) G1(theta_o), G1 = 1 + lambda (1 - exp(c (theta -
// theta_0)^k)) beyond theta_0. F and G1 are clamped to >= 0 and G1 to <= 1: the formulas leave the range far from what
// was fitted.
//
// Low, Kronander, Ynnerman & Unger 2012, "BRDF models for accurate and efficient rendering of glossy surfaces",
// section 4: D = A / (1 + B (1 - c))^C, F that of a dielectric of index ior, G that of V-grooves (Cook & Torrance
// 1982).
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "goniometry/basis/basis.h"

namespace gonio::tests {

struct BagherChannel {
  double rho_d, rho_s, alpha, p, f0, f1, kap, lambda, c, k, theta_0;
  double evaluate(Vec3 wo, Vec3 wi) const;
};
struct BagherFit {
  std::string name;
  std::array<BagherChannel, 3> channels;
  Rgb evaluate(Vec3 wo, Vec3 wi) const;
};
struct LowFit {
  std::string name;
  Rgb k_d, a;
  double b, c, ior;
  Rgb evaluate(Vec3 wo, Vec3 wi) const;
};

std::vector<BagherFit> read_bagher_fits(const std::filesystem::path& csv);
std::vector<LowFit> read_low_fits(const std::filesystem::path& csv);

std::vector<goniometry::Material> materials_of(const std::vector<BagherFit>& fits);
std::vector<goniometry::Material> materials_of(const std::vector<LowFit>& fits);

}  // namespace gonio::tests
