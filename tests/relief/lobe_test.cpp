// Lobes of reliefs: known answers, energy, reciprocity. Statistical limits are at 4 sigmas of the estimates' own.
#include "relief/lobe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "relief/noise.h"
#include "relief/normals.h"
#include "relief/ridges.h"
#include "surface/half_angle.h"
#include "surface/surface.h"

namespace gonio::relief {
namespace {

Relief flat() {
  return {4, 4, 1e-6, 1e-6, std::vector<double>(16, 0.0), true};
}

TEST(Lobe, AFlatRoughFieldIsItsFacets) {
  const Material m = conductor({0.2, 0.9, 1.5}, {3.9, 2.4, 1.9}, 0.3);
  for (const double theta : {0.2, 0.9, 1.3}) {
    const Vec3 wo = direction_of(0.7, 0), wi = direction_of(theta, pi - 0.2);
    const Estimate e = lobe(flat(), m, wo, wi, {}, {.paths = 128});
    const Rgb f = m.model->evaluate(m.values, wo, wi);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.value[c], f[c], 1e-9 * f[c]);
  }
}

TEST(Lobe, AFlatMirrorFillsTheConeAboutItsMirrorDirection) {
  const double half = 0.05;
  const Vec3 wo = direction_of(0.6, 0.3), wi = direction_of(0.6, 0.3 + pi);
  const Estimate e = lobe(flat(), mirror(), wo, wi, {half, 0}, {.paths = 64});
  EXPECT_NEAR(e.value.x, 1 / (pi * std::sin(half) * std::sin(half) * wi.z), 1e-9 * e.value.x);
  EXPECT_EQ(lobe(flat(), mirror(), wo, direction_of(0.7, 0.3 + pi), {half, 0}, {.paths = 64}).value.x, 0);
  EXPECT_THROW(lobe(flat(), mirror(), wo, wi, {}, {.paths = 64}), Error);
  EXPECT_THROW(lobe(flat(), mirror(), wo, {0, 0, -1}, {0.1, 0}, {.paths = 64}), Error);
}

// White mirrors lose nothing, however often light meets them; so do Lambert's walls.
TEST(Lobe, WhiteReliefsReflectAllLight) {
  for (const Material& m : {mirror(), white()}) {
    const LobeTable t = lobe_table(sinusoid(8e-6, 20e-6, 30e-6, 32), m, direction_of(0.8, 0.4), {30, 36, 32},
                                   {.paths = 20000, .seed = 2});
    EXPECT_NEAR(t.energy.reflected.value.y + t.energy.cut.value.y, 1, 4 * t.energy.reflected.sigma.y + 1e-12);
    EXPECT_LT(t.energy.cut.value.y, 1e-3);
    EXPECT_LT(t.energy.reflected.sigma.y, 0.01);
    EXPECT_GT(t.energy.by_facets[1], 0.02);
    double sum = 0, disc = 0;
    for (int c = 0; c < 30 * 36; ++c) {
      const double low = std::sin(c / 36 * pi / 60), high = std::sin((c / 36 + 1) * pi / 60);
      sum += t.table[static_cast<std::size_t>(c)].value.x * (high * high - low * low) * pi / 36;
    }
    for (const Estimate& e : t.picture) disc += e.value.x * 4 / (32.0 * 32.0);
    EXPECT_NEAR(sum, t.energy.reflected.value.x, 1e-9);
    EXPECT_NEAR(disc, t.energy.reflected.value.x, 1e-9);
  }
}

// 20 pairs, two-sided: z^2 sums to chi-square of 20; below 45.3 with probability 0.999.
TEST(Lobe, IsReciprocal) {
  Random random(6);
  const Relief r = ridges({.ridge_rad = 0.35, .pitch_m = 1e-4, .crest_radius_m = 5e-6}, {.across = 64});
  double chi2 = 0;
  for (int k = 0; k < 20; ++k) {
    const Vec3 a = direction_of(random.uniform(0, 1.2), random.uniform(0, 2 * pi)),
               b = direction_of(random.uniform(0, 1.2), random.uniform(0, 2 * pi));
    const bool smooth = k % 2 == 0;
    const Material m = smooth ? mirror() : facets_of_index(1.5, 0.2);
    const Aperture cones = smooth ? Aperture{0.3, 0.3} : Aperture{};
    const std::uint64_t seed = static_cast<std::uint64_t>(k);
    const Estimate f = lobe(r, m, a, b, cones, {.paths = 20000, .seed = seed}),
                   g = lobe(r, m, b, a, cones, {.paths = 20000, .seed = seed + 100});
    const double sigma = std::hypot(f.sigma.x, g.sigma.x);
    if (sigma > 0)
      chi2 += std::pow((f.value.x - g.value.x) / sigma, 2);
    else
      EXPECT_NEAR(f.value.x, g.value.x, 1e-9);
  }
  EXPECT_LT(chi2, 45.3);
}

// The two ways of estimating agree where both can: rough facets into a cone, and the table's own cells.
TEST(Lobe, NextEventAgreesWithCounting) {
  const Relief r = sinusoid(2e-6, 20e-6, 30e-6, 32);
  const Material m = conductor({0.2, 0.9, 1.5}, {3.9, 2.4, 1.9}, 0.25);
  const Vec3 wo = direction_of(0.7, 0);
  const LobeTable t = lobe_table(r, m, wo, {9, 12, 8}, {.paths = 400000, .seed = 4});
  double chi2 = 0;
  int n = 0;
  for (int theta = 0; theta < 7; theta += 2)
    for (int phi = 0; phi < 12; phi += 3) {
      // the cell's mean from points on a lattice in it
      double sum = 0, variance = 0, weight = 0;
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
          const double th = (theta + (a + 0.5) / 4) * pi / 18, w = std::sin(th) * std::cos(th);
          const Estimate e = lobe(r, m, wo, direction_of(th, (phi + (b + 0.5) / 4) * pi / 6), {},
                                  {.paths = 2560, .seed = static_cast<std::uint64_t>(n * 16 + a * 4 + b)});
          sum += w * e.value.x, variance += w * w * e.sigma.x * e.sigma.x, weight += w;
        }
      const Estimate& cell = t.table[static_cast<std::size_t>(theta * 12 + phi)];
      // 1 % for the lattice
      const double s2 = variance / (weight * weight) + cell.sigma.x * cell.sigma.x + std::pow(0.01 * cell.value.x, 2);
      chi2 += std::pow(sum / weight - cell.value.x, 2) / s2;
      ++n;
    }
  EXPECT_EQ(n, 16);
  EXPECT_LT(chi2, 39.3);  // 0.999 of chi-square with 16
}

