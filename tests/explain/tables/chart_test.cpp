// What a colour chart's readings leave out, in worlds integrated over spectra (chart_world.h) and in photographs that
// others took. Seeds are fixed; a name is given at a level of 0.01, and of 20 worlds without anything left out 2 or
// more would be named with a chance of 0.02.
#include "colour/chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "chart_world.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables::tests {
namespace {

const std::array<const char*, 3> cameras = {"Canon_5DMarkII_camspec_Canon_5DMarkII.csv",
                                            "Nikon_D5100_camspec_Nikon_D5100.csv",
                                            "Sony_NEX-5N_camspec_SONY_NEX-5N.csv"};
constexpr const char *glare = "colour.glare", *offset = "sensor.black-offset";

// Mechanisms that are named, or that could stand in the place of what is.
std::set<std::string> listed_in(const Problem& problem, const Explanation& e) {
  std::set<std::string> ids;
  for (const std::size_t c : e.named) ids.insert(problem.candidates()[c].id());
  for (const auto* sets : {&e.not_told_apart, &e.instead})
    for (const auto& set : *sets)
      for (const std::size_t c : set) ids.insert(problem.candidates()[c].id());
  return ids;
}

struct Answers {
  int nothing = 0, first = 0, listed = 0, wrong = 0;  // first: named, with or without others in its place
  int intervals = 0, covered = 0;
};
Answers ask(const std::string& what, const ChartTruth& truth, const std::string& id, int seeds,
            const std::string& parameter = "", double value = 0) {
  Answers a;
  for (int seed = 1; seed <= seeds; ++seed) {
    const ChartSpectra spectra = chart_spectra(cameras[static_cast<std::size_t>(seed) % cameras.size()]);
    const TablesProblem problem = chart_world(static_cast<std::uint64_t>(seed), spectra, truth).problem();
    const Explanation e = explain(problem, {});
    const std::string text = named(problem, e);
    const bool listed = listed_in(problem, e).contains(id);
    a.nothing += text.empty() ? 1 : 0, a.first += text == id ? 1 : 0, a.listed += listed ? 1 : 0;
    a.wrong += !text.empty() && !listed ? 1 : 0;
    if (!text.empty() && text != id) std::printf("  %d: %s\n", seed, e.sentence.c_str());
    if (const Estimate* x = parameter.empty() ? nullptr : estimate_of(problem, e, parameter)) {
      ++a.intervals, a.covered += x->lower_95 <= value && value <= x->upper_95 ? 1 : 0;
    }
  }
  std::printf("%s: nothing %d, named first %d, listed %d, wrong %d of %d; intervals cover %d of %d\n", what.c_str(),
              a.nothing, a.first, a.listed, a.wrong, seeds, a.covered, a.intervals);
  return a;
}

TEST(Chart, NothingIsNamedWhereNothingIsLeftOut) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  EXPECT_GE(ask("nothing", {}, "none", 20).nothing, 19);
  EXPECT_GE(ask("nothing, two exposures", {.exposures = {1, 0.25}}, "none", 20).nothing, 19);
  EXPECT_GE(ask("nothing, an uneven print", {.print = 0.02}, "none", 20).nothing, 19);
}

// In one exposure the offset is listed beside it. What 0.4 in L* of a print hide, no reading of it can show: of 1 % the
// black patch rises as much as a patch in twenty does by itself.
TEST(Chart, GlareIsFound) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  const Answers three = ask("glare of 3 %", {.glare = 0.03}, glare, 10, "colour.glare.share", 0.03);
  EXPECT_GE(three.first, 9);
  EXPECT_EQ(three.wrong, 0);
  const Answers two = ask("glare of 2 %", {.glare = 0.02}, glare, 10, "colour.glare.share", 0.02);
  EXPECT_GE(two.listed, 8);
  EXPECT_EQ(two.wrong, 0);
  const Answers good =
      ask("glare of 1 % on a good print", {.print = 0.002, .glare = 0.01}, glare, 10, "colour.glare.share", 0.01);
  EXPECT_EQ(ask("glare of 1 %", {.glare = 0.01}, glare, 10).wrong, 0);
  EXPECT_EQ(good.wrong, 0);
  EXPECT_GE(three.covered + two.covered + good.covered, (three.intervals + two.intervals + good.intervals) * 8 / 10);
}

