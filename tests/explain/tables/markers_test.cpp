// Markers on pieces: derivatives, what is named and what is said not to be tellable, what goes back into the scene.
// Statistics over many seeds, with traced glass, errors of cameras and tomograph: scripts/prove sealed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "marker_world.h"

namespace gonio::explain::tables::tests {
namespace {

using testing::HasSubstr;

const Candidate& candidate_of(const Problem& problem, const std::string& id, const std::vector<std::string>& on = {}) {
  for (const Candidate& c : problem.candidates())
    if (c.id() == id && c.on == on) return c;
  ADD_FAILURE() << id;
  return problem.candidates()[0];
}
const Isolability& isolability_of(const Problem& problem, const Explanation& e, const std::string& id,
                                  const std::vector<std::string>& on = {}) {
  for (const Isolability& i : e.isolability)
    if (problem.candidates()[i.candidate].id() == id && problem.candidates()[i.candidate].on == on) return i;
  ADD_FAILURE() << id;
  return e.isolability[0];
}

TEST(Markers, DerivativesReachTheRowsThatAParameterReaches) {
  Pieces pieces;
  pieces.glass = true;
  const TablesProblem problem = marker_world(1, pieces).problem();
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral + 0.3 * p.size);
  std::vector<std::size_t> columns(values.size());
  for (std::size_t k = 0; k < columns.size(); ++k) columns[k] = k;
  const std::size_t rows = problem.table().rows();
  std::vector<double> own(2 * rows * columns.size()), plain(own.size());
  problem.bound().jacobian(values, 0, rows, columns, own);
  problem.bound().BoundModel::jacobian(values, 0, rows, columns, plain);
  double largest = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    ASSERT_NEAR(own[i], plain[i], 1e-6 * (1 + std::abs(plain[i]))) << problem.parameters()[i / (2 * rows)].name;
    largest = std::max(largest, std::abs(own[i]));
  }
  EXPECT_GT(largest, 1000);  // pixels a metre
  for (const Candidate& c : problem.candidates())
    for (const std::size_t p : c.parameters) {
      double sum = 0;
      for (std::size_t i = 0; i < 2 * rows; ++i) sum += std::abs(own[p * 2 * rows + i]);
      EXPECT_GT(sum, 0) << problem.parameters()[p].name;
    }
}

TEST(Markers, GlueIsNamedAndAPoseThatIsFreeHidesWhatMovesThePiece) {
  Pieces pieces;
  pieces.glue_m = 2e-4;
  const TablesProblem problem = marker_world(2, pieces).problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "marker.offset") << e.sentence;
  const Estimate* thickness = estimate_of(problem, e, "marker.offset.thickness_m");
  ASSERT_NE(thickness, nullptr);
  EXPECT_LE(thickness->lower_95, 2e-4);
  EXPECT_GE(thickness->upper_95, 2e-4);
  EXPECT_FALSE(isolability_of(problem, e, "geometry.contact", {"1"}).visible);
  EXPECT_FALSE(isolability_of(problem, e, "geometry.pose", {"1"}).visible);
  EXPECT_TRUE(isolability_of(problem, e, "geometry.contact", {"2"}).visible);
  EXPECT_THAT(isolability_of(problem, e, "marker.offset").look_alikes, testing::IsEmpty());
}

TEST(Markers, OnABallGlueAndScaleLookAlike) {
  Pieces pieces;
  pieces.balls = true, pieces.glue_m = 2e-4;
  const TablesProblem problem = marker_world(3, pieces).problem();
  const Explanation e = explain(problem, {});
  EXPECT_THAT(isolability_of(problem, e, "marker.offset").look_alikes, testing::Not(testing::IsEmpty()));
  ASSERT_FALSE(e.not_told_apart.empty()) << e.sentence;
  std::vector<std::string> set;
  for (const std::size_t c : e.not_told_apart[0]) set.push_back(problem.candidates()[c].id());
  EXPECT_THAT(set, testing::IsSupersetOf({"marker.offset", "ct.scale"}));
}

