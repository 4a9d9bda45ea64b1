// What every registered surface must fulfil.
#include <gtest/gtest.h>

#include "cases.h"
#include "chi_square.h"

namespace gonio::tests {
namespace {

double largest(Rgb v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

TEST(EverySurface, DeclaresParametersWithBoundsAndMeaning) {
  ASSERT_FALSE(surface::all_models().empty());
  for (const surface::Model* model : surface::all_models()) {
    EXPECT_EQ(surface::find(model->info().id), model);
    EXPECT_FALSE(model->info().sentence.empty() || model->info().source.empty()) << model->info().id;
    EXPECT_LE(model->info().parameters.size(), surface::Values{}.v.size());
    for (const auto& p : model->info().parameters) {
      EXPECT_FALSE(p.unit.empty() || p.meaning.empty()) << model->info().id << " " << p.name;
      EXPECT_LT(p.lower, p.upper) << p.name;
      EXPECT_TRUE(!p.preset || (*p.preset >= p.lower && *p.preset <= p.upper)) << p.name;
    }
  }
  EXPECT_EQ(surface::find("no such model"), nullptr);
}

// False-alarm rate of the whole family: 1e-3.
TEST(EverySurface, SamplerDrawsFromItsDensity) {
  std::vector<Sampler> family;
  for (const SurfaceCase& c : surface_cases(2, 101))
    for (const double zenith : {20.0, 86.0}) {
      const Vec3 wo = at_zenith(zenith);
      family.push_back({c.name + " seen at " + std::to_string(zenith),
                        [c, wo](Random& random) -> std::optional<Vec3> {
                          const Vec2 u{random.uniform(), random.uniform()};
                          const auto s = c.model->sample(c.values, wo, u, random.uniform());
                          return s.pdf > 0 ? std::optional(s.wi) : std::nullopt;
                        },
                        [c, wo](Vec3 wi) { return c.model->pdf(c.values, wo, wi); }});
    }
  expect_samplers_match(family, 1e-3, 2026);
}

TEST(EverySurface, SampleStatesDensityAndWeight) {
  Random random(5);
  for (const SurfaceCase& c : surface_cases(6, 102))
    for (int k = 0; k < 2000; ++k) {
      const Vec3 wo = draw_direction(random);
      const Vec2 u{random.uniform(), random.uniform()};
      const auto s = c.model->sample(c.values, wo, u, random.uniform());
      if (s.pdf == 0) continue;
      ASSERT_NEAR(norm(s.wi), 1, 1e-12) << c.name;
      ASSERT_GT(s.wi.z, 0) << c.name;
      ASSERT_NEAR(s.pdf / c.model->pdf(c.values, wo, s.wi), 1, 1e-9) << c.name;
      const Rgb expected = c.model->evaluate(c.values, wo, s.wi) * (s.wi.z / s.pdf);
      ASSERT_LE(largest(s.weight - expected), 1e-9 * (1 + largest(expected))) << c.name;
    }
}

TEST(EverySurface, IsReciprocal) {
  Random random(6);
  for (const SurfaceCase& c : surface_cases(8, 103))
    for (int k = 0; k < 2000; ++k) {
      const Vec3 wo = draw_direction(random), wi = draw_direction(random);
      const Rgb there = c.model->evaluate(c.values, wo, wi), back = c.model->evaluate(c.values, wi, wo);
      ASSERT_LE(largest(there - back), 1e-9 * largest(there)) << c.name;
    }
}

TEST(EverySurface, IsFiniteAndNeverNegative) {
  Random random(7);
  const auto sound = [](Rgb v) { return is_finite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0; };
  for (const SurfaceCase& c : surface_cases(40, 104))
    for (int k = 0; k < 1000; ++k) {
      const Vec3 wo = draw_direction(random), wi = draw_direction(random);
      ASSERT_TRUE(sound(c.model->evaluate(c.values, wo, wi))) << c.name;
      ASSERT_TRUE(sound(c.model->albedo(c.values, wo))) << c.name;
      const double density = c.model->pdf(c.values, wo, wi);
      ASSERT_TRUE(std::isfinite(density) && density >= 0) << c.name;
      const Vec2 u{random.uniform(), random.uniform()};
      const auto s = c.model->sample(c.values, wo, u, random.uniform());
      ASSERT_TRUE(sound(s.weight) && std::isfinite(s.pdf) && s.pdf >= 0 && is_finite(s.wi)) << c.name;
      const Vec3 mirror{-wo.x, -wo.y, wo.z};  // the peak, where opposite grazing directions cancel
      ASSERT_TRUE(sound(c.model->evaluate(c.values, wo, mirror))) << c.name;
    }
}

TEST(EverySurface, IsBlackBelowTheHorizon) {
  for (const SurfaceCase& c : surface_cases(2, 105))
    for (const double z : {0.0, -1e-12, -0.5, -1.0}) {
      const Vec3 below{std::sqrt(1 - z * z), 0, z}, above = at_zenith(40);
      EXPECT_EQ(largest(c.model->evaluate(c.values, above, below)), 0) << c.name;
      EXPECT_EQ(largest(c.model->evaluate(c.values, below, above)), 0) << c.name;
      EXPECT_EQ(c.model->pdf(c.values, above, below), 0) << c.name;
      EXPECT_EQ(c.model->pdf(c.values, below, above), 0) << c.name;
      EXPECT_EQ(c.model->sample(c.values, below, {0.3, 0.4}, 0.5).pdf, 0) << c.name;
    }
}

// Energy, and albedo() against the sampler. 3e-3 is the error of the tables of interface_albedo.h; six standard errors
// of the estimate (Student's t of seven degrees: false alarms below 1e-3 each) come on top; 0.02 covers a rough base
// under an interface, where albedo() says that it is an approximation.
TEST(EverySurface, ReflectsNoMoreThanItReceives) {
  for (const SurfaceCase& c : surface_cases(4, 106))
    for (const double zenith : {0.0, 45.0, 75.0, 88.0}) {
      const Vec3 wo = at_zenith(zenith);
      const auto [reflected, error] = reflectance_by_sampling(*c.model, c.values, wo);
      const Rgb stated = c.model->albedo(c.values, wo);
      EXPECT_LE(max_component(reflected), 1.003 + 6 * max_component(error)) << c.name << " at " << zenith;
      EXPECT_LE(max_component(stated), 1 + 1e-3) << c.name << " at " << zenith;
      EXPECT_LE(largest(reflected - stated), 0.02 + 6 * max_component(error)) << c.name << " at " << zenith;
    }
}

TEST(EverySurface, RefusesWhatIsNotItsOwn) {
  for (const surface::Model* model : surface::all_models()) {
    manifest::Parameters parameters;
    for (const auto& p : model->info().parameters) parameters[p.name] = p.lower;
    const auto values = surface::values_of(*model, parameters, "s.json#/surfaces/s");
    for (std::size_t i = 0; i < parameters.size(); ++i) EXPECT_EQ(values.scalar(i), model->info().parameters[i].lower);
    auto unknown = parameters;
    unknown["colour_of_magic"] = 1.0;
    EXPECT_THROW(surface::values_of(*model, unknown, "p"), std::runtime_error);
    auto beyond = parameters;
    beyond.begin()->second.value = {1e9};
    EXPECT_THROW(surface::values_of(*model, beyond, "p"), std::runtime_error);
    auto wrong_count = parameters;
    wrong_count.begin()->second.value = {0.5, 0.5};
    EXPECT_THROW(surface::values_of(*model, wrong_count, "p"), std::runtime_error);
  }
}

}  // namespace
}  // namespace gonio::tests
