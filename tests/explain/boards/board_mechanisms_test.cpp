// Every effect of tables of corners, left out of the base model and put into boards that share no code with the library
// (explain/board_world.h): it is named, located, its interval covers; where it is absent it is not named; and where the
// recordings cannot show it, explain says so. Two recordings are asked two things each, of one answer.
// One process: BoardMechanisms.*
#include <gmock/gmock.h>

#include <cmath>

#include "explain/boards/board_world.h"
#include "explain/boards/boards_problem.h"
#include "explain/engine.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::explain::tests {
namespace {

using prove::CaseDesign;
using prove::CaseTruth;

struct Answer {
  std::unique_ptr<Problem> problem;
  Explanation e;
  manifest::Document document;
  std::vector<std::string> named, reported;  // reported: named, or not told apart from what is

  const Estimate& estimate(const std::string& parameter) const {
    for (const Estimate& estimate : e.estimates)
      if (problem->parameters()[estimate.parameter].name == parameter) return estimate;
    throw std::runtime_error("nothing estimated for " + parameter + ": " + e.sentence);
  }
  const Isolability& isolability(const std::string& id) const {
    for (const Isolability& i : e.isolability)
      if (problem->candidates()[i.candidate].id() == id) return i;
    throw std::runtime_error(id + " is no candidate");
  }
};
Answer explained(const CaseTruth& truth, const CaseDesign& design, std::size_t views, std::uint64_t seed,
                 const Options& options = {}) {
  Answer a;
  a.document =
      manifest::parse_document(prove::board_case("sealed", truth, views, seed, design).manifest, "sealed", ".");
  a.problem = boards_problem(boards_input(a.document));
  a.e = explain(*a.problem, options);
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  a.reported = a.named;
  for (const auto& set : a.e.not_told_apart)
    for (const std::size_t c : set) a.reported.push_back(a.problem->candidates()[c].id());
  return a;
}
void expect_covers(const Answer& a, const std::string& parameter, double truth) {
  const Estimate& e = a.estimate(parameter);
  EXPECT_NEAR(e.value, truth, 3.5 * e.sigma) << parameter << " " << a.e.sentence;
}

CaseDesign known_lens() {
  CaseDesign d;
  d.knows_lens = true;
  d.misplaced = 0;
  return d;
}

TEST(BoardMechanisms, AColouredFringeIsLateralColour) {
  CaseDesign design = known_lens();
  design.coloured = true;
  CaseTruth truth;
  truth.lens.red = 8e-4, truth.lens.blue = -1.1e-3, truth.lens.blue_more = -2e-3;
  const Answer a = explained(truth, design, 8, 1);
  EXPECT_THAT(a.named, testing::ElementsAre("lens.lateral-colour")) << a.e.sentence;
  expect_covers(a, "lens.lateral-colour.red_linear", 8e-4);
  expect_covers(a, "lens.lateral-colour.blue_linear", -1.1e-3);
  expect_covers(a, "lens.lateral-colour.blue_cubic", -2e-3);
  EXPECT_THAT(a.e.conditions[0].name, testing::AnyOf("camera.image-radius-by-channel", "camera.channel"));
  EXPECT_LT(a.e.held_out_after, a.e.held_out_before);
}

TEST(BoardMechanisms, AMovingPupilIsANonCentralLens) {
  CaseDesign design = known_lens();
  design.focal_px = 330;  // wide: 44 degrees to the sides, a large board, good corners
  design.columns = 13, design.rows = 9;
  design.square_m = 0.03;
  design.least_noise_px = design.most_noise_px = 0.05;
  CaseTruth truth;
  truth.lens.pupil_m = 6e-3;
  const Answer a = explained(truth, design, 16, 2);
  EXPECT_THAT(a.named, testing::ElementsAre("lens.non-central")) << a.e.sentence;
  expect_covers(a, "lens.non-central.pupil_m", 6e-3);
  EXPECT_THAT(a.e.conditions[0].name, testing::AnyOf("camera.image-radius-over-distance", "camera.distance"));
}

const Answer& stretched() {
  CaseTruth truth;
  truth.board.stretch_x = 0.004;
  static const Answer answer = explained(truth, known_lens(), 12, 3);
  return answer;
}

TEST(BoardMechanisms, AStretchedPrintIsTheBoards) {
  const Answer& a = stretched();
  EXPECT_THAT(a.named, testing::ElementsAre("board.scale")) << a.e.sentence;
  expect_covers(a, "board.scale.scale_x", 0.004);
  EXPECT_EQ(a.e.conditions[0].name, "board.roll");
  EXPECT_EQ(a.e.stage, "board");
}

// What is named goes into the manifest's mechanisms, the base model of a second look has it, and nothing is left.
TEST(BoardMechanisms, WhatIsNamedIsModelledInTheManifest) {
  const Answer& a = stretched();
  manifest::Document document = a.document;
  a.problem->apply(a.e, document);
  const manifest::MechanismUse& use = document.mechanisms.at("board.scale");
  EXPECT_THAT(use.on, testing::ElementsAre("b"));
  EXPECT_NEAR(use.parameters.at("scale_x").scalar(), 0.004, 5e-4);
  const auto again = boards_problem(boards_input(document));
  for (const Candidate& c : again->candidates()) EXPECT_NE(c.id(), "board.scale");
  const Explanation e = explain(*again, {});
  EXPECT_EQ(e.verdict, Verdict::null) << e.sentence;
  EXPECT_NEAR(e.held_out_before, a.e.held_out_after, 0.02 * a.e.held_out_after);
}

CaseDesign warming() {
  CaseDesign d = known_lens();
  d.warming_K = 12;
  d.takes = 8;  // a fixed target
  return d;
}
CaseTruth drifting() {
  CaseTruth truth;
  truth.drift.x_px = 0.08, truth.drift.y_px = -0.05, truth.drift.focal = 3e-5;
  return truth;
}

const Answer& drift_over_a_fixed_target() {
  static const Answer answer = explained(drifting(), warming(), 3, 4);
  return answer;
}

TEST(BoardMechanisms, ADriftOverAFixedTargetIsTheCamerasTemperature) {
  const Answer& a = drift_over_a_fixed_target();
  EXPECT_THAT(a.named, testing::ElementsAre("camera.thermal")) << a.e.sentence;
  expect_covers(a, "camera.thermal.x_px_per_K", 0.08);
  expect_covers(a, "camera.thermal.y_px_per_K", -0.05);
  expect_covers(a, "camera.thermal.focal_per_K", 3e-5);
  EXPECT_THAT(a.e.conditions[0].name, testing::StartsWith("camera.temperature"));
}

// A hand-held board follows the drift: its pose takes most of it, and the isolability says how much is left.
TEST(BoardMechanisms, AMovedBoardHidesTheDriftAndTheIsolabilitySaysSo) {
  CaseDesign moved = warming();
  moved.takes = 1;
  const Answer a = explained(drifting(), moved, 24, 4);
  const Answer& fixed = drift_over_a_fixed_target();
  EXPECT_LT(a.isolability("camera.thermal").surviving_share, 0.1);
  EXPECT_GT(fixed.isolability("camera.thermal").surviving_share, 0.3);
}

TEST(BoardMechanisms, ADetectorsBiasShowsOnlyInTurnedPictures) {
  CaseTruth truth;
  truth.bias_x_px = 0.5;
  CaseDesign design = known_lens();
  const Answer upright = explained(truth, design, 8, 5);
  EXPECT_TRUE(upright.named.empty()) << upright.e.sentence;
  EXPECT_FALSE(upright.isolability("board.corner-bias").visible);
  EXPECT_LT(upright.isolability("board.corner-bias").surviving_share, 1e-3);
  design.turned = true;
  design.takes = 2;  // the same picture, searched twice
  const Answer turned = explained(truth, design, 6, 5);
  EXPECT_THAT(turned.named, testing::ElementsAre("board.corner-bias")) << turned.e.sentence;
  expect_covers(turned, "board.corner-bias.bias_x_px", 0.5);
}

// All at once could be asked of these recordings, and none is there.
TEST(BoardMechanisms, WhereNothingIsLeftOutNothingIsNamed) {
  int named = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    CaseDesign design = known_lens();
    design.columns = 7, design.rows = 5;
    design.coloured = seed % 3 == 0;
    design.turned = seed % 3 == 1;
    design.warming_K = seed % 2 == 0 ? 8 : 0;
    design.takes = seed % 4 == 0 ? 4 : 1;
    CaseTruth truth;
    truth.lens.k1 = -0.15;
    named += !explained(truth, design, design.takes > 1 ? 3 : 9, 50 + seed).named.empty();
  }
  EXPECT_LE(named, 1);  // 1 % each: more than one in twelve has a chance of 0.6 %
}

