// The arm as a witness of what corners are said to show (explain/robot/robot_witness.h).
#include "explain/witness.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "explain/robot/robot_witness.h"
#include "explain/robot/robot_world.h"
#include "inference/nonlinear_toy.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/table.h"
#include "robot/chain/input.h"

namespace gonio::explain::tests {
namespace {

// Every pose of the board turned at random by about this much.
manifest::Document shaken(manifest::Document document, double turn_rad, std::uint64_t seed) {
  Random random(seed, 1);
  for (manifest::ImageEntry& image : document.images) {
    const Vec3 turn{random.normal() * turn_rad, random.normal() * turn_rad, random.normal() * turn_rad};
    image.camera_from_board->rotation = quaternion_of_rotation_vector(turn) * image.camera_from_board->rotation;
  }
  return document;
}

bool contradicted(const manifest::Document& stated, const manifest::Document& mended) {
  const std::vector<Testimony> told = hand_eye_testimony(stated, mended);
  EXPECT_EQ(told.size(), 2u);
  return std::ranges::any_of(told, &Testimony::contradicts);
}

TEST(Witness, PosesThatScatterMoreThroughTheArmContradict) {
  const manifest::Document cell = robot_cell({}, 30, 5);
  EXPECT_TRUE(contradicted(cell, shaken(cell, 1e-3, 1)));
}

TEST(Witness, PosesThatScatterLessOrAlikeDoNot) {
  const manifest::Document cell = robot_cell({}, 30, 5);
  EXPECT_FALSE(contradicted(shaken(cell, 1e-3, 1), cell));
  EXPECT_FALSE(contradicted(cell, cell));
}

// Another draw of the same noise is no objection: of two hundred, at most two (one in a thousand by each quantity).
TEST(Witness, IsSeldomWrong) {
  std::size_t wrong = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const manifest::Document cell = robot_cell({}, 20, seed);
    wrong += contradicted(shaken(cell, 3e-4, 2 * seed + 1), shaken(cell, 3e-4, 2 * seed + 2));
  }
  EXPECT_LE(wrong, 2u);
}

// A domain whose own fit speaks against whatever it has named.
std::optional<Testimony> always(const Problem&, const Explanation&, std::size_t) {
  Testimony t{"somebody", "something", "m", 1, 2, 0};
  t.refuted = true;
  return t;
}

TEST(Witness, WhatIsContradictedIsNotNamedAndIsAskedNoMoreThanOnce) {
  const NonlinearToy bent(library(), {{1.5}}, {{}, 0.1, 0}, 3, {8, 40, 2});
  const Domain domain{.name = "toy", .sentence = "", .objects = always};
  const Explanation e = explain_before_witnesses(domain, bent, {}, {}, {});
  EXPECT_TRUE(e.named.empty()) << e.sentence;
  ASSERT_FALSE(e.contradicted.empty());
  EXPECT_NE(e.sentence.find("is not named: somebody contradicts it"), std::string::npos) << e.sentence;
}

// Where nothing else was asked for, the name stands, and the contradiction beside it.
TEST(Witness, ALoneHypothesisStandsWithItsContradiction) {
  const NonlinearToy bent(library(), {{1.5}}, {{}, 0.1, 0}, 3, {8, 40, 2});
  const Domain domain{.name = "toy", .sentence = "", .objects = always};
  Options options;
  options.hypotheses = {bent.candidates()[0].id()};
  const Explanation e = explain_before_witnesses(domain, bent, options, {}, {});
  ASSERT_EQ(e.named, std::vector<std::size_t>{0}) << e.sentence;
  EXPECT_NE(e.sentence.find("But somebody contradicts"), std::string::npos) << e.sentence;
}

// Views that take no part have poses that no witness can use: of parts of the recordings none is asked.
TEST(Witness, OfAPartOfTheRecordingsNoOtherIsAsked) {
  const NonlinearToy bent(library(), {{1.5}}, {{}, 0.1, 0}, 3, {8, 40, 2});
  manifest::Document document = robot_cell({}, 20, 5);
  for (manifest::ImageEntry& image : document.images) image.camera_from_board->sigma.reset();
  document.tables.clear();
  const Domain domain{.name = "boards", .sentence = ""};  // the robot is its witness
  const Explanation e = explain_before_witnesses(domain, bent, {}, {}, document, {0});
  EXPECT_FALSE(e.named.empty()) << e.sentence;
}

// Poses that were fitted with terms that the chain does not know are taken as they stand; others are solved from their
// corners.
TEST(Witness, CornersThatOtherTermsMoveAreLeftToTheirPoses) {
  manifest::Document cell = robot_cell({}, 20, 5);
  for (manifest::ImageEntry& image : cell.images) image.camera_from_board->sigma = {{1e-4}, {1e-4}};
  const auto has_corners = [&](const std::string& id, const std::string& parameter, double value) {
    manifest::Document document = cell;
    document.mechanisms[id].parameters[parameter].value = {value};
    return !robot::robot_inputs(document).at(0).views.at(0).corners.empty();
  };
  EXPECT_FALSE(has_corners("lens.non-central", "pupil_m", 0.004));
  EXPECT_TRUE(has_corners("lens.non-central", "pupil_m", 0));
  EXPECT_TRUE(has_corners("board.scale", "scale_x", 0.002));
  EXPECT_TRUE(has_corners("sensor.exposure", "relative", 0.1));
}

}  // namespace
}  // namespace gonio::explain::tests
