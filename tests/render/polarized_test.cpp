// Rendered Stokes vectors against closed forms: interfaces, plates, prisms and mirrors under a polarized sky.
//
// Smooth interfaces choose between reflection and refraction at random. The forms are held without that noise: all
// paths are added up, each by its probability (AllPaths). Two tests hold the path tracer itself to the same forms
// within its own error; seeds are fixed.
#include <gtest/gtest.h>

#include <cmath>

#include "polarized_forms.h"
#include "polarized_scenes.h"

namespace gonio::tests {
namespace {

// Directions in a picture: a field along `x` of a sky that the camera sees without anything between.
TEST(CameraStokes, AnglesGrowCounterClockwiseInThePicture) {
  const Vec3 forward{0, 0, 1}, right{1, 0, 0}, up{0, -1, 0};  // the picture's y axis points down
  const auto seen = [&](Vec3 x, const Stokes& stokes) {
    scene::Scene scene;
    scene.views = {one_pixel({0, 0, 0}, forward, right)};
    add_emitter(scene, std::make_shared<Sky>(forward, x, stokes));
    return all_paths(scene);
  };
  expect_near(seen(right, along), {{1, 1, 0, 0}});
  expect_near(seen(up, along), {{1, -1, 0, 0}});
  expect_near(seen(normalized(right + up), along), {{1, 0, 1, 0}});
  expect_near(seen(normalized(right - up), along), {{1, 0, -1, 0}});
  for (double angle = 0.1; angle < 3; angle += 0.4)
    expect_near(seen(right * std::cos(angle) + up * std::sin(angle), along),
                {{1, std::cos(2 * angle), std::sin(2 * angle), 0}});
  expect_near(seen(right, circular), {{1, 0, 0, 1}});
  expect_near(seen(up, circular), {{1, 0, 0, 1}});
}

TEST(CameraStokes, RollOfTheCamera) {
  const Vec3 forward{0, 0, 1};
  for (double roll = 0; roll < 3; roll += 0.5) {
    scene::Scene scene;
    scene.views = {one_pixel({0, 0, 0}, forward, {std::cos(roll), std::sin(roll), 0})};
    add_emitter(scene, std::make_shared<Sky>(forward, Vec3{1, 0, 0}, along));
    // The picture turned clockwise, by `roll` from x towards y, which points down: the field seems turned the other
    // way.
    expect_near(all_paths(scene), {{1, std::cos(2 * roll), std::sin(2 * roll), 0}});
  }
}

TEST(PolarizedRendering, ReflectionOfGlass) {
  const double eta = 1.5;
  for (const double angle : {0.0, 0.3, 0.7, std::atan(eta), 1.2, 1.45})
    for (const Stokes& in : {natural, along, slanted, circular}) {
      // A thick block, so that what enters never comes back: its lower face is met from inside by what is refracted,
      // but the sky there is dark.
      const Interface face(angle, eta);
      scene::Scene scene =
          plate("dielectric", {{"eta", eta}, {"alpha", 0.0}, {"sigma_a_per_m", 100.0}}, angle, {0, 0, 1}, in, 1);
      expect_near(all_paths(scene), element(face.rs(), face.rp(), face.s * face.p, in));
    }
}

TEST(PolarizedRendering, BrewstersAngle) {
  const double eta = 1.5;
  scene::Scene scene =
      plate("dielectric", {{"eta", eta}, {"alpha", 0.0}, {"sigma_a_per_m", 100.0}}, std::atan(eta), {0, 0, 1}, natural);
  const Stokes found = all_paths(scene);
  EXPECT_GT(found.s[0], 0.07);
  EXPECT_NEAR(found.s[1] / found.s[0], 1, 1e-12);
  EXPECT_NEAR(found.s[2], 0, 1e-12);
}

TEST(PolarizedRendering, PlateOfGlass) {
  const double eta = 1.5, sigma_a = 0.2;
  for (const double angle : {0.4, 1.0})
    for (const Stokes& in : {natural, along, slanted}) {
      const double pass = std::exp(-sigma_a / std::sqrt(1 - std::pow(std::sin(angle) / eta, 2)));
      const Plate expected(angle, eta, pass);
      const manifest::Parameters glass{{"eta", eta}, {"alpha", 0.0}, {"sigma_a_per_m", sigma_a}};
      expect_near(all_paths(plate("dielectric", glass, angle, {0, 0, 1}, in)),
                  element(expected.rs, expected.rp, expected.cross_r, in));
      expect_near(all_paths(plate("dielectric", glass, angle, {0, 0, -1}, in)),
                  element(expected.ts, expected.tp, expected.cross_t, in));
    }
}

TEST(PolarizedRendering, StackOfPlates) {
  const double angle = 0.9;
  const std::vector<double> indices = {1.5, 1.9, 1.33};
  SceneBuilder builder;
  Stack stack;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const double top = -2.0 * static_cast<double>(i);
    builder.object(prism({{-100, top - 1}, {100, top - 1}, {100, top}, {-100, top}}, 100),
                   builder.surface("dielectric", {{"eta", indices[i]}, {"alpha", 0.0}}));
    stack.add(Plate(angle, indices[i], 1));
  }
  for (const Stokes& in : {natural, slanted})
    for (const double side : {1.0, -1.0}) {
      scene::Scene scene = builder.scene();
      scene.views = {slanted_view(angle)};
      add_emitter(scene, std::make_shared<Sky>(Vec3{0, 0, side}, Vec3{0, 1, 0}, in));
      const Stokes expected = side > 0 ? element(stack.s.r.real(), stack.p.r.real(), stack.cross.r, in)
                                       : element(stack.s.t.real(), stack.p.t.real(), stack.cross.t, in);
      expect_near(all_paths(scene), expected);
    }
}

// Fresnel's rhomb: two total reflections at the angle `a` in glass of 1.51 delay by a quarter wave. Light enters and
// leaves along the faces' normals; what is reflected there goes the way back and forth again.
TEST(PolarizedRendering, FresnelsRhomb) {
  const double eta = 1.51, a = 54.62 * pi / 180, wide = 1;
  // Light travels along +x, through the middles of both ends, and meets the long faces at the angle a to their normals.
  const Vec2 along_face{std::sin(a), std::cos(a)};  // in x and z
  const double length = 2 * wide * std::sin(a) * std::sin(a) / std::cos(a);
  const Vec2 p0{0, -wide / 2}, p3{0, wide / 2};
  const Vec2 p1 = p0 + along_face * length, p2 = p3 + along_face * length;
  SceneBuilder builder;
  builder.object(prism({p0, p1, p2, p3}, 1), builder.surface("dielectric", {{"eta", eta}, {"alpha", 0.0}}));
  scene::Scene scene = builder.scene();
  const Vec3 forward{1, 0, 0};
  scene.views = {one_pixel({-3, 0, 0}, forward, {0, 1, 0})};
  add_emitter(scene, std::make_shared<Sky>(forward, Vec3{0, 1, 0}, slanted));
  const double n = 1 / eta, s = std::sin(a), r = std::pow((eta - 1) / (eta + 1), 2);
  const double delta = 2 * std::atan(std::cos(a) * std::sqrt(s * s - n * n) / (s * s));  // Born & Wolf, 1.5.60
  Complex cross = 0;
  double both = 0;
  for (int trip = 0; trip < 20; ++trip) {
    const double power = (1 - r) * (1 - r) * std::pow(r, 2 * trip);
    both += power;
    cross += std::polar(power, 2 * delta * (1 + 2 * trip));
  }
  const Stokes expected = element(both, both, cross, slanted);
  EXPECT_GT(expected.s[3], 0.91);
  expect_near(all_paths(scene), expected);
}

// A metal's amplitudes with a complex angle of refraction.
TEST(PolarizedRendering, Metal) {
  const Complex gold{0.29, 2.863};
  for (const double angle : {0.2, 0.8, 1.3})
    for (const Stokes& in : {natural, along, slanted, circular}) {
      const Complex t = std::sqrt(1.0 - std::pow(std::sin(angle) / gold, 2));
      const double c = std::cos(angle);
      const Complex s = (c - gold * t) / (c + gold * t), p = (gold * c - t) / (gold * c + t);
      // As smooth as the model goes: roughness spreads the angles of incidence by about as much.
      const surface::Model& model = *surface::find("conductor");
      const auto& known = model.info().parameters;
      const double alpha = std::ranges::find(known, "alpha", &manifest::ParameterInfo::name)->lower;
      scene::Scene scene =
          plate("conductor", {{"eta", gold.real()}, {"k", gold.imag()}, {"alpha", alpha}}, angle, {0, 0, 1}, in);
      expect_near({stokes_of(scene, 1 << 10).mean}, element(std::norm(s), std::norm(p), s * std::conj(p), in),
                  1e-4 + alpha);
    }
}

// Rolling the camera turns the frame of what a tilted plate reflects.
TEST(PolarizedRendering, RolledCameraBeforeGlass) {
  const double eta = 1.5, angle = 0.8, roll = 0.6;
  scene::Scene scene =
      plate("dielectric", {{"eta", eta}, {"alpha", 0.0}, {"sigma_a_per_m", 100.0}}, angle, {0, 0, 1}, natural);
  const Vec3 forward{-std::sin(angle), 0, -std::cos(angle)}, s{0, 1, 0}, down = cross(forward, s);
  scene.views = {one_pixel(forward * -5, forward, s * std::cos(roll) + down * std::sin(roll))};
  add_emitter(scene, scene.appearance.lights.front().emitter);
  const Interface face(angle, eta);
  const double mean = (face.rs() + face.rp()) / 2, difference = (face.rs() - face.rp()) / 2;
  expect_near(all_paths(scene), {{mean, difference * std::cos(2 * roll), difference * std::sin(2 * roll), 0}});
}

TEST(PolarizedRendering, ThePathTracerEstimatesTheSame) {
  const double eta = 1.5, angle = 1.0;
  const manifest::Parameters glass{{"eta", eta}, {"alpha", 0.0}};
  const Plate expected(angle, eta, 1);
  for (const Stokes& in : {natural, slanted}) {
    expect_estimates(plate("dielectric", glass, angle, {0, 0, 1}, in), 1 << 14,
                     element(expected.rs, expected.rp, expected.cross_r, in));
    expect_estimates(plate("dielectric", glass, angle, {0, 0, -1}, in), 1 << 14,
                     element(expected.ts, expected.tp, expected.cross_t, in));
  }
}

// Where light is scattered by one surface between an unpolarized lamp and the camera, or by matte ones, polarization
// changes nothing of the radiance: the same numbers to the last digits. (Repeated reflection is another matter: s is
// reflected more each time, and a calculation without polarization is wrong.)
TEST(PolarizedRendering, RadianceIsThatOfUnpolarizedPaths) {
  SceneBuilder builder;
  builder.object(scene::Sphere{0.5}, builder.diffuse(0.7), {0.3, 0, 0.5});
  builder.object(scene::Plane{10, 10},
                 builder.surface("coated-diffuse", {{"albedo", 0.6}, {"f0", 0.04}, {"alpha", 0.3}}));
  builder.light("point", {{"position_m", manifest::Parameter(std::vector<double>{-2, 1, 3})}, {"watt_per_sr", 10.0}});
  builder.look_down(-0.5, 0.1, 0.2, 1);
  scene::Scene scene = builder.scene();
  const StokesEstimate with = stokes_of(scene, 1 << 10, true, 1), without = stokes_of(scene, 1 << 10, false, 1);
  EXPECT_GT(without.mean[0], 0);
  EXPECT_NEAR(with.mean[0], without.mean[0], 1e-12 * without.mean[0]);
  EXPECT_GT(std::hypot(with.mean[1], with.mean[2]), 1e-3 * with.mean[0]);
  scene.instances[1].surface = scene.instances[0].surface;  // all matte
  const StokesEstimate matte = stokes_of(scene, 1 << 10, true), plain = stokes_of(scene, 1 << 10, false);
  EXPECT_NEAR(matte.mean[0], plain.mean[0], 1e-12 * plain.mean[0]);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(matte.mean[i], 0);
}

}  // namespace
}  // namespace gonio::tests