TEST(Chart, TwoExposuresTellGlareFromAnOffset) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  const ChartTruth veiled{.glare = 0.03, .exposures = {1, 0.25}, .states_exposure = true};
  const Answers of_glare = ask("glare of 3 %, two exposures", veiled, glare, 10, "colour.glare.share", 0.03);
  EXPECT_GE(of_glare.first, 9);
  EXPECT_EQ(of_glare.wrong, 0);
  const ChartTruth raised{.offset = {0.01, 0.01, 0.01}, .exposures = {1, 0.25}, .states_exposure = true};
  const Answers of_offset = ask("offset of 1 %, two exposures", raised, offset, 10, "sensor.black-offset.offset", 0.01);
  EXPECT_EQ(of_offset.first, 10);
  EXPECT_GE(of_offset.covered, of_offset.intervals * 8 / 10);
}

// An earlier form, which took the readings' noise for all there is, named glare and offset together.
TEST(Chart, AnOffsetAloneIsNamed) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  const Answers a =
      ask("offset of 1 %", {.offset = {0.01, 0.01, 0.01}}, offset, 10, "sensor.black-offset.offset", 0.01);
  EXPECT_EQ(a.first, 10);
  EXPECT_GE(a.covered, a.intervals * 8 / 10);
  EXPECT_GE(ask("offsets of a balanced picture", {.offset = {0.02, 0.01, 0.015}}, offset, 6).listed, 5);
}

TEST(Chart, ResponseFullScaleAndUnevenLightAreNamed) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  EXPECT_GE(ask("bent by 15 %", {.quadratic = -0.15}, "sensor.non-linearity", 6).first, 5);
  EXPECT_GE(ask("coded for a screen", {.gamma = 1 / 2.2}, "sensor.non-linearity", 6).first, 5);
  EXPECT_GE(ask("clipped at 60 %", {.full_scale = 0.6}, "sensor.saturation", 6).first, 5);
  EXPECT_GE(ask("light that falls by 12 %", {.across = 0.12, .down = -0.05}, "light.inverse-square", 6).first, 5);
}

// Its values become parameters of the table, and asked again nothing is left.
TEST(Chart, UnevenLightIsWrittenAndNotAskedTwice) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  const World world = chart_world(1, chart_spectra(cameras[0]), {.across = 0.12});
  const TablesProblem problem = world.problem();
  const Explanation e = explain(problem, {});
  ASSERT_EQ(named(problem, e), "light.inverse-square") << e.sentence;
  manifest::Document document = world.document();
  problem.apply(e, document);
  const manifest::Parameter& nearness = document.tables.at("t").parameters.at("nearness_x");
  EXPECT_NEAR(nearness.scalar(), -0.06, 0.02);  // (1 + n d)^-2 is 1 - 2 n d
  const TablesProblem again(document, "t", {}, false);
  EXPECT_EQ(named(again, explain(again, {})), "");
}

// The camera's own curves stated: what they do to colours is named, and all of it; of the eye's functions in their
// place nothing is left that a matrix does not make.
TEST(Chart, MetamerismIsNamedWhereTheSensorIsKnown) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  int found = 0, covered = 0, wrong = 0;
  constexpr int seeds = 9;
  for (int seed = 1; seed <= seeds; ++seed) {
    const std::string camera = cameras[static_cast<std::size_t>(seed) % cameras.size()];
    const TablesProblem problem =
        chart_world(static_cast<std::uint64_t>(seed), chart_spectra(camera), {.print = 0.004, .sensed = camera})
            .problem();
    const Explanation e = explain(problem, {});
    const std::set<std::string> all = listed_in(problem, e);
    found += all.contains("colour.metamerism"), wrong += !all.empty() && !all.contains("colour.metamerism");
    std::printf("%d: %s\n", seed, e.sentence.c_str());
    if (const Estimate* x = estimate_of(problem, e, "colour.metamerism.share"))
      covered += x->lower_95 <= 1 && 1 <= x->upper_95;
  }
  EXPECT_GE(found, 8);
  EXPECT_GE(covered, 7);
  EXPECT_EQ(wrong, 0);
}

// A camera that sees as the eye does, and the curves of another one stated for it.
TEST(Chart, NoMetamerismOfASensorThatSeesAsTheEyeDoes) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  int nothing = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    const std::string camera = cameras[static_cast<std::size_t>(seed) % cameras.size()];
    ChartSpectra eye = chart_spectra(camera);
    eye.camera = eye.observer;
    const TablesProblem problem =
        chart_world(static_cast<std::uint64_t>(seed), eye, {.print = 0.004, .sensed = camera}).problem();
    nothing += named(problem, explain(problem, {})).empty();
  }
  EXPECT_GE(nothing, 19);
}

