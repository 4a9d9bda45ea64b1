// Lights against closed forms, and the mechanisms that edit them.
#include <gtest/gtest.h>

#include "cases.h"
#include "data.h"
#include "io/picture.h"
#include "light/irradiance.h"
#include "light/turn.h"
#include "manifest/sections/light.h"

namespace gonio::tests {
namespace {

std::unique_ptr<light::Emitter> prepared(const manifest::Light& light) {
  return light::find(light.model)->prepare(light.parameters, {}, "p");
}
manifest::Light lamp(Vec3 position_m, Rgb watt_per_sr, std::optional<double> radius_m = {}) {
  manifest::Light light;
  light.parameters["position_m"] = std::vector<double>{position_m.x, position_m.y, position_m.z};
  light.parameters["watt_per_sr"] = std::vector<double>{watt_per_sr.x, watt_per_sr.y, watt_per_sr.z};
  if (radius_m) light.parameters["radius_m"] = *radius_m;
  return light;
}
std::unique_ptr<light::Emitter> surround(std::shared_ptr<const io::Image> picture, double rotation_rad = 0) {
  return light::find("lat-long")->prepare({{"rotation_rad", rotation_rad}}, {std::move(picture), {}}, "p");
}
Vec3 tilted(double degrees) {
  return {std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180)};
}

TEST(PointLight, InverseSquareToTheLastDigits) {
  const auto emitter = prepared(lamp({0, 0, 0}, {3, 2, 1}));
  for (const double d : {1e-3, 0.1, 1.0, 7.5, 1e4}) {
    const auto s = emitter->sample({0, 0, -d}, {0.3, 0.8});
    EXPECT_NEAR(s.weight.x * d * d, 3, 1e-12);
    EXPECT_DOUBLE_EQ(s.distance_m, d);
    EXPECT_NEAR(light::point_irradiance({3, 2, 1}, {0, 0, 0}, {0, 0, -d}, tilted(60)).y * d * d, 1, 1e-12);
  }
}

TEST(SphereLight, IrradianceAboveAcrossAndBelowTheHorizon) {
  const Vec3 centre{0, 0, 0.5}, point{0, 0, 0};
  const Rgb intensity{2, 1, 0.5};
  for (const double radius : {0.01, 0.1, 0.3, 0.49})
    for (const double tilt : {0.0, 40.0, 75.0, 85.0, 90.0, 95.0, 110.0, 140.0, 179.0}) {
      const auto emitter = prepared(lamp(centre, intensity, radius));
      const Rgb sampled = irradiance_by_sampling(*emitter, point, tilted(tilt));
      const Rgb closed = light::sphere_irradiance(intensity, centre, radius, point, tilted(tilt));
      EXPECT_NEAR(sampled.x, closed.x, 2e-4 * intensity.x / (0.5 * 0.5)) << radius << " " << tilt;
      EXPECT_NEAR(sampled.z, closed.z, 2e-4 * intensity.z / (0.5 * 0.5)) << radius << " " << tilt;
    }
}

TEST(SphereLight, ClosedFormIsContinuousAtTheHorizon) {
  const double radius = 0.2, cut = std::asin(radius / 0.5) * 180 / pi;
  for (const double tilt : {90 - cut, 90 + cut})
    EXPECT_NEAR(light::sphere_irradiance({1, 1, 1}, {0, 0, 0.5}, radius, {}, tilted(tilt - 1e-6)).x,
                light::sphere_irradiance({1, 1, 1}, {0, 0, 0.5}, radius, {}, tilted(tilt + 1e-6)).x, 1e-6);
}

TEST(SphereLight, OfVanishingRadiusIsThePointLight) {
  const manifest::Light point = lamp({0.2, -0.3, 0.4}, {1, 2, 3});
  const auto bare = prepared(point), neutral = prepared(lamp({0.2, -0.3, 0.4}, {1, 2, 3}, 0));
  const auto tiny = prepared(lamp({0.2, -0.3, 0.4}, {1, 2, 3}, 1e-9));
  Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Vec3 at{random.uniform(-1, 1), random.uniform(-1, 1), -random.uniform()};
    const Vec2 u{random.uniform(), random.uniform()};
    const auto a = bare->sample(at, u), b = neutral->sample(at, u), c = tiny->sample(at, u);
    EXPECT_TRUE(a.delta && b.delta && !c.delta);
    EXPECT_EQ(a.weight, b.weight);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.distance_m, b.distance_m);
    EXPECT_NEAR(c.weight.y / a.weight.y, 1, 1e-12);
    EXPECT_NEAR(norm(c.direction - a.direction), 0, 1e-7);
  }
}

TEST(SphereLight, ShinesOutwardsOnly) {
  const auto emitter = prepared(lamp({0, 0, 0}, {1, 1, 1}, 0.5));
  EXPECT_FALSE(emitter->sample({0.1, 0, 0}, {0.5, 0.5}).valid);
  EXPECT_EQ(emitter->hit({0.1, 0, 0}, {0, 0, 1}).radiance, Rgb{});
  EXPECT_EQ(emitter->hit({0, 0, 2}, {0, 0, 1}).radiance, Rgb{});
  EXPECT_NEAR(emitter->hit({0, 0, 2}, {0, 0, -1}).distance_m, 1.5, 1e-12);
  EXPECT_NEAR(emitter->hit({0, 0, 2}, {0, 0, -1}).radiance.x, 1 / (pi * 0.25), 1e-12);
}

