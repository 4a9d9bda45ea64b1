// Mechanisms edit scenes: neutral values leave every number as it was; models change only where they must.
#include "scene/mechanisms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::scene {
namespace {

using manifest::MechanismUse;
using manifest::Parameter;
using mechanism::Mechanism;
using mechanism::Target;
using testing::ElementsAre;
using testing::HasSubstr;

const Mechanism& mechanism_of(const std::string& id) {
  for (const Mechanism* m : mechanism::all_mechanisms())
    if (m->id == id) return *m;
  throw std::runtime_error("no mechanism " + id);
}

Surface surface_of(const std::string& id, const std::string& model, const manifest::Parameters& parameters) {
  Surface surface{.id = id, .model = surface::find(model), .parameters = parameters, .values = {}, .textures = {}};
  refresh(surface, id);
  return surface;
}
Light light_of(const std::string& id, const std::string& model, const manifest::Parameters& parameters) {
  Light light{.id = id, .model = light::find(model), .parameters = parameters, .picture = {}, .emitter = {}};
  refresh(light, id);
  return light;
}

Appearance appearance() {
  Appearance a;
  a.surfaces = {surface_of("clay", "diffuse", {{"albedo", 0.5}}),
                surface_of("steel", "metal", {{"f0", 0.6}, {"alpha", 0.2}})};
  a.lights = {light_of("lamp", "point", {{"position_m", std::vector<double>{0.3, 0, 0.4}}, {"watt_per_sr", 2.0}}),
              light_of("sky", "uniform", {{"radiance", 0.1}}),
              light_of("sun", "directional", {{"towards", std::vector<double>{0, 0, 2}}, {"watt_per_m2", 1.0}})};
  return a;
}

MechanismUse use(const manifest::Parameters& parameters, const std::vector<std::string>& on = {}) {
  return {.on = on, .parameters = parameters, .sigma = {}};
}

const Vec3 wo = normalized(Vec3{0.3, 0.1, 0.8}), wi = normalized(Vec3{-0.4, 0.2, 0.7});
const Vec3 point_m{0.01, 0.02, 0.03};

std::vector<Vec3> numbers_of(const Appearance& a) {
  std::vector<Vec3> numbers;
  for (const Surface& s : a.surfaces) {
    numbers.push_back(s.model->evaluate(s.values, wo, wi));
    numbers.push_back(s.model->evaluate(s.values_at({}), wo, wi));
  }
  for (const Light& l : a.lights) {
    const light::Sample sample = l.emitter->sample(point_m, {0.3, 0.6});
    numbers.insert(numbers.end(), {sample.direction, sample.weight});
    if (const auto sent = l.emitter->polarization(-sample.direction))
      numbers.insert(numbers.end(), {sent->x, {sent->stokes.s[1], sent->stokes.s[2], sent->stokes.s[3]}});
  }
  numbers.push_back({a.indirect_strength, a.vignetting_falloff, a.ambient ? 1.0 : 0.0});
  return numbers;
}

// Walks the registry: whatever is declared for pictures is known here, and vanishes where it says it vanishes.
TEST(Registry, EveryMechanismOfImagesAppliesAndVanishesAtNeutral) {
  int count = 0;
  for (const Mechanism* m : mechanism::all_mechanisms()) {
    if (std::find(m->domains.begin(), m->domains.end(), "images") == m->domains.end()) continue;
    // Cameras: render/sensor_chain_test; objects: placement_test; the time of images: render/neutral_mechanisms_test.
    if (m->target == Target::camera || m->target == Target::object || m->id == "light.drift" ||
        m->id == "light.spectrum" || m->id == "sensor.exposure")
      continue;
    if (beyond_rendering(*m)) {
      Appearance base = appearance(), edited = base;
      manifest::Parameters other;
      for (const auto& p : m->parameters) other[p.name] = p.start != p.neutral ? p.start : 0.5 * (p.start + p.upper);
      apply_mechanism(edited, *m, use(other), {}, "here");
      EXPECT_EQ(numbers_of(edited), numbers_of(base)) << m->id;
      continue;
    }
    ++count;
    EXPECT_TRUE(applies_to_scenes(*m)) << m->id;
    Appearance base = appearance(), edited;
    if (m->id == "transport.indirect") base.indirect_strength = 0;  // its neutral base model
    edited = base;
    manifest::Parameters neutral, other;
    for (const auto& p : m->parameters) {
      neutral[p.name] = p.neutral;
      other[p.name] = p.start != p.neutral ? p.start : 0.5 * (p.start + p.upper);
    }
    if (m->id == "surface.spatial-variation")
      other["x_m"] = other["y_m"] = other["z_m"] = 0.0;  // where numbers_of looks
    apply_mechanism(edited, *m, use(neutral), {}, "here");
    EXPECT_EQ(numbers_of(edited), numbers_of(base)) << m->id;
    apply_mechanism(edited, *m, use({}), {}, "here");
    EXPECT_EQ(numbers_of(edited), numbers_of(base)) << m->id;
    apply_mechanism(edited, *m, use(other), {}, "here");
    EXPECT_NE(numbers_of(edited), numbers_of(base)) << m->id;
  }
  EXPECT_GE(count, 7);
}

TEST(Targets, AreThoseWhoseModelsCanTakeTheParameters) {
  const Appearance a = appearance();
  EXPECT_THAT(mechanism_targets(a, mechanism_of("surface.interface")), ElementsAre("clay"));
  EXPECT_THAT(mechanism_targets(a, mechanism_of("light.finite-size")), ElementsAre("lamp"));
  EXPECT_THAT(mechanism_targets(a, mechanism_of("light.direction")), ElementsAre("lamp", "sun"));
  EXPECT_THAT(mechanism_targets(a, mechanism_of("light.ambient")), ElementsAre());
}

TEST(Interface, TurnsADiffuseSurfaceIntoACoatedOneOfTheSameBase) {
  Appearance a = appearance();
  apply_mechanism(a, mechanism_of("surface.interface"), use({{"f0", 0.04}, {"alpha", 0.1}}), {}, "here");
  EXPECT_EQ(a.surfaces[0].model->info().id, "coated-diffuse");
  EXPECT_EQ(a.surfaces[0].parameters.at("albedo"), Parameter(0.5));
  EXPECT_EQ(a.surfaces[1].model->info().id, "metal");
  const Surface direct = surface_of("x", "coated-diffuse", {{"albedo", 0.5}, {"f0", 0.04}, {"alpha", 0.1}});
  EXPECT_EQ(a.surfaces[0].model->evaluate(a.surfaces[0].values, wo, wi), direct.model->evaluate(direct.values, wo, wi));
}

TEST(Together, RoughnessAndInterfaceInEitherOrder) {
  Appearance a = appearance(), b = appearance();
  const auto& rough = mechanism_of("surface.diffuse-roughness");
  const auto& interface = mechanism_of("surface.interface");
  const MechanismUse sigma = use({{"sigma_rad", 0.4}}), coat = use({{"f0", 0.05}, {"alpha", 0.3}});
  apply_mechanism(a, rough, sigma, {}, "here");
  apply_mechanism(a, interface, coat, {}, "here");
  apply_mechanism(b, interface, coat, {}, "here");
  apply_mechanism(b, rough, sigma, {}, "here");
  EXPECT_EQ(numbers_of(a), numbers_of(b));
}

TEST(Direction, TurnsPositionsAboutTheCentreAndKeepsTheDistance) {
  Appearance a = appearance();
  const Vec3 centre{0, 0, 0.1};
  const manifest::Parameters tilts = {{"tilt_x_rad", std::vector<double>{0.1, 0}},
                                      {"tilt_y_rad", std::vector<double>{0, 0.2}}};
  apply_mechanism(a, mechanism_of("light.direction"), use(tilts, {"lamp", "sun"}), centre, "here");
  const Vec3 before = Vec3{0.3, 0, 0.4} - centre, after = a.lights[0].parameters.at("position_m").vector() - centre;
  EXPECT_NEAR(norm(before), norm(after), 1e-15);
  EXPECT_NEAR(std::acos(dot(before, after) / dot(before, before)), 0.1, 1e-12);
  const Vec3 sun = a.lights[2].emitter->sample(point_m, {}).direction;
  EXPECT_NEAR(std::acos(sun.z), 0.2, 1e-12);
}

Vec3 vector_at(const Light& light, const std::string& name) {
  return light.parameters.at(name).vector();
}

TEST(Direction, CarriesTheAimOfALampAlong) {
  Appearance a;
  const std::vector<double> place{0.3, 0, 0.5};
  a.lights = {light_of("panel", "rectangle",
                       {{"position_m", place},
                        {"direction", std::vector<double>{-0.3, 0, -0.4}},
                        {"up", std::vector<double>{0, 1, 0}},
                        {"width_m", 0.1},
                        {"height_m", 0.2},
                        {"watt_per_sr", 1.0}})};
  const Vec3 centre{0, 0, 0.1};
  apply_mechanism(a, mechanism_of("light.direction"), use({{"tilt_x_rad", 0.1}, {"tilt_y_rad", -0.2}}), centre, "here");
  const Light& panel = a.lights[0];
  const Vec3 aim = vector_at(panel, "direction"), arm = centre - vector_at(panel, "position_m");
  EXPECT_NEAR(norm(cross(normalized(aim), normalized(arm))), 0, 1e-12);  // still looks at the centre
  EXPECT_NEAR(dot(aim, vector_at(panel, "up")), 0, 1e-12);
  EXPECT_GT(norm(vector_at(panel, "position_m") - Vec3{0.3, 0, 0.5}), 0.05);
}

TEST(Lobe, NarrowsLampsThatFaceSomewhereAndAimsThoseThatDoNot) {
  const std::vector<double> place{0, 0, 0.5};
  Appearance a;
  a.lights = {light_of("bare", "point", {{"position_m", place}, {"watt_per_sr", 2.0}}),
              light_of("diode", "led",
                       {{"position_m", place}, {"watt_per_sr", 2.0}, {"direction", std::vector<double>{0, 0, -1}}}),
              light_of("globe", "sphere", {{"position_m", place}, {"watt_per_sr", 2.0}, {"radius_m", 0.1}}),
              light_of("sun", "directional", {{"towards", std::vector<double>{0, 0, 2}}, {"watt_per_m2", 1.0}})};
  const Mechanism& lobe = mechanism_of("light.lobe");
  EXPECT_THAT(mechanism_targets(a, lobe), ElementsAre("bare", "diode", "globe"));
  EXPECT_TRUE(applies_to_scenes(lobe));
  const std::vector<Vec3> before = numbers_of(a);
  apply_mechanism(a, lobe, use({{"exponent", 0.0}}), {}, "here");
  EXPECT_EQ(numbers_of(a), before);
  const Vec3 point{0.3, 0, 0};
  const Rgb bare = a.lights[0].emitter->sample(point, {}).weight, diode = a.lights[1].emitter->sample(point, {}).weight;
  apply_mechanism(a, lobe, use({{"exponent", 1.5}}), {}, "here");
  const double fade = std::pow(0.5 / std::hypot(0.3, 0.5), 1.5);
  EXPECT_NEAR(a.lights[0].emitter->sample(point, {}).weight.x, bare.x * fade, 1e-12);
  EXPECT_NEAR(a.lights[1].emitter->sample(point, {}).weight.x, diode.x * fade, 1e-12);
  EXPECT_EQ(a.lights[0].model->info().id, "led");
  EXPECT_EQ(a.lights[1].parameters.at("exponent").scalar(), 2.5);
  EXPECT_EQ(a.lights[2].parameters.at("radius_m").scalar(), 0.1);
  EXPECT_THROW(apply_mechanism(a, lobe, use({{"exponent", 1.0}}, {"sun"}), {}, "here"), Error);
}

TEST(Lobe, MeasuredLobesKeepTheirFile) {
  Appearance a;
  Light light{.id = "measured",
              .model = light::find("lobe-table"),
              .parameters = {{"position_m", std::vector<double>{0, 0, 1}},
                             {"watt_per_sr", 1.0},
                             {"direction", std::vector<double>{0, 0, -1}}}};
  light.file = std::filesystem::path(GONIO_SOURCE) / "tests/light/attachments/lobe-table.csv";
  refresh(light, "here");
  a.lights = {light};
  EXPECT_THAT(mechanism_targets(a, mechanism_of("light.lobe")), ElementsAre());
  EXPECT_THAT(mechanism_targets(a, mechanism_of("light.finite-size")), ElementsAre());
  EXPECT_THAT(mechanism_targets(a, mechanism_of("light.direction")), ElementsAre("measured"));
}

TEST(Cameras, LensTermsReplaceTheDistortion) {
  manifest::Camera camera;
  camera.distortion = {{"k1", -0.1}, {"p1", 0.01}};
  camera.model = "radial-tangential";
  apply_mechanism(camera, "c", mechanism_of("lens.radial"), use({{"k1", -0.3}, {"k2", 0.1}}), "here");
  EXPECT_EQ(camera.distortion.at("k1"), Parameter(-0.3));
  EXPECT_EQ(camera.distortion.at("k2"), Parameter(0.1));
  EXPECT_EQ(camera.distortion.at("p1"), Parameter(0.01));
  apply_mechanism(camera, "c", mechanism_of("lens.thin-prism"), use({{"s1", 0.01}}, {"another"}), "here");
  EXPECT_EQ(camera.model, "radial-tangential");
  apply_mechanism(camera, "c", mechanism_of("lens.thin-prism"), use({{"s1", 0.01}}), "here");
  EXPECT_EQ(camera.model, "thin-prism");
}

TEST(Views, DefocusGivesALensToTheCamerasItNames) {
  View view{.image = "i",
            .camera = {{}, 8, 8},
            .world_from_camera = {},
            .lights = {},
            .gain = {1, 1, 1},
            .lens = {},
            .camera_name = "c"};
  const manifest::Parameters wide = {{"aperture_radius_m", 0.01}, {"focus_m", 0.7}};
  apply_mechanism(view, mechanism_of("optics.defocus"), use(wide, {"another"}), "here");
  EXPECT_EQ(view.lens.aperture_radius_m, 0);
  apply_mechanism(view, mechanism_of("optics.defocus"), use({{"focus_m", 1.0}}), "here");
  EXPECT_EQ(view.lens.aperture_radius_m, 0);
  apply_mechanism(view, mechanism_of("optics.defocus"), use(wide), "here");
  EXPECT_EQ(view.lens.aperture_radius_m, 0.01);
  EXPECT_EQ(view.lens.focus_m, 0.7);
  EXPECT_THROW(apply_mechanism(view, mechanism_of("optics.defocus"), use({{"aperture_radius_m", -1.0}}), "here"),
               Error);
}

std::string problem_of(const std::string& id, const MechanismUse& what) {
  Appearance a = appearance();
  try {
    apply_mechanism(a, mechanism_of(id), what, {}, "m.json#/mechanisms/" + id);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.what();
  }
  return "none";
}

TEST(Refusals, NameThePlace) {
  EXPECT_THAT(problem_of("surface.interface", use({{"f0", 0.04}}, {"steel"})),
              HasSubstr("does not apply to \"steel\""));
  EXPECT_THAT(problem_of("surface.interface", use({{"f0", 0.04}}, {"wood"})),
              HasSubstr("m.json#/mechanisms/surface.interface/on"));
  EXPECT_THAT(problem_of("surface.interface", use({{"F0", 0.04}})), HasSubstr("no such parameter"));
  EXPECT_THAT(problem_of("light.finite-size", use({{"radius_m", std::vector<double>{0.1, 0.2}}}, {"lamp"})),
              HasSubstr("2 numbers for 1 targets"));
  EXPECT_THAT(problem_of("light.finite-size", use({{"radius_m", -0.1}})), HasSubstr("-0.1"));
}

// A half space that scatters takes the place of a matte surface alone: neither order lets a gloss stand beside it.
TEST(Targets, WhatCannotStandOnOneSurfaceTogether) {
  const Surface clay = appearance().surfaces[0];
  const auto together = [&](const std::string& a, const std::string& b) {
    EXPECT_EQ(go_together(clay, mechanism_of(a), mechanism_of(b)), go_together(clay, mechanism_of(b), mechanism_of(a)));
    return go_together(clay, mechanism_of(a), mechanism_of(b));
  };
  EXPECT_TRUE(together("surface.interface", "surface.diffuse-roughness"));
  EXPECT_TRUE(together("surface.interface", "surface.metal"));
  EXPECT_TRUE(together("surface.subsurface", "surface.fluorescence"));  // which leaves scenes as they are
  EXPECT_TRUE(together("surface.subsurface", "surface.interface"));
  EXPECT_FALSE(together("surface.subsurface", "surface.diffuse-roughness"));
}

}  // namespace
}  // namespace gonio::scene
