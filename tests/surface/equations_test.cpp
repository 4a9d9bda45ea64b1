// The equations behind the surfaces, against closed forms and independent quadrature.
#include <gtest/gtest.h>

#include "cases.h"
#include "chi_square.h"
#include "surface/fresnel.h"
#include "surface/interface_albedo.h"
#include "surface/microfacet.h"
#include "surface/oren_nayar.h"

namespace gonio::tests {
namespace {

using surface::Ggx;
using surface::OrenNayar;

surface::Values values(std::initializer_list<Rgb> v) {
  surface::Values out;
  std::copy(v.begin(), v.end(), out.v.begin());
  return out;
}
Rgb grey(double x) {
  return {x, x, x};
}

// Integral over the hemisphere by patches of (cosine, azimuth).
double over_hemisphere(const std::function<double(Vec3)>& f, double tolerance = 1e-7) {
  const auto patch = [&](double z, Vec2 turned) {
    const double r = std::sqrt(1 - z * z);
    return f({r * turned.x, r * turned.y, z});
  };
  double sum = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      sum += integrate_patch(patch, i / 8.0, (i + 1) / 8.0, j * pi / 4, (j + 1) * pi / 4, tolerance);
  return sum;
}

TEST(Fresnel, Dielectric) {
  EXPECT_NEAR(surface::eta_of_f0(0.04), 1.5, 1e-12);
  EXPECT_NEAR(surface::fresnel_dielectric(1, 1.5), 0.04, 1e-15);
  EXPECT_NEAR(surface::fresnel_dielectric(0, 1.5), 1, 1e-15);
  // Brewster's angle: only the perpendicular part remains, ((eta^2 - 1) / (eta^2 + 1))^2 / 2.
  const double brewster = std::cos(std::atan(1.5)), ratio = (1.5 * 1.5 - 1) / (1.5 * 1.5 + 1);
  EXPECT_NEAR(surface::fresnel_dielectric(brewster, 1.5), ratio * ratio / 2, 1e-14);
  EXPECT_EQ(surface::fresnel_dielectric(0, 1), 0);
}

TEST(Fresnel, MetalWithoutExtinctionIsADielectric) {
  for (double c = 0; c <= 1; c += 0.01)
    EXPECT_NEAR(surface::fresnel_metal(c, 1.7, 0), surface::fresnel_dielectric(c, 1.7), 1e-12) << c;
}

TEST(Fresnel, MetalAtNormalIncidence) {
  const double eta = 0.143, k = 3.983;  // silver in the green: ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)
  const double expected = ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
  EXPECT_NEAR(surface::fresnel_metal(1, eta, k), expected, 1e-12);
}

TEST(Fresnel, MeanOverDiffuseLight) {
  for (const double eta : {1.0005, 1.01, 1.33, 1.5, 2.5}) {
    double sum = 0;
    constexpr int n = 200000;  // 2 c dc = d(c^2), denser towards grazing: c = v^3
    for (int i = 0; i < n; ++i) {
      const double v = (i + 0.5) / n, c = v * v * v;
      sum += 2 * c * 3 * v * v / n * surface::fresnel_dielectric(c, eta);
    }
    EXPECT_NEAR(surface::fresnel_dielectric_mean(eta), sum, 2e-6) << eta;
  }
}

TEST(Microfacets, CoverTheirPlaneOnce) {
  for (const double alpha : {0.02, 0.1, 0.5, 1.0}) {
    const Ggx ggx(alpha);
    EXPECT_NEAR(over_hemisphere([&](Vec3 h) { return ggx.density_of_normals(h) * h.z; }), 1, 2e-5) << alpha;
  }
}

TEST(Microfacets, WeightIsLobeOverDensity) {
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    const Ggx ggx(0.02 + random.uniform());
    const Vec3 wo = draw_direction(random), wi = draw_direction(random), h = surface::half_vector(wo, wi);
    const double pdf = ggx.pdf(wo, h);
    if (pdf == 0) continue;
    EXPECT_NEAR(ggx.lobe(wo, wi, h) * wi.z / pdf / ggx.weight(wo, wi), 1, 1e-9);
  }
}

TEST(OrenNayar, VanishingRoughnessIsLambertToTheLastBit) {
  const surface::Model& diffuse = *surface::find("diffuse");
  Random random(4);
  for (int k = 0; k < 1000; ++k) {
    const Rgb albedo{random.uniform(), random.uniform(), random.uniform()};
    const Vec3 wo = draw_direction(random), wi = draw_direction(random);
    EXPECT_EQ(diffuse.evaluate(values({albedo, grey(0)}), wo, wi), albedo * (1 / pi));
    EXPECT_EQ(diffuse.sample(values({albedo, grey(0)}), wo, {0.2, 0.6}, 0.1).weight, albedo);
  }
}

TEST(OrenNayar, EqualsThePrintedFormula) {
  const double sigma = 0.4, s = sigma * sigma;  // large enough that nothing is scaled
  const double A = 1 - 0.5 * s / (s + 0.33), B = 0.45 * s / (s + 0.09);
  for (const double i : {10.0, 35.0, 70.0})
    for (const double o : {5.0, 50.0, 80.0})
      for (const double phi : {0.0, 0.9, 2.5}) {
        const double ti = i * pi / 180, to = o * pi / 180;
        const double expected =
            A + B * std::max(0.0, std::cos(phi)) * std::sin(std::max(ti, to)) * std::tan(std::min(ti, to));
        EXPECT_NEAR(OrenNayar(sigma).shape(at_zenith(o, 0), at_zenith(i, phi)), expected, 1e-12);
      }
}

TEST(OrenNayar, ReflectanceInClosedForm) {
  for (const double sigma : {0.0, 0.1, 0.3, 0.6, 1.2})
    for (const double zenith : {0.0, 30.0, 60.0, 85.0}) {
      const Vec3 wo = at_zenith(zenith);
      const double by_quadrature = over_hemisphere([&](Vec3 wi) { return OrenNayar(sigma).shape(wo, wi) * wi.z / pi; });
      EXPECT_NEAR(OrenNayar(sigma).reflectance(wo.z), by_quadrature, 1e-4) << sigma << " " << zenith;
      EXPECT_LE(OrenNayar(sigma).reflectance(wo.z), 1 + 1e-12);
    }
}

// White furnace: never more than arrives, all of it at sigma = 0; what rough grooves keep is the light between them.
TEST(OrenNayar, NeverMakesLight) {
  double least = 1;
  for (double sigma = 0; sigma < pi / 2; sigma += 0.01)
    for (double cosine = 0; cosine <= 1; cosine += 0.01) {
      const double reflected = OrenNayar(sigma).reflectance(cosine);
      ASSERT_LE(reflected, 1 + 1e-12) << sigma << " " << cosine;
      least = std::min(least, reflected);
    }
  EXPECT_EQ(OrenNayar(0).reflectance(0.3), 1);
  EXPECT_GT(least, 0.5);
}

TEST(InterfaceAlbedo, AgreesWithQuadratureBetweenItsNodes) {
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    const double alpha = 0.02 + 0.98 * std::pow(random.uniform(), 2), f0 = 0.001 + 0.199 * random.uniform();
    const double z = std::pow(random.uniform(), 2), eta = surface::eta_of_f0(f0);
    const Vec3 wo{std::sqrt(1 - z * z), 0, z};
    const Ggx ggx(alpha);
    double sum = 0;
    constexpr int n = 128;
    for (int i = 0; i < n; ++i) {
      const double v = (i + 0.5) / n, share = 3 * v * v / (n * n);
      for (int j = 0; j < n; ++j) {
        const Vec3 h = ggx.visible_normal(wo, {1 - v * v * v, (j + 0.5) / n}), wi = surface::mirrored(wo, h);
        if (wi.z <= 0) continue;
        sum += share * ggx.weight(wo, wi) * surface::fresnel_dielectric(dot(wo, h), eta);
      }
    }
    EXPECT_NEAR(surface::dielectric_albedo(z, alpha, f0), sum, 2e-3)
        << "cosine " << z << " alpha " << alpha << " f0 " << f0;
  }
}

