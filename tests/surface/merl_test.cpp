// Measured tables: what lies between cells, sampling, reflectance, and files that are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "cases.h"
#include "chi_square.h"
#include "data.h"
#include "merl_tables.h"
#include "surface/merl_table.h"

namespace gonio::tests {
namespace {

using surface::HalfAngles;
using surface::MeasuredTable;
using testing::HasSubstr;

constexpr std::array<std::size_t, 3> small = {24, 20, 30};

TEST(HalfAngles, ArcIsAtan2) {
  Random random(31);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.normal() * std::pow(10, random.uniform(-9, 0)), y = std::abs(random.normal());
    ASSERT_NEAR(surface::arc(y, x), std::atan2(y, x), 1e-15);
    ASSERT_NEAR(surface::arc(std::abs(x), y), std::atan2(std::abs(x), y), 4e-14 * std::atan2(std::abs(x), y));
  }
  EXPECT_EQ(surface::arc(0, 0), 0);
  EXPECT_EQ(surface::arc(0, -1), pi);
  EXPECT_EQ(surface::arc(1e-300, 0), pi / 2);
}

TEST(HalfAngles, InvertDirections) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const HalfAngles given{random.uniform(0.01, 1.5), random.uniform(0.01, 1.5), random.uniform(0.01, pi - 0.01)};
    const auto [wo, wi] = surface::directions_of(given);
    if (wo.z <= 0 || wi.z <= 0) continue;
    for (const HalfAngles& at : {surface::half_angles(wo, wi), surface::half_angles(wi, wo)}) {
      ASSERT_NEAR(at.theta_h, given.theta_h, 1e-9);
      ASSERT_NEAR(at.theta_d, given.theta_d, 1e-9);
      ASSERT_NEAR(at.phi_d, given.phi_d, 1e-9);
    }
  }
  const auto grazing = surface::half_angles({1, 0, 1e-300}, {-1, 0, 1e-300});
  EXPECT_TRUE(std::isfinite(grazing.theta_h) && grazing.theta_d <= pi / 2 && grazing.phi_d < pi);
}

TEST(MerlTable, GivesItsCellsBackAndIsLinearBetween) {
  Random random(2);
  io::MerlTable raw{small, {}};
  for (std::size_t i = 0; i < 3 * raw.cells(); ++i) raw.brdf_per_sr.push_back(random.uniform() * 0.3);
  const MeasuredTable table(raw, "t.binary");
  const auto cell = [&](std::size_t h, std::size_t d, std::size_t p) {
    const float* v = raw.brdf_per_sr.data() + 3 * ((h * small[1] + d) * small[2] + p);
    return Rgb{v[0], v[1], v[2]};
  };
  int seen = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t h = random.below(23), d = random.below(19), p = random.below(30), next = (p + 1) % 30;
    const auto at = [&](HalfAngles where) {
      const auto [wo, wi] = surface::directions_of(where);
      return wo.z > 0 && wi.z > 0 ? std::optional(table.evaluate(wo, wi)) : std::nullopt;
    };
    const auto here = at(middle_of(small, h, d, p));
    const double u = (h + 0.75) / small[0];
    const auto between = at({u * u * pi / 2, (d + 1) / 20.0 * pi / 2, (p + 1) / 30.0 * pi});
    if (!here || !between) continue;
    ASSERT_LE(norm(*here - cell(h, d, p)), 1e-5);
    const auto quad = [&](std::size_t k) {
      return (cell(k, d, p) + cell(k, d + 1, p) + cell(k, d, next) + cell(k, d + 1, next)) / 4;
    };
    ASSERT_LE(norm(*between - (quad(h) * 0.75 + quad(h + 1) * 0.25)), 1e-5);
    ++seen;
  }
  EXPECT_GT(seen, 1000);
}

