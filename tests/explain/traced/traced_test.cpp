// Pictures of a glass ball on a table under a small lamp, one view alone: rendered, with noise, and handed over as what
// a user believes of the glass. Rendered once for all tests that ask about the same picture.
// One process: Traced.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "data.h"
#include "explain/domain.h"
#include "explain/traced/roughness.h"
#include "explain/traced/takes.h"
#include "explain/traced/traced_model.h"
#include "explain/traced/traced_problem.h"
#include "inference/explanation.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "render/path_tracer.h"
#include "scene/scene.h"

namespace gonio::explain::traced {
namespace {

constexpr double read_noise = 0.002;

std::string glass_manifest(const std::string& glass) {
  return R"({"gonio":1,"files":{"a":{"path":"a.exr"}},
 "cameras":{"camera":{"width_px":64,"height_px":64,"fx_px":113,"fy_px":113,"cx_px":31.5,"cy_px":31.5}},
 "meshes":{"ball":{"sphere":{"radius_m":0.05}},"table":{"plane":{"size_m":[1.5,1.5]}}},
 "surfaces":{"ball":)" +
         glass + R"(,"table":{"model":"diffuse","albedo":[0.6,0.5,0.4]}},
 "lights":{"lamp":{"model":"point","position_m":[0.3,-0.2,0.5],
                   "watt_per_sr":{"value":[0.6,0.6,0.6],"free":true,"share":"lamp"}}},
 "objects":[{"id":"ball","mesh":"ball","surface":"ball",
             "world_from_object":{"rotation":[1,0,0,0],"translation_m":[0,0,0.051],
                                  "sigma":{"rotation_rad":[0.002,0.002,0.002],"translation_m":[0.0002,0.0002,0.0002]}}},
            {"id":"table","mesh":"table","surface":"table"}],
 "images":[{"id":"a","file":"a","camera":"camera","light":"lamp",
   "world_from_camera":{"matrix":[[1,0,0,0],[0,-0.5,0.866025403784,-0.35],[0,-0.866025403784,-0.5,0.24],[0,0,0,1]]},
   "noise":{"gain":1e9,"read":)" +
         format("%g", read_noise) + "}}]}";
}

const std::string clear = R"({"model":"dielectric","eta":1.5})";
const std::string tinted = R"({"model":"dielectric","eta":1.5,"sigma_a_per_m":[1,8,20]})";

// As rendered, without noise.
const io::Image& picture_of(const std::string& glass, std::uint64_t seed) {
  static std::map<std::pair<std::string, std::uint64_t>, io::Image> known;
  io::Image& picture = known[{glass, seed}];
  if (picture.pixels() > 0) return picture;
  const scene::Scene scene = scene::build_scene(manifest::parse_document(glass_manifest(glass), "truth", "."));
  const render::RayCaster caster(scene.instances);
  render::Options options;
  options.spp = 512;
  options.seed = seed;
  options.geometry = false;
  return picture = render::render(scene, 0, caster, options);
}

manifest::Document recorded(const tests::ScratchFolder& folder, const std::string& truth, const std::string& believed,
                            std::uint64_t seed) {
  io::Image picture = picture_of(truth, seed);
  Random random(seed, 0);
  for (float& value : picture.data) value += static_cast<float>(read_noise * random.normal());
  io::write_picture(folder / "a.exr", picture);
  return manifest::parse_document(glass_manifest(believed), "believed", folder.path());
}

const Options quick{.repeats = {}, .pixels = 750, .paths = 4e5};

std::vector<std::string> named(const Problem& problem, const Explanation& e) {
  std::vector<std::string> ids;
  for (const std::size_t n : e.named) ids.push_back(problem.candidates()[n].id());
  return ids;
}
Explanation explained(const Problem& problem) {
  inference::Options options;
  options.negative_controls = 8;
  return explain(problem, options);
}

TEST(Roughness, IsWhatItWasWhereNothingIsAdded) {
  const surface::LocalGeometry here{{0.01, 0.02, 0.03}, normalized(Vec3{0.3, 0.1, 0.6}), -120};
  Roughness r{.alpha = 0.237};
  EXPECT_EQ(r.at(here), 0.237);
  r.layer_m = 0.004, r.polish = 7;
  EXPECT_EQ(r.at(here), 0.237);
}

TEST(Roughness, FollowsTheLawsThatItIsWrittenAs) {
  const surface::LocalGeometry slope{{0, 0, 0.0061}, normalized(Vec3{1, 0, 1}), -120};
  EXPECT_NEAR((Roughness{.alpha = 0.3, .more = 0.4}.at(slope)), 0.5, 1e-12);
  EXPECT_NEAR((Roughness{.alpha = 0.2, .slopes = 0.5}.at(slope)), 0.2 + 0.8 * 0.5, 1e-9);  // |sin 2t| = 1
  EXPECT_NEAR((Roughness{.alpha = 0.2, .layers = 0.3, .layer_m = 0.004}.at(slope)), 0.5, 1e-12);
  EXPECT_NEAR((Roughness{.alpha = 0.2, .reach_m = 1 / 120.0}.at(slope)), 0.2 + 0.8 / 2, 1e-12);
  const tests::ScratchFolder folder;
  manifest::Document document = manifest::parse_document(glass_manifest(clear), "glass", folder.path());
  Roughness{.alpha = 0.1, .layers = 0.2, .layer_m = 0.003}.write(document, "ball");
  const manifest::Surface& ball = document.surfaces.at("ball");
  EXPECT_FALSE(ball.parameters.contains("alpha"));
  EXPECT_EQ(ball.laws.at("alpha").law, "print-layers");
  EXPECT_NEAR(ball.laws.at("alpha").parameters.at("alpha_odd").scalar(), 0.3, 1e-12);
}

TEST(Traced, TakesGlassFromTheFastModel) {
  const tests::ScratchFolder folder;
  const manifest::Document document = recorded(folder, clear, clear, 1);
  EXPECT_TRUE(beyond_the_fast_model(document));
  EXPECT_TRUE(wants_tracing(document));
  for (const Domain* domain : all_domains())
    if (domain->name == "images" || domain->name == "traced") {
      EXPECT_EQ(domain->applies(document), domain->name == "traced") << domain->name;
    }
}

TEST(Traced, WhatActsBehindTheLensIsSaidToBeOutOfReach) {
  const tests::ScratchFolder folder;
  std::string text = glass_manifest(clear);
  text.insert(text.size() - 1, R"(,"mechanisms":{"sensor.black-offset":{"offset":0.01}})");
  try {
    check_reach(manifest::parse_document(text, "glass.json", folder.path()));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("glass.json#/mechanisms/sensor.black-offset: acts behind the lens"));
  }
}

TEST(Traced, OnePictureIsCutIntoGroupsThatShareNoBlock) {
  const tests::ScratchFolder folder;
  const auto problem = traced_problem(recorded(folder, clear, clear, 1), {.repeats = {}, .pixels = 750, .paths = 5e4});
  const Observations& o = problem->observations();
  EXPECT_GE(o.groups(), 8U);
  std::vector<std::size_t> group_of(o.rows(), o.groups());
  for (std::size_t g = 0; g < o.groups(); ++g) {
    EXPECT_GT(o.first[g + 1] - o.first[g], 60U);
    for (std::size_t row = o.first[g]; row < o.first[g + 1]; ++row) {
      std::size_t& owner = group_of[o.block[row]];
      EXPECT_TRUE(owner == o.groups() || owner == g);
      owner = g;
    }
  }
}

// A colour that is nearly white already: no factor may make it more than white.
TEST(Traced, FactorsKeepColoursWithinTheirBounds) {
  const tests::ScratchFolder folder;
  recorded(folder, clear, clear, 1);
  std::string text = glass_manifest(clear);
  const std::string stated = R"("albedo":[0.6,0.5,0.4])";
  text.replace(text.find(stated), stated.size(), R"("albedo":{"value":[0.95,0.5,0.4],"free":true})");
  const auto problem = traced_problem(manifest::parse_document(text, "white", folder.path()),
                                      {.repeats = {}, .pixels = 300, .paths = 2e4});
  int factors = 0;
  for (const Parameter& p : problem->parameters()) {
    if (!p.name.starts_with("surfaces/table/albedo/") || !p.name.ends_with("/factor")) continue;
    ++factors;
    EXPECT_LE(0.95 * p.upper, 1.0);
    EXPECT_GT(p.upper, 1.0);
    EXPECT_LT(p.lower, 1.0);
  }
  EXPECT_EQ(factors, 3);
}

// Between the nodes, and with several numbers off at once, against pictures that are traced there.
TEST(Traced, PredictsWhatIsTraced) {
  const tests::ScratchFolder folder;
  const TracedModel model(recorded(folder, clear, clear, 1), {}, 600, 3e5);
  std::vector<double> values;
  for (const Knob& knob : model.knobs().knobs) values.push_back(knob.parameter.neutral);
  std::size_t absorbs = model.knobs().questions.size();
  for (std::size_t q = 0; q < model.knobs().questions.size(); ++q) {
    const Question& question = model.knobs().questions[q];
    if (question.mechanism == nullptr || question.mechanism->parameters[0].name != "sigma_a_per_m") continue;
    absorbs = q;
    values[question.knobs[0]] = 2, values[question.knobs[1]] = 9, values[question.knobs[2]] = 25;
  }
  ASSERT_LT(absorbs, model.knobs().questions.size());
  for (std::size_t k = 0; k < values.size(); ++k)
    if (model.knobs().knobs[k].acts == Acts::brightness) values[k] = 1.1;
  const TracedModel::Traced traced =
      model.trace(model.scene_with(values, {}, std::vector<std::size_t>{absorbs}, true), model.paths());
  double squares = 0, off = 0, without = 0;
  for (std::size_t g = 0; g + 1 < model.sampled().first.size(); ++g) {
    const std::size_t from = 3 * model.sampled().first[g];
    std::vector<double> fast(3 * model.sampled().first[g + 1] - from);
    model.predict(values, g, fast);
    for (std::size_t i = 0; i < fast.size(); ++i) {
      const double exact = traced.radiance[from + i];
      squares += exact * exact, off += (fast[i] - exact) * (fast[i] - exact);
      without += std::pow(model.stated().radiance[from + i] - exact, 2);
    }
  }
  EXPECT_LT(std::sqrt(off / squares), 0.03);
  EXPECT_GT(std::sqrt(without / squares), 0.2);
}

TEST(Traced, AbsorptionIsNamedFromOnePictureAndItsNumbersHold) {
  const tests::ScratchFolder folder;
  const manifest::Document document = recorded(folder, tinted, clear, 3);
  const auto problem = traced_problem(document, quick);
  const Explanation e = explained(*problem);
  EXPECT_THAT(named(*problem, e), testing::ElementsAre("volume.absorption"));
  const double truth[] = {1, 8, 20};
  ASSERT_EQ(e.estimates.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(e.estimates[c].value, truth[c], 3.5 * e.estimates[c].sigma + 0.02 * truth[c]);
  manifest::Document mended = document;
  problem->apply(e, mended);
  EXPECT_NEAR(mended.surfaces.at("ball").parameters.at("sigma_a_per_m").value[2], e.estimates[2].value, 1e-12);
}

TEST(Traced, WhatIsSimulatedRightIsLeftAlone) {
  for (const std::uint64_t seed : {5, 6}) {
    const tests::ScratchFolder folder;
    const auto problem = traced_problem(recorded(folder, tinted, tinted, seed), quick);
    EXPECT_THAT(named(*problem, explained(*problem)), testing::IsEmpty()) << seed;
  }
}

}  // namespace
}  // namespace gonio::explain::traced