TEST(CoatedDiffuse, WithoutInterfaceIsDiffuseToTheLastBit) {
  const surface::Model &coated = *surface::find("coated-diffuse"), &diffuse = *surface::find("diffuse");
  Random random(8);
  for (int k = 0; k < 2000; ++k) {
    const Rgb albedo{random.uniform(), random.uniform(), random.uniform()};
    const Rgb sigma = grey(k % 3 == 0 ? 0 : random.uniform());
    const auto bare = values({albedo, sigma}),
               neutral = values({albedo, sigma, grey(0), grey(random.uniform(0.02, 1))});
    const Vec3 wo = draw_direction(random), wi = draw_direction(random);
    const Vec2 u{random.uniform(), random.uniform()};
    const double lobe = random.uniform();
    EXPECT_EQ(coated.evaluate(neutral, wo, wi), diffuse.evaluate(bare, wo, wi));
    EXPECT_EQ(coated.pdf(neutral, wo, wi), diffuse.pdf(bare, wo, wi));
    EXPECT_EQ(coated.albedo(neutral, wo), diffuse.albedo(bare, wo));
    const auto a = coated.sample(neutral, wo, u, lobe), b = diffuse.sample(bare, wo, u, lobe);
    EXPECT_EQ(a.wi, b.wi);
    EXPECT_EQ(a.weight, b.weight);
    EXPECT_EQ(a.pdf, b.pdf);
  }
}