TEST(DirectionalLight, IrradianceOnAFacingPlane) {
  manifest::Light sun;
  sun.model = "directional";
  sun.parameters = {{"towards", std::vector<double>{0, 3, 4}}, {"watt_per_m2", std::vector<double>{1000, 900, 800}}};
  const auto s = prepared(sun)->sample({5, 6, 7}, {0.1, 0.2});
  EXPECT_NEAR(norm(s.direction - Vec3{0, 0.6, 0.8}), 0, 1e-15);
  EXPECT_EQ(s.weight, (Rgb{1000, 900, 800}));
  EXPECT_TRUE(s.delta && std::isinf(s.distance_m));
  sun.parameters["towards"] = std::vector<double>{0, 0, 0};
  EXPECT_THROW(prepared(sun), std::runtime_error);
}

TEST(UniformLight, IrradianceIsPiTimesRadiance) {
  const auto emitter = light::find("uniform")->prepare({{"radiance", std::vector<double>{0.1, 0.2, 0.3}}}, {}, "p");
  EXPECT_NEAR(irradiance_by_sampling(*emitter, {1, 2, 3}, tilted(33)).y, 0.2 * pi, 1e-4);
  EXPECT_TRUE(emitter->infinite());
}

TEST(LatLong, SolidAnglesSumToTheSphere) {
  auto white = std::make_shared<io::Image>(36, 17, std::vector<std::string>{"Y"});
  for (float& v : white->data) v = 1;
  const auto emitter = surround(white);
  Random random(4);
  for (int k = 0; k < 1000; ++k) {
    const double u = random.uniform();
    EXPECT_NEAR(emitter->sample({}, {u, random.uniform()}).weight.x, 4 * pi, 1e-9);
  }
  EXPECT_NEAR(irradiance_by_sampling(*emitter, {}, tilted(70)).x, pi, 1e-3);
}

// The top row looks up, the centre along +x, the left quarter along +y; rotation turns counter-clockwise seen from
// above.
TEST(LatLong, Orientation) {
  auto picture = std::make_shared<io::Image>(8, 4, std::vector<std::string>{"R", "G", "B"});
  for (int x = 0; x < 8; ++x) picture->at(x, 0, 2) = 5;  // zenith: blue
  picture->at(4, 2, 0) = 7;                              // right of the centre, below the horizon: red
  picture->at(2, 1, 1) = 9;                              // right of the left quarter, above the horizon: green
  const auto emitter = surround(picture);
  EXPECT_EQ(emitter->hit({}, normalized(Vec3{0.1, 0.1, 1})).radiance.z, 5);
  EXPECT_EQ(emitter->hit({}, normalized(Vec3{1, -0.1, -0.1})).radiance.x, 7);
  EXPECT_EQ(emitter->hit({}, normalized(Vec3{0.1, 1, 0.1})).radiance.y, 9);
  const auto turned = surround(picture, pi / 2);
  EXPECT_EQ(turned->hit({}, normalized(Vec3{0.1, 1, -0.1})).radiance.x, 7);
  EXPECT_EQ(turned->hit({}, normalized(Vec3{-1, 0.1, 0.1})).radiance.y, 9);
}

TEST(LatLong, RefusesPicturesThatAreNoRadiance) {
  auto negative = std::make_shared<io::Image>(4, 2, std::vector<std::string>{"Y"});
  negative->data[3] = -1;
  EXPECT_THROW(surround(negative), std::runtime_error);
  auto masks = std::make_shared<io::Image>(4, 2, std::vector<std::string>{"mask", "depth"});
  EXPECT_THROW(surround(masks), std::runtime_error);
}

TEST(LatLong, GraceCathedralLightsAnUpwardPlane) {
  GONIO_NEEDS_DATA("hdr/grace/grace_latlong.exr");
  const auto picture = std::make_shared<io::Image>(io::read_picture(data("hdr/grace/grace_latlong.exr")));
  const auto emitter = surround(picture);
  const Rgb e = irradiance_by_sampling(*emitter, {}, {0, 0, 1}, 2000);
  EXPECT_NEAR(0.2126 * e.x + 0.7152 * e.y + 0.0722 * e.z, 0.011166, 2e-5);
}

TEST(LightDirection, TurnsAtRightAnglesByTheAngleGiven) {
  Random random(6);
  for (int k = 0; k < 200; ++k) {
    const Vec3 d = normalized(Vec3{random.normal(), random.normal(), random.normal()});
    EXPECT_EQ(light::turned(d, 0, 0), d);
    for (const Vec2 tilt : {Vec2{0.1, 0}, Vec2{0, -0.2}, Vec2{0.05, 0.3}})
      EXPECT_NEAR(std::acos(dot(d, light::turned(d, tilt.x, tilt.y))), norm(tilt), 1e-7);
  }
  // As written down: about +z the axes are x and y themselves.
  EXPECT_NEAR(light::turned({0, 0, 1}, 0.1, 0).y, -std::sin(0.1), 1e-12);
  EXPECT_NEAR(light::turned({0, 0, 1}, 0, 0.1).x, std::sin(0.1), 1e-12);
}

TEST(LightDirection, PositionsKeepTheirDistanceFromTheCentre) {
  const Vec3 centre{0.1, 0.2, 0.3}, position{0.2, -0.3, 0.9};
  const Vec3 moved = light::turned_about(position, 0.03, -0.04, centre);
  EXPECT_NEAR(norm(moved - centre), norm(position - centre), 1e-12);
  EXPECT_NEAR(std::acos(dot(moved - centre, position - centre) / dot(position - centre, position - centre)), 0.05,
              1e-9);
  EXPECT_EQ(light::turned_about(position, 0, 0, centre), position);
  EXPECT_EQ(light::turned_about(centre, 0.1, 0.1, centre), centre);
}

}  // namespace
}  // namespace gonio::tests
