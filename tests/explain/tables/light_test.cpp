// Irradiance over a plane: lamps of the manifest against what was put in.
#include "manifest/sections/light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "explain/tables/lamp_state.h"
#include "light/irradiance.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

// A 9 x 9 grid of 40 cm at three heights, 0.3 % noise.
World plane_world(std::uint64_t seed, const std::string& light, const std::function<double(Vec3)>& irradiance) {
  World w;
  w.columns = {{"x_m", "m"}, {"y_m", "m"}, {"z_m", "m"}, {"e", "W/m^2"}, {"e_sigma", "W/m^2"}};
  w.rest = R"("model": "light", "light": "lamp", "observed": ["e"], "sigma": ["e_sigma"])";
  w.sections = "\"lights\": {\"lamp\": " + light + "},";
  Random random(seed, 9);
  for (const double z : {0.0, 0.1, 0.2})
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) {
        const Vec3 p{0.05 * i, 0.05 * j, z};
        const double e = irradiance(p);
        w.rows.push_back({p.x, p.y, p.z, e * (1 + 0.003 * random.normal()), 0.003 * e});
      }
  return w;
}

const char* const point_lamp = R"({"model": "point", "position_m": [0.1, -0.05, 0.8],
                                   "watt_per_sr": {"value": 2, "free": true, "min": 0}})";

double point_at(Vec3 lamp, double intensity, Vec3 p) {
  const Vec3 arm = lamp - p;
  return intensity * arm.z / std::pow(dot(arm, arm), 1.5);
}

TEST(LightTable, APointLampHasNothingToExplain) {
  const World w = plane_world(1, point_lamp, [](Vec3 p) { return point_at({0.1, -0.05, 0.8}, 2.3, p); });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "") << e.sentence;
  manifest::Document document = w.document();
  problem.apply(e, document);
  EXPECT_NEAR(document.lights.at("lamp").parameters.at("watt_per_sr").scalar(), 2.3, 0.01);
}

TEST(LightTable, ALampThatWasBelievedInfinitelyFarIsNear) {
  const World w = plane_world(2, R"({"model": "directional", "towards": [0, 0, 1],
                                     "watt_per_m2": {"value": 1, "free": true, "min": 0}})",
                              [](Vec3 p) {
                                return point_at({0, 0, 2.1}, 4, p);
                              });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "light.inverse-square") << e.sentence;
  const Estimate* nearness = estimate_of(problem, e, "lamp/nearness_per_m");
  ASSERT_NE(nearness, nullptr);
  EXPECT_NEAR(nearness->value, 1 / 2.0, 4 * nearness->sigma);  // from the middle of the grid, 10 cm up
  EXPECT_NEAR(nearness->value, 1 / 2.0, 0.02);
}

TEST(LightTable, ALobeIsNamed) {
  const World w = plane_world(3, R"({"model": "led", "position_m": [0, 0, 0.6], "direction": [0, 0, -1], "exponent": 1,
                                     "watt_per_sr": {"value": 1, "free": true, "min": 0}})",
                              [](Vec3 p) {
                                const Vec3 arm = Vec3{0, 0, 0.6} - p;
                                return point_at({0, 0, 0.6}, 1.5, p) * std::pow(arm.z / norm(arm), 3.0);
                              });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "light.lobe") << e.sentence;
  const Estimate* exponent = estimate_of(problem, e, "lamp/exponent");
  ASSERT_NE(exponent, nullptr);
  EXPECT_NEAR(exponent->value, 2, 4 * exponent->sigma);
}

// A spot's cone with a soft edge, which no power of the cosine follows.
TEST(LightTable, ASpotIsALobe) {
  const Vec3 lamp{0.1, -0.05, 0.8}, axis = normalized(Vec3{0, 0, 0.1} - lamp);  // at the middle of the grid
  const World w = plane_world(7, point_lamp, [&](Vec3 p) {
    const double cosine = dot(normalized(p - lamp), axis);
    const double t = std::clamp((cosine - std::cos(0.55)) / (std::cos(0.11) - std::cos(0.55)), 0.0, 1.0);
    return point_at(lamp, 1.5, p) * (t * t * (3 - 2 * t));
  });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "light.lobe") << e.sentence;
  const Estimate* outer = estimate_of(problem, e, "lamp with a cone/outer_rad");
  ASSERT_NE(outer, nullptr) << e.sentence;
  EXPECT_NEAR(outer->value, 0.55, 4 * outer->sigma + 0.01);
}

TEST(LightTable, AmbientLightIsNamedOrToldToLookLikeAnOffset) {
  const World w = plane_world(4, point_lamp, [](Vec3 p) { return point_at({0.1, -0.05, 0.8}, 2.3, p) + 0.4; });
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  ASSERT_EQ(e.named.size(), 1u) << e.sentence;
  const std::string id = problem.candidates()[e.named[0]].id();
  EXPECT_TRUE(id == "light.ambient" || id == "sensor.black-offset") << id;
  ASSERT_FALSE(e.not_told_apart.empty());  // one exposure: nothing separates the two
}

// A window as far away as the lamp. Its declaration may come with pictures; without it nothing can be named.
TEST(LightTable, ASecondSourceIsNamedAndTheIntensityStaysPositive) {
  if (mechanism::find_mechanism("light.second-source") == nullptr)
    GTEST_SKIP() << "light.second-source is not declared";
  World w = plane_world(5, point_lamp, [](Vec3 p) {
    return point_at({0.1, -0.05, 0.8}, 2.3, p) + point_at({-0.5, 0.3, 0.6}, 0.5, p);
  });
  const auto at = w.sections.find(", \"min\": 0");
  w.sections.erase(at, 10);  // the lamp's own bounds hold
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  ASSERT_FALSE(e.named.empty()) << e.sentence;
  EXPECT_EQ(problem.candidates()[e.named[0]].id(), "light.second-source") << e.sentence;
}

TEST(LightTable, IrradianceOfALampWithoutAClosedFormIsThatOfItsFormula) {
  manifest::Document document = manifest::parse_document(
      R"({"gonio": 1, "lights": {"l": {"model": "disc", "position_m": [0, 0, 0.5], "direction": [0, 0, -1],
          "radius_m": 0.1, "watt_per_sr": 3}}})",
      "t", ".");
  const LampState state(document, {"l"}, {0, 0, 0}, {}, "here");
  for (const double b : {0.0, 0.1, 0.3}) {
    const Rgb radiance = Rgb{3, 3, 3} * (1 / (pi * 0.01));
    const double expected = light::disc_irradiance(radiance, 0.1, 0.5, b).x;
    EXPECT_NEAR(LampLight(state.lamps()[0]).irradiance({b, 0, 0}, {0, 0, 1}).x, expected, 1e-3 * expected);
  }
}

}  // namespace
}  // namespace gonio::explain::tables::tests