TEST(CoatedDiffuse, TendsToDiffuseAsTheInterfaceFades) {
  const surface::Model &coated = *surface::find("coated-diffuse"), &diffuse = *surface::find("diffuse");
  const auto faint = values({grey(0.5), grey(0.2), grey(1e-7), grey(0.3)});
  for (const double zenith : {0.0, 40.0, 70.0})
    EXPECT_NEAR(coated.evaluate(faint, at_zenith(zenith), at_zenith(30, 2)).x,
                diffuse.evaluate(faint, at_zenith(zenith), at_zenith(30, 2)).x, 1e-5);
}

// Bases for a coat, held together with it.
struct Coated {
  surface::Layer base;
  surface::Values values;
  Coated(const char* base_id, surface::Values below, std::initializer_list<Rgb> coat)
      : base{surface::find(base_id), below}, values(tests::values(coat)) {
    values.base = &base;
  }
  Coated(const Coated&) = delete;
};

// Over a Lambertian base the general coat sums the same series as the closed form, up to its fixed samples.
TEST(RoughCoat, OverMatteBaseIsInterfacedDiffuse) {
  const surface::Model &coat = *surface::find("rough-coat"), &closed = *surface::find("interfaced-diffuse");
  for (const double albedo : {0.1, 0.5, 0.9})
    for (const double alpha : {0.0, 0.1, 0.5}) {
      const Coated over("diffuse", values({grey(albedo), grey(0)}), {grey(1.5), grey(alpha), grey(0), grey(0)});
      const auto same = values({grey(albedo), grey(1.5), grey(alpha)});
      for (const double zenith : {5.0, 45.0, 75.0}) {
        const double one = coat.evaluate(over.values, at_zenith(zenith), at_zenith(30, 2)).x;
        const double other = closed.evaluate(same, at_zenith(zenith), at_zenith(30, 2)).x;
        EXPECT_NEAR(one, other, 0.01 * other) << albedo << " " << alpha << " " << zenith;
      }
    }
}

TEST(RoughCoat, WithoutCoatIsTheBaseToTheLastBit) {
  const surface::Model &coat = *surface::find("rough-coat"), &metal = *surface::find("metal");
  const Coated over("metal", values({Rgb{0.9, 0.6, 0.4}, grey(0.3)}), {grey(1), grey(0.2), grey(0), grey(0.001)});
  Random random(8);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 wo = draw_direction(random), wi = draw_direction(random);
    const Vec2 u{random.uniform(), random.uniform()};
    EXPECT_EQ(coat.evaluate(over.values, wo, wi), metal.evaluate(over.base.values, wo, wi));
    EXPECT_EQ(coat.pdf(over.values, wo, wi), metal.pdf(over.base.values, wo, wi));
    EXPECT_EQ(coat.sample(over.values, wo, u, 0.3).weight, metal.sample(over.base.values, wo, u, 0.3).weight);
  }
}

// A smooth coat over a mirror of reflectance r: F + (1 - F)^2 r sum of (F r)^n, here with the light that is trapped in
// the mirror's direction sent out diffusely, and absorption by Bouguer's law on both ways.
TEST(RoughCoat, OverAMirrorReflectsTheSeries) {
  const surface::Model& coat = *surface::find("rough-coat");
  const double depth = 0.3;
  for (const double zenith : {0.0, 40.0, 70.0}) {
    const Coated over("metal", values({grey(1), grey(0)}), {grey(1.5), grey(0), grey(300), grey(depth / 300)});
    const Vec3 wo = at_zenith(zenith);
    const double f = surface::fresnel_dielectric(wo.z, 1.5), inside = std::sqrt(1 - (1 - wo.z * wo.z) / 2.25);
    const double a = std::exp(-depth / inside), once = f + (1 - f) * (1 - f) * a * a;
    const double all = once + (1 - f) * (1 - f) * a * a * f * a * a / (1 - f * a * a);
    const auto [reflected, error] = reflectance_by_sampling(coat, over.values, wo);
    EXPECT_GT(reflected.x, once - 6e-3 - 6 * error.x) << zenith;
    EXPECT_LT(reflected.x, all + 6e-3 + 6 * error.x) << zenith;
  }
}

