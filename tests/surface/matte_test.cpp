// The rough laws of surface/matte.h against what they stand for: V-grooves added up facet by facet (Oren & Nayar 1994,
// section 4), and the law as Cycles' Diffuse BSDF writes it. The registry's tests hold reciprocity and energy.
#include "surface/matte.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geom/angle.h"

namespace gonio::surface {
namespace {

Vec3 direction(double theta_deg, double phi_deg) {
  const double t = theta_deg * degree, p = phi_deg * degree;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

// pi f / rho of facets whose slope angles are normally distributed about zero, with what grooves mask and shadow
// (their equations 12, 13, 19), light that has met one facet.
double grooves_added_up(Vec3 wo, Vec3 wi, double sigma) {
  constexpr int slopes = 300, turns = 360;
  double sum = 0, weight = 0;
  for (int i = 0; i < slopes; ++i)
    for (int j = 0; j < turns; ++j) {
      const double theta = pi / 2 * (i + 0.5) / slopes, phi = 2 * pi * (j + 0.5) / turns;
      const Vec3 a{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
      const double w = std::exp(-theta * theta / (2 * sigma * sigma)) * std::sin(theta);
      weight += w;
      const double lit = dot(a, wi), seen = dot(a, wo);
      if (lit <= 0 || seen <= 0) continue;
      const double open = std::min({1.0, 2 * wi.z * a.z / lit, 2 * wo.z * a.z / seen});
      sum += w * lit * seen / (a.z * wo.z * wi.z) * open;
    }
  return sum / weight;
}

TEST(Matte, TheFullLawFollowsGrooves) {
  const double white = 1e-9;  // so dark that light between facets does not count
  for (const double sigma : {10.0, 20.0, 30.0, 40.0})
    for (const auto& [incidence, exitance, turn] :
         {std::array{0.0, 0.0, 0.0}, {30.0, 60.0, 0.0}, {60.0, 60.0, 180.0}, {75.0, 30.0, 0.0}, {45.0, 70.0, 120.0}}) {
      const Vec3 wi = direction(incidence, 0), wo = direction(exitance, turn);
      const double added = grooves_added_up(wo, wi, sigma * degree);
      const double full = Matte(sigma * degree, 1).weight({white, white, white}, wo, wi).x / white;
      EXPECT_NEAR(full, added, 0.05 * added) << sigma << " " << incidence << " " << exitance << " " << turn;
    }
  // Equation 30 says nothing of what lies opposite to the lamp, where it is 80 % too bright.
  const Vec3 wi = direction(60, 0), wo = direction(60, 180);
  EXPECT_GT(Matte(30 * degree, 0).weight({1, 1, 1}, wo, wi).x, 1.7 * grooves_added_up(wo, wi, 30 * degree));
}

TEST(Matte, LightBetweenFacetsGoesWithTheSquareOfTheAlbedo) {
  const Vec3 wi = direction(40, 0), wo = direction(50, 90);
  const Matte rough(0.5, 1);
  const double dark = rough.weight({0.1, 0.1, 0.1}, wo, wi).x / 0.1,
               light = rough.weight({0.9, 0.9, 0.9}, wo, wi).x / 0.9;
  const double s = 0.25, scale = 0.8 * 0.17 * s / (s + 0.13);  // cos(90) = 0
  EXPECT_NEAR(light - dark, scale, 0.05 * scale);
  EXPECT_FALSE(rough.proportional());
}

// intern/cycles/kernel/closure/bsdf_oren_nayar.h: a = 1 / (pi + (3 pi - 4) / 6 sigma), b = sigma a, is = nl (a + b t).
TEST(Matte, FujiisLawIsThatOfCycles) {
  for (const double sigma : {0.2, 0.8, 1.0})
    for (const double turn : {0.0, 60.0, 180.0}) {
      const Vec3 wi = direction(35, 0), wo = direction(65, turn);
      const double a = 1 / (pi + (3 * pi - 4) / 6 * sigma);
      double t = dot(wo, wi) - wo.z * wi.z;
      if (t > 0) t /= std::max(wo.z, wi.z);
      EXPECT_NEAR(Matte(sigma, 2).brdf({1, 1, 1}, wo, wi).y, a + sigma * a * t, 1e-12) << sigma << " " << turn;
    }
}

TEST(Matte, EveryFormIsLambertsLawWhereItIsSmooth) {
  for (const double form : {0.0, 1.0, 2.0}) {
    const Vec3 wi = direction(35, 10), wo = direction(65, 200);
    EXPECT_EQ(Matte(0, form).brdf({0.3, 0.5, 0.7}, wo, wi), (Rgb{0.3, 0.5, 0.7} * (1 / pi))) << form;
  }
}

}  // namespace
}  // namespace gonio::surface