// Smooth facets of a nearly Gaussian relief, seen from not too low, reflect once as Beckmann's distribution says
// (Walter et al. 2007) with the alpha of its own slopes. 10 %: the patch has some 1000 independent slopes in each cone,
// and its heights are not quite Gaussian.
TEST(Lobe, OfAGaussianReliefIsBeckmanns) {
  // One noise alone has slopes that are more often small: 15 % more light along the mirror direction. Eight together
  // are nearly Gaussian.
  const std::vector<NoisePart> parts(8, {0.2e-6 / std::sqrt(8.0), 8e-6});
  const Relief r = noise_relief({.parts = parts, .nx = 512, .ny = 512, .step_m = 0.5e-6, .seed = 2, .periodic = true});
  const Normals normals = normals_of(map_of(r));
  ASSERT_EQ(normals.fits[0].distribution, "beckmann");
  const double alpha = std::sqrt(normals.fits[0].alpha_u * normals.fits[0].alpha_v);
  ASSERT_GT(alpha, 0.08);
  ASSERT_LT(alpha, 0.3);
  const Rgb eta{0.2, 0.9, 1.5}, k{3.9, 2.4, 1.9};
  const Material smooth = conductor(eta, k), rough = material_of("beckmann-conductor",
                                                                 {{"eta", std::vector<double>{eta.x, eta.y, eta.z}},
                                                                  {"k", std::vector<double>{k.x, k.y, k.z}},
                                                                  {"alpha", alpha}},
                                                                 "t");
  const Relief level = flat();
  const Vec3 wo = direction_of(0.5, 0);
  for (const double off : {-0.15, 0.0, 0.15}) {
    const Vec3 wi = direction_of(0.5 + off, pi);
    const Estimate traced = lobe(r, smooth, wo, wi, {0.08, 0.08}, {.paths = 400000, .seed = 3}),
                   model = lobe(level, rough, wo, wi, {0.08, 0.08}, {.paths = 40000, .seed = 3});
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(traced.value[c] / model.value[c], 1, 0.1 + 4 * traced.sigma[c] / traced.value[c]) << off << " " << c;
  }
}

}  // namespace
}  // namespace gonio::relief
