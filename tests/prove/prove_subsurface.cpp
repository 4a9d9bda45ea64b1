// scripts/proofs/subsurface-bias: what the dipoles send out of a half space, over what photons do, by albedo, asymmetry
// and incidence. Index 1.4, smooth; lengths in mean free paths 1 / sigma_t'. The photons share nothing with the
// renderer, which agrees with them where it traces paths through the medium (tests/render/subsurface_test.cpp).
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "surface/subsurface_half_space.h"

namespace {

using namespace gonio;
using namespace gonio::tests;

const std::vector<double> edges{0, 0.3, 1, 3, 6, 12};

struct Worst {  // deviations from one
  double standard = 0, standard_far = 0, directional = 0, directional_far = 0;
};

void print_row(const char* name, const Built& built, Vec3 inward, const Photographed& photons) {
  double whole = 0, inner = 0;
  for (double outer = 1e-3; outer < 1e5; outer *= 1.3) {
    whole += built.ring(inward, inner, outer);
    inner = outer;
  }
  std::printf("    %-12s %6.3f (%5.2f)  ", name, whole, whole / photons.whole);
  for (std::size_t b = 0; b + 1 < edges.size(); ++b)
    std::printf(" %6.2f", built.ring(inward, edges[b], edges[b + 1]) / photons.rings[b]);
  std::printf("\n");
}

void compare(double albedo, double g, double cosine, int count, Worst& worst) {
  const HalfSpace m{1 - albedo, albedo / (1 - g), g, 1.4};
  const Built standard("dipole", m), directional("directional-dipole", m);
  const Photographed photons = photographed(m, cosine, edges, count);
  const Vec3 inward = inwards(cosine, m.eta);
  std::printf("  albedo' %.3f  g %.1f  incidence %2.0f deg: photons %.3f +- %.3f;  rings of", albedo, g,
              std::acos(cosine) * 180 / pi, photons.whole, photons.sigma);
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) std::printf(" %g-%g", edges[b], edges[b + 1]);
  std::printf("\n");
  print_row("standard", standard, inward, photons);
  print_row("directional", directional, inward, photons);
  if (albedo < 0.95) return;
  const auto off = [](double& most, double ratio) { most = std::max(most, std::abs(ratio - 1)); };
  if (cosine == 1 && g == 0) off(worst.standard, standard.beneath().diffuse_reflectance().x / photons.whole);
  off(worst.directional, directional.ring(inward, 1, 3) / photons.rings[2]);
  if (albedo < 0.99) return;
  off(worst.standard_far, standard.ring(inward, 3, 6) / photons.rings[3]);
  off(worst.directional_far, directional.ring(inward, 3, 6) / photons.rings[3]);
}

bool claim(const char* what, double measured, double required) {
  const bool met = measured <= required;
  std::printf("subsurface-bias %s: measured %.0f %% required <= %.0f %%%s\n", what, 100 * measured, 100 * required,
              met ? "" : "  NOT MET");
  return met;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::max(1000, std::atoi(argv[1])) : 40000;
  std::printf("  whole reflectance (over that of photons), then exitance in rings over that of photons\n");
  Worst worst;
  for (const double albedo : {0.5, 0.8, 0.95, 0.99, 0.999})
    for (const double g : {0.0, 0.8})
      for (const double cosine : {1.0, 0.5}) compare(albedo, g, cosine, count, worst);
  bool met = claim("whole of the standard dipole, isotropic, normal, albedo' >= 0.95", worst.standard, 0.05);
  met &= claim("standard dipole 3 to 6 free paths away, albedo' >= 0.99", worst.standard_far, 0.25);
  met &= claim("directional dipole 1 to 3 free paths away, albedo' >= 0.95", worst.directional, 0.60);
  met &= claim("directional dipole 3 to 6 free paths away, albedo' >= 0.99", worst.directional_far, 0.35);
  return met ? 0 : 1;
}