TEST(Markers, APieceNudgedBetweenSittingsIsSaidAndNotEnteredInTheScene) {
  Pieces pieces;
  pieces.nudged_m = {2e-4, 0, 1e-4};
  const World world = marker_world(4, pieces);
  const TablesProblem problem = world.problem();
  const Explanation e = explain(problem, {});
  ASSERT_EQ(named(problem, e), "geometry.pose") << e.sentence;
  EXPECT_THAT(problem.candidates()[e.named[0]].on, testing::ElementsAre("2 in images second"));
  manifest::Document document = world.document();
  problem.apply(e, document);
  EXPECT_TRUE(document.mechanisms.empty());
}

// What is named goes into the scene, and from there back into the base model, which then lacks nothing.
TEST(Markers, MovedPiecesAreMovedInTheScene) {
  Pieces pieces;
  pieces.estimated = {false, false};
  pieces.moved_m = {Vec3{3e-4, 0, 0}, Vec3{0, -2e-4, 1e-4}};
  const World world = marker_world(5, pieces);
  const TablesProblem problem = world.problem();
  const Explanation e = explain(problem, {});
  ASSERT_EQ(named(problem, e), "geometry.pose geometry.pose") << e.sentence;
  manifest::Document document = world.document();
  problem.apply(e, document);
  const manifest::MechanismUse& use = document.mechanisms.at("geometry.pose");
  ASSERT_EQ(use.on.size(), 2u);
  const std::size_t second = use.on[0] == "2" ? 0 : 1;
  EXPECT_NEAR(use.parameters.at("shift_x_m").value.at(1 - second), 3e-4, 5e-5);
  EXPECT_NEAR(use.parameters.at("shift_y_m").value.at(second), -2e-4, 5e-5);
  const TablesProblem again(document, "t", {}, false);
  std::vector<double> values, prediction(2 * again.table().rows());
  for (const Parameter& p : again.parameters()) values.push_back(p.neutral);
  again.bound().predict(values, 0, again.table().rows(), prediction);
  double square = 0;
  for (std::size_t i = 0; i < prediction.size(); ++i)
    square += std::pow(again.observations().value[i] - prediction[i], 2) / static_cast<double>(prediction.size());
  EXPECT_LT(std::sqrt(square), 1.05 * pieces.noise_px);
}

// A lid that stands by contact: its height was not estimated.
TEST(Markers, ANumberThatIsHeldLetsContactBeTold) {
  Pieces pieces;
  pieces.estimated = {true, true};
  pieces.parameters = R"("2/shift_z_m": 0)";
  pieces.moved_m[1] = {1e-4, 0, -3e-4};
  const World world = marker_world(6, pieces);
  const TablesProblem problem = world.problem();
  EXPECT_EQ(candidate_of(problem, "geometry.pose", {"2"}).parameters.size(), 1u);
  const Explanation e = explain(problem, {});
  ASSERT_FALSE(e.not_told_apart.empty()) << e.sentence;
  std::vector<std::string> set;
  for (const std::size_t c : e.not_told_apart[0]) set.push_back(problem.candidates()[c].id());
  EXPECT_THAT(set, testing::IsSupersetOf({"geometry.contact", "geometry.pose"}));
  manifest::Document document = world.document();
  problem.apply(e, document);
  const auto& pose = document.objects[1].world_from_object;
  EXPECT_NEAR(pose->translation_m.x, 0.01 + 1e-4, 5e-5);
  ASSERT_TRUE(pose->sigma);
  EXPECT_GT(pose->sigma->translation_m[0], 1e-6);
}

TEST(Markers, WhatTheManifestDoesNotHaveIsSaid) {
  World world = marker_world(7);
  world.rows[0][0] = 99;
  expect_refused(world, "has sightings in image \"99\", which the manifest does not have");
  world = marker_world(7);
  world.rows[0][1] = 7;
  expect_refused(world, "has markers of piece \"7\", which the manifest does not have");
  world = marker_world(7);
  world.rows[0][2] = 101;
  expect_refused(world, "has marker \"101\" on \"1\" and on \"2\"");
  world = marker_world(7);
  for (auto& [name, unit] : world.columns)
    if (name.ends_with("_sigma_px")) name = name.substr(0, 1) + "_width_px";
  world.rest = R"("model": "markers", "observed": ["u_px", "v_px"])";
  expect_refused(world, "does not say how well the markers were found");
  world = marker_world(7);
  for (std::vector<double>& row : world.rows) row[3] += row[0] == 1 ? 2 : 0;
  expect_refused(world, "behind whose camera it stands");
}

}  // namespace
}  // namespace gonio::explain::tables::tests
