// explain on tables of reflectance: what was put in is named with intervals that hold the truth, and nothing where
// nothing was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "data.h"
#include "explain/tables/quick_table.h"
#include "explain/tables/reflectance/paint_world.h"
#include "explain/tables/reflectance_surface.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"
#include "surface/fresnel.h"
#include "surface/thin_film.h"

namespace gonio::explain::tables::tests {
namespace {

const char* const coated = R"({"model": "coated-diffuse", "albedo": {"value": 0.3, "free": true},
  "f0": {"value": 0.04, "free": true}, "alpha": {"value": 0.2, "free": true}})";

struct Truth {
  std::string mechanism, parameter;
  double value;
};

void expect_named(const World& world, const std::vector<Truth>& truths) {
  const TablesProblem problem = world.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), truths[0].mechanism) << e.sentence;
  EXPECT_LT(e.held_out_after, 0.012) << e.sentence;  // the noise is 0.01
  for (const Truth& truth : truths) {
    const Estimate* x = estimate_of(problem, e, truth.mechanism + "@s." + truth.parameter);
    ASSERT_NE(x, nullptr) << truth.parameter << ": " << e.sentence;
    EXPECT_NEAR(x->value, truth.value, 3.5 * x->sigma + 1e-12) << truth.parameter;
    EXPECT_LT(x->sigma, 0.2 * std::abs(truth.value)) << truth.parameter;
  }
}

TEST(Reflectance, AnInterfaceOverLambert) {
  expect_named(paint_world({}, registered("coated-diffuse", {{"albedo", 0.25}, {"f0", 0.05}, {"alpha", 0.2}}), 1),
               {{"surface.interface", "f0", 0.05}, {"surface.interface", "alpha", 0.2}});
}

TEST(Reflectance, ARoughMatteBase) {
  expect_named(paint_world({}, registered("diffuse", {{"albedo", 0.4}, {"sigma_rad", 0.35}}), 2),
               {{"surface.diffuse-roughness", "sigma_rad", 0.35}});
}

TEST(Reflectance, ASecondLobe) {
  const auto truth = registered(
      "glossy", {{"albedo", 0.2}, {"f0", 0.05}, {"alpha", 0.12}, {"second_share", 0.4}, {"second_alpha", 0.5}});
  expect_named(paint_world({.base = coated}, truth, 3),
               {{"surface.specular", "second_share", 0.4}, {"surface.specular", "second_alpha", 0.5}});
}

TEST(Reflectance, ADirection) {
  const auto truth = registered(
      "glossy", {{"albedo", 0.2}, {"f0", 0.05}, {"alpha", 0.2}, {"anisotropy_0", 0.25}, {"anisotropy_45", -0.15}});
  expect_named(paint_world({.base = coated}, truth, 4),
               {{"surface.anisotropy", "anisotropy_0", 0.25}, {"surface.anisotropy", "anisotropy_45", -0.15}});
}

TEST(Reflectance, LightSentBack) {
  const auto truth = registered("glossy", {{"albedo", 0.3}, {"retro", 0.08}, {"retro_alpha", 0.4}});
  expect_named(paint_world({}, truth, 5), {{"surface.retro-reflection", "retro", 0.08}});
}

// As sheeting of road signs does: a third of it at 40 degrees (EN 12899-1, between its classes).
TEST(Reflectance, LightSentBackLessFromTheSide) {
  const auto truth =
      registered("glossy", {{"albedo", 0.3}, {"retro", 0.1}, {"retro_alpha", 0.3}, {"retro_falloff", 4}});
  expect_named(paint_world({}, truth, 5),
               {{"surface.retro-reflection", "retro", 0.1}, {"surface.retro-reflection", "retro_falloff", 4}});
}

