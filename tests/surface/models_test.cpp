// What every registered surface must fulfil: each test runs once per model.
#include <gtest/gtest.h>

#include "cases.h"
#include "chi_square.h"

namespace gonio::tests {
namespace {

double largest(Rgb v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}
bool sound(Rgb v) {
  return is_finite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0;
}

class EverySurface : public testing::TestWithParam<const surface::Model*> {
 protected:
  static std::vector<SurfaceCase> cases(int random_cases, std::uint64_t seed) {
    return cases_of(*GetParam(), random_cases, seed);
  }
};
INSTANTIATE_TEST_SUITE_P(Registered, EverySurface,
                         testing::ValuesIn(surface::all_models().begin(), surface::all_models().end()), test_name);

TEST_P(EverySurface, DeclaresParametersWithBoundsAndMeaning) {
  const surface::Model* model = GetParam();
  EXPECT_EQ(surface::find(model->info().id), model);
  EXPECT_FALSE(model->info().sentence.empty() || model->info().source.empty());
  EXPECT_LE(model->info().parameters.size(), surface::Values{}.v.size());
  for (const auto& p : model->info().parameters) {
    EXPECT_FALSE(p.unit.empty() || p.meaning.empty()) << p.name;
    EXPECT_LT(p.lower, p.upper) << p.name;
    EXPECT_TRUE(!p.preset || (*p.preset >= p.lower && *p.preset <= p.upper)) << p.name;
  }
  EXPECT_EQ(surface::find("no such model"), nullptr);
}

// False-alarm rate over all models: 1e-3. Deltas are no part of the density: they count as failures here.
TEST_P(EverySurface, SamplerDrawsFromItsDensity) {
  std::vector<Sampler> family;
  for (const SurfaceCase& c : cases(1, 101))
    for (const double zenith : {20.0, 86.0}) {
      const Vec3 wo = at_zenith(zenith);
      family.push_back({c.name + " seen at " + std::to_string(zenith),
                        [c, wo](Random& random) -> std::optional<Vec3> {
                          const Vec2 u{random.uniform(), random.uniform()};
                          const auto s = c.model->sample(c.values, wo, u, random.uniform());
                          return s.pdf > 0 && !s.delta && !s.below ? std::optional(s.wi) : std::nullopt;
                        },
                        [c, wo](Vec3 wi) { return c.model->pdf(c.values, wo, wi); }});
    }
  expect_samplers_match(family, 1e-3, 2026, family.size() * surface::all_models().size());
}

// A delta comes as often as its pdf says, and pdf() and evaluate() leave it out. Binomial, at six standard deviations.
TEST_P(EverySurface, DeltasComeAsOftenAsTheySay) {
  constexpr int count = 3000;
  for (const SurfaceCase& c : cases(2, 107))
    for (const double zenith : {20.0, 86.0}) {
      const Vec3 wo = at_zenith(zenith);
      struct Seen {
        Vec3 wi;
        double pdf;
        int times;
      };
      std::vector<Seen> deltas;
      Random random(12);
      for (int k = 0; k < count; ++k) {
        const Vec2 u{random.uniform(), random.uniform()};
        const auto s = c.model->sample(c.values, wo, u, random.uniform());
        if (!(s.pdf > 0) || !s.delta) continue;
        ASSERT_LE(s.pdf, 1 + 1e-12) << c.name;
        const auto same =
            std::find_if(deltas.begin(), deltas.end(), [&](const Seen& d) { return d.wi == s.wi && d.pdf == s.pdf; });
        if (same == deltas.end())
          deltas.push_back({s.wi, s.pdf, 1});
        else
          ++same->times;
      }
      ASSERT_LE(deltas.size(), 8u) << c.name << ": deltas are few, or they are none";
      for (const Seen& d : deltas)
        EXPECT_NEAR(d.times, count * d.pdf, 6 * std::sqrt(count * d.pdf * (1 - d.pdf)) + 1) << c.name;
    }
}

TEST_P(EverySurface, SampleStatesDensityAndWeight) {
  Random random(5);
  for (const SurfaceCase& c : cases(4, 102))
    for (int k = 0; k < 1200; ++k) {
      const Vec3 wo = draw_direction(random);
      const Vec2 u{random.uniform(), random.uniform()};
      const auto s = c.model->sample(c.values, wo, u, random.uniform());
      if (s.pdf == 0) continue;
      ASSERT_NEAR(norm(s.wi), 1, 1e-12) << c.name;
      ASSERT_TRUE(sound(s.weight)) << c.name;
      if (s.below) continue;
      ASSERT_TRUE(s.wi.z > 0 || ((c.model->transmits() || c.model->thin()) && s.wi.z < 0)) << c.name;
      if (s.delta) continue;
      ASSERT_NEAR(s.pdf / c.model->pdf(c.values, wo, s.wi), 1, 1e-9) << c.name;
      const Rgb expected = c.model->evaluate(c.values, wo, s.wi) * (std::abs(s.wi.z) / s.pdf);
      ASSERT_LE(largest(s.weight - expected), 1e-9 * (1 + largest(expected))) << c.name;
    }
}

// f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2; with eta = eta_i / eta_o: f(wo, wi) eta^2 = f(wi, wo).
TEST_P(EverySurface, IsReciprocal) {
  Random random(6);
  for (const SurfaceCase& c : cases(6, 103))
    for (int k = 0; k < 1200; ++k) {
      const Vec3 wo = draw_direction(random), wi = draw_incidence(*c.model, random);
      const bool through = wi.z < 0;
      const Rgb there = c.model->evaluate(c.values, wo, wi) * (through ? c.values.eta * c.values.eta : Rgb{1, 1, 1});
      const Rgb back = through ? c.model->evaluate(from_beyond(c.values), beyond_frame(wi), beyond_frame(wo))
                               : c.model->evaluate(c.values, wi, wo);
      ASSERT_LE(largest(there - back), 1e-9 * largest(there)) << c.name << (through ? " through" : "");
    }
}

TEST_P(EverySurface, IsFiniteAndNeverNegative) {
  Random random(7);
  for (const SurfaceCase& c : cases(10, 104))
    for (int k = 0; k < 800; ++k) {
      const Vec3 wo = draw_direction(random), wi = draw_incidence(*c.model, random);
      ASSERT_TRUE(sound(c.model->evaluate(c.values, wo, wi))) << c.name;
      if (k % 20 == 0) {
        ASSERT_TRUE(sound(c.model->albedo(c.values, wo))) << c.name;
      }
      const double density = c.model->pdf(c.values, wo, wi);
      ASSERT_TRUE(std::isfinite(density) && density >= 0) << c.name;
      const Vec2 u{random.uniform(), random.uniform()};
      const auto s = c.model->sample(c.values, wo, u, random.uniform());
      ASSERT_TRUE(sound(s.weight) && std::isfinite(s.pdf) && s.pdf >= 0 && is_finite(s.wi)) << c.name;
      const Vec3 mirror{-wo.x, -wo.y, wo.z};  // the peak, where opposite grazing directions cancel
      ASSERT_TRUE(sound(c.model->evaluate(c.values, wo, mirror))) << c.name;
      ASSERT_TRUE(sound(c.model->evaluate(c.values, wo, -wo))) << c.name;
    }
}

TEST_P(EverySurface, IsBlackBelowTheHorizon) {
  for (const SurfaceCase& c : cases(2, 105))
    for (const double z : {0.0, -1e-12, -0.5, -1.0}) {
      const Vec3 below{std::sqrt(1 - z * z), 0, z}, above = at_zenith(40);
      EXPECT_EQ(largest(c.model->evaluate(c.values, below, above)), 0) << c.name;
      EXPECT_EQ(c.model->pdf(c.values, below, above), 0) << c.name;
      EXPECT_EQ(c.model->sample(c.values, below, {0.3, 0.4}, 0.5).pdf, 0) << c.name;
      if ((c.model->transmits() || c.model->thin()) && z < 0) continue;
      EXPECT_EQ(largest(c.model->evaluate(c.values, above, below)), 0) << c.name;
      EXPECT_EQ(c.model->pdf(c.values, above, below), 0) << c.name;
    }
}

// Error of the tables of interface_albedo.h and interface_loss.h: within 5e-3 but towards the horizon for anisotropic
// interfaces, most at total reflection, and for those between nearly equal indices, where lobes turn fast.
double table_error(double zenith) {
  return zenith > 70 ? 0.03 : 0.01;
}

// Energy, and albedo() against the sampler. Six standard errors of the estimate (Student's t of seven degrees: false
// alarms below 1e-3 each) come on top; 0.01 more covers a rough base under an interface, where albedo() says that it is
// an approximation, 0.05 what a coat throws back to its base. Where light leaves elsewhere than it entered the weight
// is what enters. An interface with a direction closes to 0.02 where it is a mixture (surface/models/glossy.cpp).
TEST_P(EverySurface, ReflectsNoMoreThanItReceives) {
  for (const SurfaceCase& c : cases(3, 106))
    for (const double zenith : {0.0, 45.0, 75.0, 88.0}) {
      const Vec3 wo = at_zenith(zenith);
      const auto [reflected, error] = reflectance_by_sampling(*c.model, c.values, wo);
      const Rgb stated = c.model->albedo(c.values, wo);
      const double coat =
          c.model->info().takes_base                                                                       ? 0.05
          : std::ranges::count(c.model->info().parameters, "anisotropy_0", &manifest::ParameterInfo::name) ? 0.01
                                                                                                           : 0;
      EXPECT_LE(max_component(reflected), 1 + coat + table_error(zenith) + 6 * max_component(error))
          << c.name << " at " << zenith;
      EXPECT_LE(max_component(stated), 1 + coat + 1e-3) << c.name << " at " << zenith;
      if (c.model->subsurface(c.values)) continue;
      EXPECT_LE(largest(reflected - stated), 0.01 + coat + table_error(zenith) + 6 * max_component(error))
          << c.name << " at " << zenith;
    }
}

// White furnace: a clear interface returns all light by one way or the other.
TEST_P(EverySurface, ReturnsAllLightWhereItClaimsTo) {
  const auto white = [](Rgb stated) { return stated == Rgb{1, 1, 1}; };
  for (const SurfaceCase& c : cases(3, 108))
    for (const double zenith : {0.0, 30.0, 60.0, 85.0}) {
      const Vec3 wo = at_zenith(zenith);
      if (!white(c.model->albedo(c.values, wo)) || c.model->subsurface(c.values)) continue;
      const auto [reflected, error] = reflectance_by_sampling(*c.model, c.values, wo);
      EXPECT_LE(largest(reflected - Rgb{1, 1, 1}), table_error(zenith) + 6 * max_component(error))
          << c.name << " at " << zenith;
    }
}

// Fits follow derivatives: central differences over h and h / 2 agree wherever a parameter lies inside its bounds. A
// step would double the difference. Piecewise linear tables may have a kink between the two: one in fifty is let pass.
TEST_P(EverySurface, ChangesSmoothlyWithItsParameters) {
  Random random(9);
  int checks = 0, kinks = 0;
  const int draws = GetParam()->info().takes_base ? 4 : 12;  // a coat samples its base anew for each value
  for (int k = 0; k < draws; ++k) {
    SurfaceCase c = completed({GetParam(), draw_values(*GetParam(), random), GetParam()->info().id}, random);
    const Vec3 wo = at_zenith(80 * random.uniform(), 6 * random.uniform());
    Vec3 wi = at_zenith(80 * random.uniform(), 6 * random.uniform());
    if (c.model->transmits() && k % 2 == 1) wi.z = -wi.z;
    const Rgb f = c.model->evaluate(c.values, wo, wi);
    const auto& parameters = c.model->info().parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      for (int component = 0; component < (parameters[i].components == 3 ? 3 : 1); ++component) {
        const double x = c.values.v[i][component];
        const double room = std::min({x - parameters[i].lower, parameters[i].upper - x, std::abs(x) + 1e-3});
        const auto at = [&](double value) {
          SurfaceCase moved = c;
          Rgb& v = moved.values.v[i];
          if (parameters[i].components == 1)
            v = {value, value, value};
          else
            (component == 0 ? v.x : component == 1 ? v.y : v.z) = value;
          if (c.prepared) {
            const bool reads = c.model->info().attachment != manifest::Attachment::none;
            moved.prepared = c.model->prepare(moved.values, reads ? file_for(c.model->info()) : "", c.name);
            moved.values.prepared = moved.prepared.get();
          }
          return c.model->evaluate(moved.values, wo, wi);
        };
        const double h = 1e-4 * room;
        if (!(h > 0)) continue;
        const Rgb wide = (at(x + h) - at(x - h)) / (2 * h), narrow = (at(x + h / 2) - at(x - h / 2)) / h;
        ASSERT_TRUE(is_finite(wide) && is_finite(narrow)) << parameters[i].name;
        ++checks;
        if (largest(wide - narrow) > 1e-4 * largest(narrow) + 1e-9 * largest(f) / h) ++kinks;
      }
  }
  EXPECT_LE(kinks, 1 + checks / 50) << "of " << checks;
}

TEST_P(EverySurface, RefusesWhatIsNotItsOwn) {
  const surface::Model* model = GetParam();
  manifest::Parameters parameters;
  for (const auto& p : model->info().parameters) parameters[p.name] = p.lower;
  const auto values = surface::values_of(*model, parameters, "s.json#/surfaces/s");
  for (std::size_t i = 0; i < parameters.size(); ++i) EXPECT_EQ(values.scalar(i), model->info().parameters[i].lower);
  auto unknown = parameters;
  unknown["colour_of_magic"] = 1.0;
  EXPECT_THROW(surface::values_of(*model, unknown, "p"), std::runtime_error);
  if (parameters.empty()) return;
  auto beyond = parameters;
  beyond.begin()->second.value = {1e12};
  EXPECT_THROW(surface::values_of(*model, beyond, "p"), std::runtime_error);
  auto wrong_count = parameters;
  wrong_count.begin()->second.value = {0.5, 0.5};
  EXPECT_THROW(surface::values_of(*model, wrong_count, "p"), std::runtime_error);
}

}  // namespace
}  // namespace gonio::tests
