// Metals and the facets beneath them: printed formulas, limits, and what the tables of loss are worth.
#include <gtest/gtest.h>

#include "base/text.h"
#include "cases.h"
#include "chi_square.h"
#include "surface/fresnel.h"
#include "surface/interface_loss.h"
#include "surface/slopes_grid.h"

namespace gonio::tests {
namespace {

using surface::Facets;
using surface::InterfaceLoss;
using surface::Roughness;
using surface::Slopes;

Rgb grey(double x) {
  return {x, x, x};
}
// Gold-like, and all but a perfect mirror: F > 0.9998 at all angles.
const Rgb gold_eta{0.13, 0.43, 1.4}, gold_k{4.1, 2.5, 1.9};
surface::Values conductor(Rgb eta, Rgb k, double alpha, double anisotropy = 0, double azimuth = 0) {
  surface::Values values;
  values.v = {eta, k, grey(alpha), grey(anisotropy), grey(azimuth)};
  return values;
}
surface::Values mirror(double alpha, double anisotropy = 0) {
  return conductor(grey(0.01), grey(30), alpha, anisotropy);
}
const std::array<const char*, 2> conductors = {"conductor", "beckmann-conductor"};

TEST(SmoothMetal, IsADeltaOfFresnelsReflectance) {
  for (const char* id : conductors)
    for (const double zenith : {0.0, 40.0, 85.0}) {
      const surface::Model& model = *surface::find(id);
      const auto values = conductor(gold_eta, gold_k, 0);
      const Vec3 wo = at_zenith(zenith), there{-wo.x, -wo.y, wo.z};
      const auto s = model.sample(values, wo, {0.3, 0.8}, 0.6);
      EXPECT_TRUE(s.delta);
      EXPECT_EQ(s.pdf, 1);
      EXPECT_EQ(s.wi, there);
      EXPECT_NEAR(s.weight.y, surface::fresnel_metal(wo.z, gold_eta.y, gold_k.y), 1e-15);
      EXPECT_EQ(model.albedo(values, wo), s.weight);
      EXPECT_EQ(model.evaluate(values, wo, there), Rgb{});
      EXPECT_EQ(model.pdf(values, wo, there), 0);
    }
}

// Roughness just above what counts as smooth: the same reflectance, and nothing farther than some alphas from the
// mirrored direction.
TEST(SmoothMetal, IsTheLimitOfRoughOnes) {
  for (const char* id : conductors)
    for (const double zenith : {0.0, 40.0, 70.0}) {
      const surface::Model& model = *surface::find(id);
      const double alpha = 2e-4;
      const auto rough = conductor(gold_eta, gold_k, alpha), smooth = conductor(gold_eta, gold_k, 0);
      const Vec3 wo = at_zenith(zenith), there{-wo.x, -wo.y, wo.z};
      const Rgb a = model.albedo(rough, wo), b = model.albedo(smooth, wo);
      EXPECT_NEAR(a.x, b.x, 1e-3) << id << zenith;
      EXPECT_NEAR(a.z, b.z, 1e-3) << id << zenith;
      Random random(4);
      int near = 0;
      constexpr int count = 2000;
      for (int k = 0; k < count; ++k) {
        const auto s = model.sample(rough, wo, {random.uniform(), random.uniform()}, random.uniform());
        near += s.pdf > 0 && norm(s.wi - there) < 40 * alpha;
      }
      EXPECT_GT(near, 0.98 * count) << id << zenith;  // GGX: one facet in 400 is steeper than 20 alpha
    }
}

// The narrowest lobes with the strongest direction, seen at a grazing angle: ridges of 1e-5 rad, slanted to the bins.
TEST(RoughMetal, SamplerDrawsFromItsDensityWhereTheLobeIsARidge) {
  std::vector<Sampler> family;
  for (const char* id : conductors)
    for (const double azimuth : {0.3, 1.0}) {
      const surface::Model& model = *surface::find(id);
      const auto values = conductor(gold_eta, gold_k, 1e-3, 1, azimuth);
      const Vec3 wo = at_zenith(86);
      family.push_back({id + format(" turned by %g rad", azimuth),
                        [&model, values, wo](Random& random) -> std::optional<Vec3> {
                          const Vec2 u{random.uniform(), random.uniform()};
                          const auto s = model.sample(values, wo, u, random.uniform());
                          return s.pdf > 0 ? std::optional(s.wi) : std::nullopt;
                        },
                        [&model, values, wo](Vec3 wi) { return model.pdf(values, wo, wi); }});
    }
  expect_samplers_match(family, 1e-3, 2026);
}

template <Slopes kind>
void expect_cover(const Roughness& roughness) {
  const Facets<kind> facets(roughness);
  const auto patch = [&](double z, Vec2 turned) {
    const double r = std::sqrt(1 - z * z);
    return facets.density_of_normals({r * turned.x, r * turned.y, z}) * z;
  };
  double sum = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      sum += integrate_patch(patch, i / 8.0, (i + 1) / 8.0, j * pi / 4, (j + 1) * pi / 4, 1e-6);
  EXPECT_NEAR(sum, 1, 2e-4) << roughness.alpha << " " << roughness.anisotropy;
}
TEST(Facets, CoverTheirPlaneOnce) {
  for (const Roughness& roughness : {Roughness{0.1, 0, 0}, Roughness{0.5, 0.8, 0.4}, Roughness{1, 1, -2}}) {
    expect_cover<Slopes::ggx>(roughness);
    expect_cover<Slopes::beckmann>(roughness);
  }
}

// The lobe by Walter et al. 2007 and Heitz 2014 as printed, with slopes, angles and Lambda: an independent way.
double printed_lobe(Slopes kind, const Roughness& roughness, Vec3 wo, Vec3 wi) {
  const double au = roughness.alpha, av = roughness.across(), turn = roughness.azimuth_rad;
  const auto cosine_to_u = [&](Vec3 w) { return std::cos(std::atan2(w.y, w.x) - turn); };
  const auto lambda = [&](Vec3 w) {  // equations 72 and 66, roughness in the direction of w: equation 80
    const double c = cosine_to_u(w), alpha = std::sqrt(c * c * au * au + (1 - c * c) * av * av);
    const double a = 1 / (alpha * std::tan(std::acos(w.z)));
    if (kind == Slopes::ggx) return (-1 + std::sqrt(1 + 1 / (a * a))) / 2;
    return (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(pi));
  };
  const Vec3 h = normalized(wo + wi);
  const double c = cosine_to_u(h), t2 = std::pow(std::tan(std::acos(h.z)), 2);
  const double r2 = t2 * (c * c / (au * au) + (1 - c * c) / (av * av));
  const double slopes = kind == Slopes::ggx ? 1 / ((1 + r2) * (1 + r2)) : std::exp(-r2);
  const double d = slopes / (pi * au * av * std::pow(h.z, 4));
  return d / (1 + lambda(wo) + lambda(wi)) / (4 * wo.z * wi.z);  // G2: equation 99
}
TEST(Facets, ReflectAsThePrintedFormulas) {
  Random random(31);
  for (int k = 0; k < 500; ++k) {
    const Roughness roughness{0.05 + 0.9 * random.uniform(), random.uniform(), random.uniform(-3, 3)};
    const Vec3 wo = at_zenith(1 + 85 * random.uniform(), 6 * random.uniform());
    const Vec3 wi = at_zenith(1 + 85 * random.uniform(), 6 * random.uniform());
    const Vec3 h = surface::half_vector(wo, wi);
    const Facets<Slopes::ggx> ggx(roughness);
    const Facets<Slopes::beckmann> beckmann(roughness);
    const double g = printed_lobe(Slopes::ggx, roughness, wo, wi),
                 b = printed_lobe(Slopes::beckmann, roughness, wo, wi);
    EXPECT_NEAR(ggx.reflection(wo, wi, h, ggx.area_seen(wo)), g, 1e-9 * g);
    EXPECT_NEAR(beckmann.reflection(wo, wi, h, beckmann.area_seen(wo)), b, 1e-8 * b + 1e-200);
  }
}

// Seen from its other side the same surface has opposite y: f there is f here of mirrored directions.
TEST(Facets, TurnTheOtherWaySeenFromInside) {
  for (const char* id : conductors) {
    const surface::Model& model = *surface::find(id);
    auto outside = conductor(gold_eta, gold_k, 0.3, 0.8, 0.6), inside = outside;
    inside.inside = true;
    const Vec3 wo = at_zenith(40, 0.3), wi = at_zenith(60, 2.5);
    const Rgb there = model.evaluate(inside, {wo.x, -wo.y, wo.z}, {wi.x, -wi.y, wi.z});
    EXPECT_NEAR(there.x, model.evaluate(outside, wo, wi).x, 1e-12 * there.x);
    EXPECT_GT(std::abs(there.x - model.evaluate(outside, {wo.x, -wo.y, wo.z}, {wi.x, -wi.y, wi.z}).x), 0.01 * there.x);
  }
}

TEST(Furnace, PerfectMirrorOfAnyRoughness) {
  for (const char* id : conductors)
    for (const auto& [alpha, anisotropy] :
         {std::pair{0.0, 0.0}, {0.02, 0.0}, {0.1, 0.0}, {0.4, 0.0}, {1.0, 0.0}, {0.1, 0.7}, {0.5, 1.0}, {1.0, 0.4}})
      for (const double zenith : {0.0, 45.0, 80.0}) {
        const surface::Model& model = *surface::find(id);
        const auto [reflected, error] = reflectance_by_sampling(model, mirror(alpha, anisotropy), at_zenith(zenith));
        const double tables = anisotropy > 0 ? 1e-2 : 3e-3;
        EXPECT_NEAR(reflected.x, 1, tables + 6 * error.x) << id << " " << alpha << " " << anisotropy << " " << zenith;
      }
}

TEST(Metal, AlbedoIsItsReflectance) {
  const surface::Model& metal = *surface::find("metal");
  for (const double alpha : {0.0, 0.05, 0.3, 0.9})
    for (const double anisotropy : {0.0, 0.6})
      for (const double zenith : {0.0, 50.0, 82.0}) {
        surface::Values copper;
        copper.v = {Rgb{0.95, 0.64, 0.54}, grey(alpha), grey(anisotropy), grey(0.2)};
        const auto [reflected, error] = reflectance_by_sampling(metal, copper, at_zenith(zenith));
        const Rgb stated = metal.albedo(copper, at_zenith(zenith));
        EXPECT_NEAR(reflected.x, stated.x, 5e-3 + 6 * error.x) << alpha << " " << anisotropy << " " << zenith;
        EXPECT_NEAR(reflected.z, stated.z, 5e-3 + 6 * error.z) << alpha << " " << anisotropy << " " << zenith;
      }
}

template <Slopes kind>
double lost_by_quadrature(const Roughness& roughness, Vec3 wo) {
  static const surface::SlopesGrid fine(kind, 64, 64, false);
  const Facets<kind> facets(roughness);
  const double seen = facets.area_seen(wo);
  double sum = 0;
  fine.over(facets, wo, [&](Vec3 h, double share) {
    const Vec3 wi = surface::mirrored(wo, h);
    if (wi.z > 0) sum += share * facets.reflection_weight(wo, wi, seen);
  });
  return 1 - sum;
}
// The tables of a mirror's loss between their nodes, against a finer quadrature.
template <Slopes kind>
void expect_tables(bool isotropic, double worst_limit, double rms_limit) {
  Random random(11);
  double worst = 0, squares = 0;
  constexpr int count = 40;
  for (int k = 0; k < count; ++k) {
    const double z = std::pow(random.uniform(), 2), r = std::sqrt(1 - z * z), phi = 6 * random.uniform();
    const Roughness roughness{0.04 + 0.96 * std::pow(random.uniform(), 2), isotropic ? 0.0 : random.uniform(), 0};
    const Vec3 wo{r * std::cos(phi), r * std::sin(phi), z};
    const double error = InterfaceLoss::mirror(kind, roughness).towards(wo) - lost_by_quadrature<kind>(roughness, wo);
    worst = std::max(worst, std::abs(error));
    squares += error * error;
  }
  EXPECT_LT(worst, worst_limit) << "isotropic " << isotropic;
  EXPECT_LT(std::sqrt(squares / count), rms_limit) << "isotropic " << isotropic;
}
TEST(InterfaceLoss, OfMirrorsAgreesWithQuadrature) {
  expect_tables<Slopes::ggx>(true, 4e-3, 1e-3);
  expect_tables<Slopes::beckmann>(true, 4e-3, 1e-3);
  expect_tables<Slopes::ggx>(false, 1e-2, 3e-3);
  expect_tables<Slopes::beckmann>(false, 1e-2, 3e-3);
}

}  // namespace
}  // namespace gonio::tests