// Airy's sum over the gloss of a coated surface, at five wavelengths.
TEST(Reflectance, AThinFilm) {
  Paint paint{.base = coated};
  for (int nm = 430; nm <= 670; nm += 60) paint.wavelengths_m.push_back(nm * 1e-9);
  const auto gloss = registered("coated-diffuse", {{"albedo", 0}, {"f0", 0.05}, {"alpha", 0.2}}),
             all = registered("coated-diffuse", {{"albedo", 0.1}, {"f0", 0.05}, {"alpha", 0.2}});
  const auto truth = [&](Vec3 wo, Vec3 wi, double wavelength, double) {
    const double eta = surface::eta_of_f0(0.05), cosine = norm(wo + wi) / 2, g = gloss(wo, wi, 0, 0);
    const auto film = [&](double c) { return surface::fresnel_film(c, eta, 1.9, 0.31e-6, wavelength); };
    const auto bare = [&](double c) { return surface::fresnel_dielectric(c, eta); };
    const double passes = (1 - film(wi.z)) * (1 - film(wo.z)) / ((1 - bare(wi.z)) * (1 - bare(wo.z)));
    return g * film(cosine) / bare(cosine) + (all(wo, wi, 0, 0) - g) * passes;
  };
  expect_named(paint_world(paint, truth, 6),
               {{"surface.thin-film", "film_m", 0.31e-6}, {"surface.thin-film", "film_eta", 1.9}});
}

// Ridges that face either way, on a sample that was rotated.
TEST(Reflectance, MicroRidges) {
  Paint paint{.base = coated};
  paint.turns = {0, 40, 80, 130};
  const surface::Ridges one(0.3, 0.2, 0.2, 0.7 - pi / 2), other(0.3, 0.2, 0.2, 0.7 + pi / 2);
  const auto gloss = registered("coated-diffuse", {{"albedo", 0}, {"f0", 0.05}, {"alpha", 0.2}}),
             all = registered("coated-diffuse", {{"albedo", 0.1}, {"f0", 0.05}, {"alpha", 0.2}});
  const auto truth = [&](Vec3 wo, Vec3 wi, double, double) {
    double lobe = 0;
    for (const surface::Ridges* saw : {&one, &other}) {
      const Vec3 wof = saw->to_facet(wo), wif = saw->to_facet(wi);
      if (wof.z > 0 && wif.z > 0) lobe += 0.5 * saw->lobe(wo, wi, wof, wif);
    }
    const double fresnel = surface::fresnel_dielectric(norm(wo + wi) / 2, surface::eta_of_f0(0.05));
    return all(wo, wi, 0, 0) + 0.5 * (fresnel * lobe - gloss(wo, wi, 0, 0));
  };
  expect_named(paint_world(paint, truth, 11),
               {{"surface.micro-ridges", "ridge_share", 0.5}, {"surface.micro-ridges", "ridge_azimuth_rad", 0.7}});
}

// A third of the facets of a saw lies under lumps, on a sample that was rotated; its ridges are known roughly.
TEST(Reflectance, ResidueOnRidges) {
  Paint paint{.base = R"({"model": "ridged", "ridge_rad": {"value": 0.28, "free": true},
    "alpha_u": {"value": 0.15, "free": true}, "alpha_v": {"value": 0.2, "free": true}})"};
  paint.turns = {0, 90, 180, 270};
  const auto ridges = registered("ridged", {{"ridge_rad", 0.25}, {"alpha_u", 0.2}, {"alpha_v", 0.15}});
  const auto truth = [&](Vec3 wo, Vec3 wi, double, double) {
    constexpr double alpha = 0.6, share = 0.3;
    const Vec3 h = normalized(wo + wi);
    const auto g = [](double z) { return std::sqrt(alpha * alpha + (1 - alpha * alpha) * z * z); };
    const double d = alpha * alpha / (pi * std::pow(1 + (alpha * alpha - 1) * h.z * h.z, 2));
    const double lumps = surface::fresnel_dielectric(dot(wo, h), 1.5) * d / (2 * (wo.z * g(wi.z) + wi.z * g(wo.z)));
    return (1 - share) * ridges(wo, wi, 0, 0) + share * lumps;
  };
  expect_named(paint_world(paint, truth, 12),
               {{"surface.residue", "residue_share", 0.3}, {"surface.residue", "residue_alpha", 0.6}});
  const World clean = paint_world(paint, ridges, 13);
  const TablesProblem problem = clean.problem();
  EXPECT_EQ(named(problem, explain(problem, {})), "");
}

