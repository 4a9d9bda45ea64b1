#include "surface/dipole_medium.h"

#include <cmath>

#include "surface/fresnel.h"

namespace gonio::surface {

std::vector<std::pair<double, double>> gauss_legendre(int count) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < count; ++i) {  // Newton's method from Tricomi's estimate
    double x = std::cos(pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      double before = 1, here = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * here - (k - 1) * before) / k;
        before = std::exchange(here, next);
      }
      slope = count * (x * here - before) / (x * x - 1);
      x -= here / slope;
    }
    rule.emplace_back((1 - x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

InteriorFresnel::InteriorFresnel(double eta) {
  if (eta == 1) return;
  static const auto rule = gauss_legendre(40);
  double first = 0, second = 0;
  for (const auto& [c, weight] : rule) {
    const double passes = weight * (1 - fresnel_dielectric(c, eta)) * c;
    first += passes;
    second += passes * std::sqrt(1 - (1 - c * c) / (eta * eta));
  }
  transmits_in = 2 * first;
  c_phi = first / (2 * eta * eta);
  c_e = 1.5 * second / (eta * eta);
}

DipoleMedium::DipoleMedium(double sigma_a_per_m, double sigma_s_per_m, double asymmetry)
    : sigma_a(sigma_a_per_m), sigma_s(sigma_s_per_m), g(asymmetry) {
  const double scattered = sigma_s * (1 - g);
  sigma_t_reduced = scattered + sigma_a;
  if (!(scattered > 0)) return;
  albedo_reduced = scattered / sigma_t_reduced;
  diffusion_m = 1 / (3 * sigma_t_reduced);
  sigma_tr = std::sqrt(sigma_a / diffusion_m);
}

}  // namespace gonio::surface
