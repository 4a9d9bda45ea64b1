// What every registered light must fulfil.
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
Vec3 draw_point(Random& random) {
  return {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
}

TEST(EveryLight, DeclaresParametersWithMeaning) {
  ASSERT_FALSE(light::all_models().empty());
  for (const light::Model* model : light::all_models()) {
    EXPECT_EQ(light::find(model->info().id), model);
    EXPECT_FALSE(model->info().sentence.empty() || model->info().source.empty()) << model->info().id;
    for (const auto& p : model->info().parameters) {
      EXPECT_FALSE(p.unit.empty() || p.meaning.empty()) << model->info().id << " " << p.name;
      EXPECT_LT(p.lower, p.upper) << p.name;
    }
  }
  EXPECT_EQ(light::find("no such model"), nullptr);
}

// Bins about the middle of what the light fills, half as wide again, unless that is most of the sphere.
void narrow(Sampler& sampler, Random& random) {
  Vec3 sum;
  std::vector<Vec3> drawn;
  for (int k = 0; k < 2000; ++k)
    if (const auto w = sampler.draw(random)) {
      drawn.push_back(*w);
      sum += *w;
    }
  const Vec3 axis = normalized(sum);
  double least = 1;
  for (const Vec3 w : drawn) least = std::min(least, dot(axis, w));
  least = 1 - 1.5 * (1 - least);
  if (least < 0) return;
  sampler.axis = axis;
  sampler.least_cosine = least;
}

// False-alarm rate of the whole family: 1e-3.
TEST(EveryLight, SamplerDrawsFromItsDensity) {
  const auto cases = light_cases(4, 201);
  std::vector<Sampler> family;
  Random random(17);
  for (const LightCase& c : cases) {
    const Vec3 point = draw_point(random);
    const light::Emitter* emitter = c.emitter.get();
    const auto first = emitter->sample(point, {0.5, 0.5});
    if (!first.valid || first.delta) continue;
    Sampler sampler{c.name,
                    [emitter, point](Random& r) -> std::optional<Vec3> {
                      const double u = r.uniform();
                      const auto s = emitter->sample(point, {u, r.uniform()});
                      return s.valid ? std::optional(s.direction) : std::nullopt;
                    },
                    [emitter, point](Vec3 w) { return emitter->hit(point, w).pdf; }};
    narrow(sampler, random);
    family.push_back(std::move(sampler));
  }
  expect_samplers_match(family, 1e-3, 77);
}

TEST(EveryLight, SampleAndHitAgree) {
  Random random(18);
  for (const LightCase& c : light_cases(20, 202))
    for (int k = 0; k < 300; ++k) {
      const Vec3 point = draw_point(random);
      const double u = random.uniform(0.001, 0.999);
      const auto s = c.emitter->sample(point, {u, random.uniform(0.001, 0.999)});
      if (!s.valid) continue;
      ASSERT_NEAR(norm(s.direction), 1, 1e-12) << c.name;
      ASSERT_TRUE(sound(s.weight)) << c.name;
      const auto hit = c.emitter->hit(point, s.direction);
      if (s.delta) {
        ASSERT_EQ(largest(hit.radiance), 0) << c.name;
        ASSERT_EQ(s.pdf, 0) << c.name;
        continue;
      }
      ASSERT_NEAR(hit.pdf / s.pdf, 1, 1e-9) << c.name;
      ASSERT_LE(largest(s.weight * s.pdf - hit.radiance), 1e-9 * largest(hit.radiance) + 1e-300) << c.name;
      ASSERT_EQ(std::isfinite(s.distance_m), !c.emitter->infinite()) << c.name;
      if (c.emitter->infinite()) continue;
      ASSERT_NEAR(s.distance_m, hit.distance_m, 1e-5 * (1 + hit.distance_m)) << c.name;
    }
}

TEST(EveryLight, IsFiniteAtTheCornersOfItsRandomNumbers) {
  Random random(19);
  const double edge[] = {1e-12, 0.25, 0.5, 0.75, 1 - 1e-12};
  for (const LightCase& c : light_cases(20, 203))
    for (const double u : edge)
      for (const double v : edge) {
        const auto s = c.emitter->sample(draw_point(random), {u, v});
        ASSERT_TRUE(!s.valid || (sound(s.weight) && is_finite(s.direction) && std::isfinite(s.pdf))) << c.name;
      }
}

TEST(EveryLight, RefusesWhatIsNotItsOwn) {
  Random random(20);
  for (const light::Model* model : light::all_models()) {
    const light::Attachment file = attachment_of(model->info());
    auto unknown = draw_parameters(model->info(), random), wrong_count = unknown;
    unknown["colour_of_magic"] = 1.0;
    EXPECT_THROW(model->prepare(unknown, file, "p"), std::runtime_error);
    wrong_count.begin()->second.value = {0.5, 0.5};
    EXPECT_THROW(model->prepare(wrong_count, file, "p"), std::runtime_error);
    if (model->info().attachment == manifest::Attachment::none) continue;
    EXPECT_THROW(model->prepare(draw_parameters(model->info(), random), {}, "p"), std::runtime_error);
  }
}

}  // namespace
}  // namespace gonio::tests