// Walls that reflect like facets, all there is, on a sample that was rotated: told from residue, with a sigma although
// the truth lies at the bound; what the manifest is given lies within it. With residue as well, both are named.
TEST(Reflectance, WallsOfRidges) {
  Paint paint{.base = R"({"model": "ridged", "ridge_rad": {"value": 0.28, "free": true},
    "alpha_u": {"value": 0.15, "free": true}, "alpha_v": {"value": 0.2, "free": true}})"};
  paint.turns = {0, 90};
  for (const double share : {0.0, 0.3}) {
    const auto truth = registered(
        "ridged", {{"ridge_rad", 0.25}, {"alpha_u", 0.2}, {"alpha_v", 0.15}, {"walls", 1}, {"residue_share", share}});
    const World world = paint_world(paint, truth, 14);
    const TablesProblem problem = world.problem();
    const Explanation e = explain(problem, {.negative_controls = 4});
    EXPECT_EQ(named(problem, e), share > 0 ? "surface.residue surface.walls" : "surface.walls") << e.sentence;
    const Estimate *walls = estimate_of(problem, e, "surface.walls@s.walls"),
                   *residue = estimate_of(problem, e, "surface.residue@s.residue_share");
    ASSERT_TRUE(walls != nullptr && (share == 0 || residue != nullptr)) << e.sentence;
    EXPECT_NEAR(walls->value, 1, 3.5 * walls->sigma);
    EXPECT_GT(walls->sigma, 0);
    if (share > 0) {
      EXPECT_NEAR(residue->value, share, 3.5 * residue->sigma);
    }
    manifest::Document document = world.document();
    problem.apply(e, document);
    EXPECT_LE(document.mechanisms.at("surface.walls").parameters.at("walls").scalar(), 1);
  }
}

// Without excitation the colour is the base's own; with it a band glows.
TEST(Reflectance, Fluorescence) {
  Paint paint;
  paint.excited = true;
  for (int nm = 430; nm <= 670; nm += 60) paint.wavelengths_m.push_back(nm * 1e-9);
  const auto truth = [](Vec3, Vec3, double wavelength, double excitation) {
    const double off = (wavelength - 520e-9) / 35e-9;
    return (0.3 + 0.1 * excitation * std::exp(-0.5 * off * off)) / pi;
  };
  expect_named(paint_world(paint, truth, 7),
               {{"surface.fluorescence", "emission", 0.1}, {"surface.fluorescence", "emission_centre_m", 520e-9}});
}

// Twelve paints without anything left out; false alarms of a name at 1 % each: two or more in 0.6 % of such tests.
TEST(Reflectance, NothingIsNamedWhereNothingIsLeftOut) {
  int names = 0;
  for (std::uint64_t seed = 100; seed < 112; ++seed) {
    const bool gloss = seed % 2 == 0;
    const World world =
        gloss ? paint_world({.base = coated, .noise = 0.02},
                            registered("coated-diffuse", {{"albedo", 0.4}, {"f0", 0.06}, {"alpha", 0.25}}), seed)
              : paint_world({.noise = 0.02}, registered("diffuse", {{"albedo", 0.6}}), seed);
    const TablesProblem problem = world.problem();
    names += !explain(problem, {}).named.empty();
  }
  EXPECT_LE(names, 1);
}

// 40 intervals of 95 %: fewer than 35 hold the truth once in a hundred such tests.
TEST(Reflectance, IntervalsHoldTheTruthAsOftenAsTheySay) {
  int held = 0, all = 0;
  for (std::uint64_t seed = 200; seed < 220; ++seed) {
    const World world = paint_world(
        {.noise = 0.03}, registered("coated-diffuse", {{"albedo", 0.25}, {"f0", 0.045}, {"alpha", 0.3}}), seed);
    const TablesProblem problem = world.problem();
    const Explanation e = explain(problem, {.negative_controls = 4});
    ASSERT_EQ(named(problem, e), "surface.interface") << e.sentence;
    for (const auto& [name, value] : {std::pair{"f0", 0.045}, std::pair{"alpha", 0.3}}) {
      const Estimate* x = estimate_of(problem, e, std::string("surface.interface@s.") + name);
      held += x->lower_95 < value && value < x->upper_95;
      ++all;
    }
  }
  EXPECT_EQ(all, 40);
  EXPECT_GE(held, 35);
}

// The manifest that goes on says what was named, and a second look finds nothing left.
TEST(Reflectance, WhatIsNamedIsModelledInTheManifest) {
  const World world =
      paint_world({}, registered("coated-diffuse", {{"albedo", 0.25}, {"f0", 0.05}, {"alpha", 0.2}}), 8);
  manifest::Document document = world.document();
  const TablesProblem problem(document, "t", {}, false);
  problem.apply(explain(problem, {}), document);
  ASSERT_TRUE(document.mechanisms.contains("surface.interface"));
  EXPECT_NEAR(document.mechanisms["surface.interface"].parameters.at("f0").scalar(), 0.05, 0.002);
  EXPECT_NEAR(document.surfaces.at("s").parameters.at("albedo").value.at(0), 0.25, 0.005);
  const TablesProblem again(document, "t", {}, false);
  const Explanation second = explain(again, {});
  EXPECT_TRUE(second.named.empty()) << second.sentence;
}

