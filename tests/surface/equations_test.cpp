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
  const auto patch = [&](double z, double phi) {
    const double r = std::sqrt(1 - z * z);
    return f({r * std::cos(phi), r * std::sin(phi), z});
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

TEST(InterfaceAlbedo, AgreesWithQuadratureBetweenItsNodes) {
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    const double alpha = 0.02 + 0.98 * std::pow(random.uniform(), 2), f0 = 0.001 + 0.199 * random.uniform();
    const double z = std::pow(random.uniform(), 2), eta = surface::eta_of_f0(f0);
    const Vec3 wo{std::sqrt(1 - z * z), 0, z};
    const Ggx ggx(alpha);
    double sum = 0, mirror = 0;
    constexpr int n = 128;
    for (int i = 0; i < n; ++i) {
      const double v = (i + 0.5) / n, share = 3 * v * v / (n * n);
      for (int j = 0; j < n; ++j) {
        const Vec3 h = ggx.visible_normal(wo, {1 - v * v * v, (j + 0.5) / n}), wi = surface::mirrored(wo, h);
        if (wi.z <= 0) continue;
        mirror += share * ggx.weight(wo, wi);
        sum += share * ggx.weight(wo, wi) * surface::fresnel_dielectric(dot(wo, h), eta);
      }
    }
    EXPECT_NEAR(surface::dielectric_albedo(z, alpha, f0), sum, 2e-3)
        << "cosine " << z << " alpha " << alpha << " f0 " << f0;
    EXPECT_NEAR(surface::mirror_albedo(z, alpha), mirror, 2e-3) << "cosine " << z << " alpha " << alpha;
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

TEST(Furnace, PerfectMirrorOfAnyRoughness) {
  const surface::Model& metal = *surface::find("metal");
  for (const double alpha : {0.02, 0.1, 0.4, 1.0})
    for (const double zenith : {0.0, 45.0, 80.0}) {
      const auto mirror = values({grey(1), grey(alpha)});
      const auto [reflected, error] = reflectance_by_sampling(metal, mirror, at_zenith(zenith));
      EXPECT_NEAR(reflected.x, 1, 2e-3 + 6 * error.x) << alpha << " " << zenith;
    }
}

TEST(Metal, AlbedoIsItsReflectance) {
  const surface::Model& metal = *surface::find("metal");
  for (const double alpha : {0.05, 0.3, 0.9})
    for (const double zenith : {0.0, 50.0, 82.0}) {
      const auto copper = values({Rgb{0.95, 0.64, 0.54}, grey(alpha)});
      const auto [reflected, error] = reflectance_by_sampling(metal, copper, at_zenith(zenith));
      const Rgb stated = metal.albedo(copper, at_zenith(zenith));
      EXPECT_NEAR(reflected.x, stated.x, 2e-3 + 6 * error.x) << alpha << " " << zenith;
      EXPECT_NEAR(reflected.z, stated.z, 2e-3 + 6 * error.z) << alpha << " " << zenith;
    }
}

}  // namespace
}  // namespace gonio::tests