// Trilinear interpolation of a table of the database's size, against the model it was made from.
TEST(MerlTable, OfFullSizeFollowsItsModel) {
  const surface::Model& model = *surface::find("coated-diffuse");
  const auto values = surface::values_of(model,
                                         {{"albedo", manifest::Parameter({0.6, 0.3, 0.1})},
                                          {"f0", manifest::Parameter(0.05)},
                                          {"alpha", manifest::Parameter(0.2)}},
                                         "varnish");
  const MeasuredTable table(varnish_table({90, 90, 180}, 0.2), "varnish");
  Random random(3);
  double squares = 0, worst = 0;
  int count = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 wo = at_zenith(80 * random.uniform()), wi = at_zenith(80 * random.uniform(), 2 * pi * random.uniform());
    const double expected = model.evaluate(values, wo, wi).x, error = table.evaluate(wo, wi).x / expected - 1;
    squares += error * error;
    worst = std::max(worst, std::abs(error));
    ++count;
  }
  EXPECT_LT(std::sqrt(squares / count), 1e-3);
  EXPECT_LT(worst, 0.02);
  for (const double zenith : {5.0, 40.0, 70.0, 80.0}) {
    const Vec3 wo = at_zenith(zenith);
    EXPECT_LE(norm(table.albedo(wo) - model.albedo(values, wo)), 0.004) << zenith;
  }
}

TEST(MerlTable, UnmeasuredCellsTakeTheirNeighbours) {
  io::MerlTable raw = merl_table_of(small, [](Vec3, Vec3) { return Rgb{0.2, 0.2, 0.2}; });
  EXPECT_TRUE(std::any_of(raw.brdf_per_sr.begin(), raw.brdf_per_sr.end(), [](float v) { return v < 0; }));
  const MeasuredTable table(raw, "flat");
  Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const Rgb f = table.evaluate(draw_direction(random), draw_direction(random));
    ASSERT_TRUE(f == Rgb{} || norm(f - Rgb{0.2, 0.2, 0.2}) < 1e-5);  // no cell of its rows: 0
  }
  EXPECT_NEAR(table.albedo_mean().x, 0.2 * pi, 0.01);
  for (const double zenith : {3.0, 45.0, 80.0})
    EXPECT_NEAR(table.albedo(at_zenith(zenith)).x, 0.2 * pi, 0.02) << zenith;
}

// Sidak-corrected, false alarms of the family: 1e-3.
TEST(MerlTable, SamplesByItsDensity) {
  std::vector<Sampler> family;
  for (const auto& [alpha, zenith] : {std::pair{0.05, 35.0}, std::pair{0.4, 85.0}}) {
    const auto table = std::make_shared<MeasuredTable>(varnish_table({12, 10, 12}, alpha), "varnish");
    const Vec3 wo = at_zenith(zenith);
    family.push_back({"alpha " + std::to_string(alpha) + " at " + std::to_string(zenith),
                      [=](Random& random) -> std::optional<Vec3> {
                        const Vec2 u{random.uniform(), random.uniform()};
                        const auto [wi, density] = table->sample(wo, u, random.uniform());
                        return density > 0 ? std::optional(wi) : std::nullopt;
                      },
                      [=](Vec3 wi) { return table->pdf(wo, wi); }});
  }
  expect_samplers_match(family, 1e-3, 77);
}

// The variance that is left after importance sampling, as samples that one per cent of error takes.
TEST(MerlTable, SamplingFollowsTheTable) {
  const surface::Model& model = *surface::find("merl");
  const ScratchFolder folder;
  io::write_merl(folder / "t.binary", varnish_table({90, 90, 60}, 0.1));
  surface::Values values = surface::values_of(model, {}, "s");
  const auto prepared = model.prepare(values, folder / "t.binary", "s");
  EXPECT_EQ(model.prepare(values, folder / "t.binary", "s"), prepared);  // read once
  values.prepared = prepared.get();
  for (const double zenith : {0.0, 45.0, 80.0}) {
    const Vec3 wo = at_zenith(zenith);
    Random random(5);
    double sum = 0, squares = 0;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
      const Vec2 u{random.uniform(), random.uniform()};
      const double w = mean(model.sample(values, wo, u, random.uniform()).weight);
      sum += w;
      squares += w * w;
    }
    const double average = sum / count, relative_variance = squares / count / (average * average) - 1;
    EXPECT_LT(relative_variance, 0.6) << zenith;
    const double error = std::sqrt(relative_variance / count) * average;
    EXPECT_NEAR(average, mean(model.albedo(values, wo)), 5 * error + 0.004) << zenith;
  }
}

TEST(MerlTable, RefusesWhatCannotBe) {
  const auto bright = merl_table_of(small, [](Vec3, Vec3) { return Rgb{1, 1, 1}; });  // reflects pi
  EXPECT_THROW(MeasuredTable(bright, "t"), Error);
  const surface::Model& model = *surface::find("merl");
  try {
    model.prepare({}, {}, "s.json#/surfaces/s");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("s.json#/surfaces/s: model \"merl\" needs a table"));
  }
}

}  // namespace
}  // namespace gonio::tests