// Frontal views from one range: a bowing lens and a bulging board draw the same lines, and both are reported. A board
// that is moved about in front of the lens, or held aslant, tells its own bulge.
TEST(BoardMechanisms, FrontalViewsAtOneRangeCannotTellTheLensFromTheBoard) {
  CaseDesign design;
  design.misplaced = 0;
  design.frontal = true;
  design.least_noise_px = design.most_noise_px = 0.1;
  CaseTruth bowing, bulging;
  bowing.lens.k1 = -0.04;
  bulging.board.sag_x_m = bulging.board.sag_y_m = 1.5e-3;
  const Answer lens = explained(bowing, design, 10, 6);
  EXPECT_EQ(lens.e.verdict, Verdict::ambiguous) << lens.e.sentence;
  EXPECT_THAT(lens.reported, testing::IsSupersetOf({"lens.radial", "board.warp"})) << lens.e.sentence;
  EXPECT_FALSE(lens.e.next_measurement.empty());
  EXPECT_THAT(explained(bulging, design, 10, 6).reported, testing::Contains("board.warp"));
  design.frontal = false;
  const Answer aslant = explained(bowing, design, 10, 6);
  EXPECT_THAT(aslant.named, testing::ElementsAre("lens.radial")) << aslant.e.sentence;
  EXPECT_EQ(aslant.e.verdict, Verdict::named) << aslant.e.sentence;
}

}  // namespace
}  // namespace gonio::explain::tests