// Every mechanism at its neutral values, and those that only shape it anywhere: not one bit of a prediction moves.
TEST(Reflectance, NeutralMechanismsLeavePredictionsAlone) {
  const World world = paint_world({.base = coated}, registered("diffuse", {{"albedo", 0.5}}), 9);
  const TablesProblem problem = world.problem();
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  const surface::Model* model = surface::find("coated-diffuse");
  const surface::Values truth = surface::values_of(*model, {{"albedo", 0.3}, {"f0", 0.04}, {"alpha", 0.2}}, "test");
  std::vector<double> prediction(problem.observations().first[1]);
  problem.predict(values, 0, prediction);
  const ReflectanceRows rows = reflectance_rows(problem.table());
  for (std::size_t r = 0; r < prediction.size(); ++r)
    EXPECT_EQ(prediction[r], scaled_reflectance(model->evaluate(truth, rows.wo[r], rows.wi[r]).x, rows.weight[r]));
  EXPECT_GE(problem.candidates().size(), 4u);
}

TEST(Reflectance, WrongTablesAreRefusedInWords) {
  World world = paint_world({}, registered("diffuse", {{"albedo", 0.5}}), 10);
  world.sections = "";
  EXPECT_THROW(world.problem(), Error);
  world.sections = R"("surfaces": {"s": {"model": "dielectric"}},)";
  EXPECT_THROW(world.problem(), Error);
}

// Reflectance of a film: none where it has no thickness, the substrate's where it is of the same index, and a quarter
// wave of the root of the index reflects nothing.
TEST(ThinFilm, LimitsOfAiry) {
  for (const double cosine : {1.0, 0.7, 0.2}) {
    EXPECT_NEAR(surface::fresnel_film(cosine, 1.5, 1.38, 0, 550e-9), surface::fresnel_dielectric(cosine, 1.5), 1e-12);
    EXPECT_NEAR(surface::fresnel_film(cosine, 1.5, 1.5, 2e-7, 550e-9), surface::fresnel_dielectric(cosine, 1.5), 1e-12);
  }
  const double root = std::sqrt(1.5);
  EXPECT_NEAR(surface::fresnel_film(1, 1.5, root, 550e-9 / (4 * root), 550e-9), 0, 1e-12);
}

// A table alone stands on Lambert's law; one whose scale is not trusted finds it as its gain.
TEST(Reflectance, ATableAloneIsHeldAgainstLambert) {
  const gonio::tests::ScratchFolder folder;
  const std::filesystem::path file = folder / "alone.csv";
  std::ofstream(file) << "theta_i [rad],phi_i [rad],theta_o [rad],phi_o [rad],f [1/sr]\n0.1,0,0.2,0,0.3\n";
  const manifest::Document document = quick_document({.file = file, .model = "surface", .observed = {"f"}});
  const manifest::Table& table = document.tables.begin()->second;
  ASSERT_TRUE(document.surfaces.contains(table.surface));
  EXPECT_EQ(document.surfaces.at(table.surface).model, "diffuse");
  EXPECT_TRUE(document.surfaces.at(table.surface).parameters.at("albedo").free);
}

TEST(Reflectance, AGainIsFittedBesideAKnownColour) {
  const auto bright = registered("coated-diffuse", {{"albedo", 0.5}, {"f0", 0.04}, {"alpha", 0.2}});
  World world = paint_world(
      {.base = R"({"model": "coated-diffuse", "albedo": 0.5, "f0": 0.04, "alpha": 0.2})"},
      [&](Vec3 wo, Vec3 wi, double w, double e) { return 0.37 * bright(wo, wi, w, e); }, 12);
  world.rest += R"(, "parameters": {"gain": {"value": 1, "free": true}})";
  const TablesProblem problem = world.problem();
  const Explanation e = explain(problem, {.negative_controls = 8});
  EXPECT_EQ(named(problem, e), "") << e.sentence;
  manifest::Document document = world.document();
  problem.apply(e, document);
  EXPECT_NEAR(document.tables.at("t").parameters.at("gain").scalar(), 0.37, 0.005);
}

}  // namespace
}  // namespace gonio::explain::tables::tests