// X-Rite's values of before November 2014, and what was read of a Passport before a window (17 codes on black, as its
// source says), with the right black and with one that is 72 codes too low.
World passport(double black, const std::string& sensed = "") {
  const colour::Chart chart = colour::colorchecker_classic("before-2014", "test");
  World w;
  w.columns = {{"patch", ""}, {"fold", ""}, {"X", "1"}, {"Y", "1"}, {"Z", "1"}, {"x", "1"}, {"y", "1"}};
  for (const char* name : {"R", "G", "B", "R_sigma", "G_sigma", "B_sigma"}) w.columns.emplace_back(name, "1");
  w.rest =
      R"("model": "chart", "observed": ["R", "G", "B"], "sigma": ["R_sigma", "G_sigma", "B_sigma"], "group": "fold")";
  ChartNumbers spectral{};
  if (!sensed.empty()) {
    for (const char* name : {"sensed_R", "sensed_G", "sensed_B"}) w.columns.emplace_back(name, "1");
    const ChartSpectra s = chart_spectra(sensed);
    std::array<double, 24> once{};
    once.fill(1);
    for (std::size_t c = 0; c < 3; ++c) {
      const ChartNumbers of_channel = integrated(s, s.camera, c, once);
      for (std::size_t p = 0; p < 24; ++p) spectral[p][c] = of_channel[p][c];
    }
  }
  for (const auto& r : numbers_in(gonio::tests::data("colour/passport_canon550d/peer_patches.csv"))) {
    const colour::Patch& patch = chart.patches[w.rows.size()];
    w.rows.push_back({r[0], std::fmod(r[0] - 1, 8), patch.xyz.x, patch.xyz.y, patch.xyz.z, patch.centre.x,
                      patch.centre.y, r[3] - black, r[4] - black, r[5] - black, r[6], r[7], r[8]});
    const std::array<double, 3>& own = spectral[w.rows.size() - 1];
    if (!sensed.empty()) w.rows.back().insert(w.rows.back().end(), own.begin(), own.end());
  }
  return w;
}
TEST(ChartPhotographs, APassportBeforeAWindowShowsItsVeil) {
  GONIO_NEEDS_DATA("colour/passport_canon550d/peer_patches.csv");
  const TablesProblem problem = passport(2048).problem();
  const Explanation e = explain(problem, {});
  std::printf("%s\n", e.sentence.c_str());
  EXPECT_TRUE(e.significant);
  EXPECT_THAT(e.sentence, testing::Not(testing::HasSubstr("it could be sensor.black-offset")));
  EXPECT_TRUE(listed_in(problem, e).contains(offset));
  EXPECT_TRUE(listed_in(problem, e).contains(glare));
  const Estimate* green = estimate_of(problem, e, "sensor.black-offset.G/offset");
  ASSERT_NE(green, nullptr);
  EXPECT_NEAR(green->value, 17, 6);
}
TEST(ChartPhotographs, ABlackThatWasLeftIsNamed) {
  GONIO_NEEDS_DATA("colour/passport_canon550d/peer_patches.csv");
  const TablesProblem problem = passport(1976).problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), offset) << e.sentence;
}

// The same photograph, with the curves of a camera that has the same sensor (Canon 600D), measured elsewhere, and
// daylight for the window's light: what they do to colours is found beside the glare.
TEST(ChartPhotographs, MetamerismIsFoundByTheCurvesOfASisterCamera) {
  GONIO_NEEDS_DATA("colour/passport_canon550d/peer_patches.csv");
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  const TablesProblem problem = passport(2048, "Canon_600D_camspec_Canon_600D.csv").problem();
  const Explanation e = explain(problem, {});
  std::printf("%s\n", e.sentence.c_str());
  EXPECT_TRUE(listed_in(problem, e).contains("colour.metamerism")) << e.sentence;
}

TEST(Chart, WhatIsWrongWithATableIsSaid) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  World world = chart_world(1, chart_spectra(cameras[0]), {});
  World few = world, percent = world, one = world;
  for (std::size_t r = 0; r < few.rows.size(); ++r)
    for (const std::size_t c : {3u, 4u, 5u}) few.rows[r][c] = world.rows[r % 8][c];
  expect_refused(few, "has 8 patches of different colour, needs 12");
  percent.rows[0][4] = 90;
  expect_refused(percent, "a perfect white has Y = 1");
  one.rest = R"("model": "chart", "observed": ["R"])";
  expect_refused(one, "model chart predicts three");
}

}  // namespace
}  // namespace gonio::explain::tables::tests
