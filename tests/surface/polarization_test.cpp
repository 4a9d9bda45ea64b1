// Mueller matrices of every registered model: what passive matter can do, and reciprocal. Nothing here names a model
// but the tests of single laws at the end.
#include "surface/polarization.h"

#include <gtest/gtest.h>

#include "../optics/physical_mueller.h"
#include "cases.h"

namespace gonio::surface {
namespace {

using optics::Mueller;
using tests::SurfaceCase;

Vec3 above(Random& random) {
  const double z = 0.02 + 0.98 * random.uniform(), phi = 2 * pi * random.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

void expect_passive(const SurfaceCase& c, Vec3 wo, Vec3 wi) {
  for (const Mueller& m : c.model->mueller(c.values, wo, wi)) {
    EXPECT_NEAR(m(0, 0), 1, 1e-12) << c.name;
    EXPECT_TRUE(tests::is_sum_of_jones(m, 1e-7)) << c.name << " at " << wo.z << ", " << wi.z;
  }
}

// Of what surfaces scatter, and of the deltas that they draw. Of interfaces every third case: their tables take long.
TEST(Polarization, EveryModelDoesWhatPassiveMatterCan) {
  Random random(11);
  int interfaces = 0;
  for (const SurfaceCase& c : tests::surface_cases(2, 12)) {
    if (c.model->transmits() && ++interfaces % 3 != 1) continue;
    for (int k = 0; k < 6; ++k) {
      const Vec3 wo = above(random);
      Vec3 wi = above(random);
      if (c.model->transmits() && k % 2 == 0) wi.z = -wi.z;
      if (max_component(c.model->evaluate(c.values, wo, wi)) > 0) expect_passive(c, wo, wi);
      const Sample drawn = c.model->sample(c.values, wo, {random.uniform(), random.uniform()}, random.uniform());
      if (drawn.pdf > 0 && !drawn.below) expect_passive(c, wo, drawn.wi);
    }
  }
}

// Light that goes the same way back is polarized by the reversed() matrix.
TEST(Polarization, EveryModelIsReciprocal) {
  Random random(13);
  for (const SurfaceCase& c : tests::surface_cases(2, 14)) {
    if (c.model->transmits()) continue;  // there the sides change too
    for (int k = 0; k < 6; ++k) {
      const Vec3 wo = above(random), wi = above(random);
      const Rgb f = c.model->evaluate(c.values, wo, wi), back = c.model->evaluate(c.values, wi, wo);
      if (!(max_component(f) > 0)) continue;
      const auto a = c.model->mueller(c.values, wo, wi), b = c.model->mueller(c.values, wi, wo);
      for (std::size_t i = 0; i < 3; ++i) {
        const int band = static_cast<int>(i);
        const Mueller there = optics::reversed(a[i]);
        for (std::size_t at = 0; at < 16; ++at)
          EXPECT_NEAR(back[band] * b[i].m[at], f[band] * there.m[at], 1e-9 + 2e-3 * std::abs(f[band]))
              << c.name << " " << at / 4 << at % 4;
      }
    }
  }
}

TEST(Polarization, LightFromBeneathIsPolarizedInThePlaneOfEmergence) {
  // Atkinson & Hancock 2006, equation 3, written for sines; polarized away from the normal: p, so s1 < 0.
  const double n = 1.5;
  for (const double theta : {0.2, 0.8, 1.3}) {
    const double s = std::sin(theta), s2 = s * s, c = std::cos(theta);
    const double expected = (n - 1 / n) * (n - 1 / n) * s2 /
                            (2 + 2 * n * n - (n + 1 / n) * (n + 1 / n) * s2 + 4 * c * std::sqrt(n * n - s2));
    EXPECT_NEAR(transmitted_diattenuation(c, n), -expected, 1e-12);
    // Light that came along the normal, in its plane of emergence; then from the side, at another azimuth.
    const Vec3 wo{s, 0, c};
    for (const double azimuth : {0.0, 1.0, 2.5}) {
      const Vec3 wi{0.3 * std::cos(azimuth), 0.3 * std::sin(azimuth), std::sqrt(0.91)};
      const optics::Stokes out = matte_beneath(n, wo, wi) * optics::Stokes{{1, 0, 0, 0}};
      const optics::Stokes seen = optics::frame_change(wo, optics::scattering_axis(wi, wo), {0, 1, 0}) * out;
      EXPECT_NEAR(seen.s[1], -expected, 1e-12);
      EXPECT_NEAR(seen.s[2], 0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace gonio::surface