// A white base of any kind under a coat that absorbs nothing: what goes in comes out.
TEST(RoughCoat, OverWhiteMirrorsReturnsAllLight) {
  const surface::Model& coat = *surface::find("rough-coat");
  for (const auto& [alpha, anisotropy] : {std::pair{0.0, 0.0}, {0.1, 0.0}, {0.4, 0.0}, {0.8, 0.0}, {0.3, 0.8}})
    for (const double eta : {1.5, 2.6})
      for (const double zenith : {0.0, 45.0, 75.0}) {
        const Coated over("conductor", values({grey(0.01), grey(30), grey(alpha), grey(anisotropy), grey(0.3)}),
                          {grey(eta), grey(0.1), grey(0), grey(0)});
        const auto [reflected, error] = reflectance_by_sampling(coat, over.values, at_zenith(zenith));
        EXPECT_NEAR(reflected.x, 1, (anisotropy > 0 ? 0.06 : 0.05) + 6 * error.x)
            << alpha << " " << anisotropy << " " << eta << " " << zenith;
      }
}

// What the interface does to a base: darker where albedo is low, nothing lost where it is white.
TEST(InterfacedDiffuse, DarkensAsSaundersonSays) {
  const surface::Model& plastic = *surface::find("interfaced-diffuse");
  const double k1 = surface::fresnel_dielectric_mean(1.5), k2 = 1 - (1 - k1) / 2.25;
  for (const double albedo : {0.05, 0.5, 1.0}) {
    const auto smooth = values({grey(albedo), grey(1.5), grey(0)});
    double mean =
        0;  // over diffuse light: k1 + (1 - k1) (1 - k2) albedo / (1 - k2 albedo), Saunderson 1942, equation 1
    constexpr int n = 2000;
    for (int i = 0; i < n; ++i) {
      const double c = std::sqrt((i + 0.5) / n);
      mean += plastic.albedo(smooth, {std::sqrt(1 - c * c), 0, c}).x / n;
    }
    EXPECT_NEAR(mean, k1 + (1 - k1) * (1 - k2) * albedo / (1 - k2 * albedo), 1e-4) << albedo;
  }
}

// What goes in through the interface is what a rough dielectric of the same facets transmits; that sends some of the
// light that meets several facets back, which the coat takes as transmitted.
TEST(InterfacedDiffuse, PassesWhatTheRoughDielectricTransmits) {
  const surface::Model &plastic = *surface::find("interfaced-diffuse"), &glass = *surface::find("dielectric");
  for (const double alpha : {0.0, 0.1, 0.3})
    for (const double zenith : {10.0, 45.0, 70.0}) {
      const Vec3 wo = at_zenith(zenith);
      surface::Values clear = values({grey(1.5), grey(alpha), grey(0), grey(0), grey(0), grey(0), grey(0)});
      clear.eta = grey(1.5);
      Random random(17);
      double through = 0;
      constexpr int count = 20000;
      for (int k = 0; k < count; ++k) {
        const auto s = glass.sample(clear, wo, {random.uniform(), random.uniform()}, random.uniform());
        if (s.pdf > 0 && s.wi.z < 0) through += s.weight.x * 2.25 / count;
      }
      // Black inside: only the interface reflects.
      const double passes = 1 - plastic.albedo(values({grey(0), grey(1.5), grey(alpha)}), wo).x;
      EXPECT_NEAR(through, passes, 0.015) << alpha << " " << zenith;
    }
}

TEST(InterfacedDiffuse, WithoutInterfaceIsDiffuse) {
  const surface::Model &plastic = *surface::find("interfaced-diffuse"), &diffuse = *surface::find("diffuse");
  const Rgb albedo{0.2, 0.5, 0.9};
  const Rgb there = plastic.evaluate(values({albedo, grey(1), grey(0.3)}), at_zenith(50), at_zenith(20, 3));
  const Rgb expected = diffuse.evaluate(values({albedo, grey(0)}), at_zenith(50), at_zenith(20, 3));
  EXPECT_NEAR(there.x, expected.x, 1e-15);
  EXPECT_NEAR(there.z, expected.z, 1e-15);
}

// White furnace: what goes in comes out, whatever the roughness, up to the tables' error.
TEST(Furnace, WhiteBaseUnderInterface) {
  const surface::Model& coated = *surface::find("coated-diffuse");
  for (const double alpha : {0.02, 0.1, 0.4, 1.0})
    for (const double f0 : {0.02, 0.04, 0.2})
      for (const double zenith : {0.0, 45.0, 80.0}) {
        const auto white = values({grey(1), grey(0), grey(f0), grey(alpha)});
        const auto [reflected, error] = reflectance_by_sampling(coated, white, at_zenith(zenith));
        EXPECT_NEAR(reflected.x, 1, 2e-3 + 6 * error.x) << alpha << " " << f0 << " " << zenith;
        EXPECT_NEAR(coated.albedo(white, at_zenith(zenith)).x, 1, 1e-12);
      }
}

}  // namespace
}  // namespace gonio::tests
