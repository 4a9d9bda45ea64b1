// What an orthographic solver's camera left out is found in its residuals and named; where nothing was left out,
// nothing is.
#include <gmock/gmock.h>

#include <cstdio>

#include "tracks_world.h"

namespace gonio::explain {
namespace {

using testing::Answer;
using testing::explained;
using testing::film;
using testing::Film;
using testing::known;
using testing::Sequence;
using testing::solved;

// Between the solver's answer and the engine: predictions fit the tracks, and derivatives are those of predictions.
TEST(TracksProblem, DerivativesAreThoseOfThePredictions) {
  Film f;
  f.frames = 12, f.points = 12, f.zoom = 0.05;
  const auto problem = testing::problem_of(solved(film(f), "pta", {{"terms", 2}, {"free_scales", 1}}));
  std::vector<double> values;
  Random random(3);
  for (const Parameter& p : problem->parameters()) values.push_back(p.start + 20 * p.size * random.normal());
  std::vector<std::size_t> columns;
  for (std::size_t p = 0; p < values.size(); ++p) columns.push_back(p);
  const std::size_t group = 5, rows = problem->observations().first[group + 1] - problem->observations().first[group];
  std::vector<double> given(rows * columns.size()), differences(given.size());
  problem->jacobian(values, group, columns, given);
  problem->Problem::jacobian(values, group, columns, differences);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    double largest = 0, error = 0;
    for (std::size_t r = 0; r < rows; ++r) {
      largest = std::max(largest, std::abs(given[c * rows + r]));
      error = std::max(error, std::abs(given[c * rows + r] - differences[c * rows + r]));
    }
    EXPECT_LE(error, 1e-6 * largest + 1e-7) << problem->parameters()[c].name;
  }
}

TEST(ExplainNrsfm, NothingIsNamedWhereNothingWasLeftOut) {
  const Answer a = explained(solved(film({}), "pta", {{"terms", 2}}));
  EXPECT_TRUE(a.named.empty()) << a.e.sentence;
  EXPECT_EQ(a.e.verdict, Verdict::null) << a.e.sentence;
  EXPECT_NEAR(a.e.held_out_before, 0.3 * std::sqrt(2.0), 0.25);
}

TEST(ExplainNrsfm, PerspectiveIsNamedAndItsFocalLengthFound) {
  Film f;
  f.inverse_focal = 1e-4;  // depths of 2.5 x 100 px: 2.5 % of the distance
  const Answer a = explained(solved(film(f), "pta", {{"terms", 2}}));
  ASSERT_THAT(a.named, ::testing::ElementsAre("tracks.perspective")) << a.e.sentence;
  const Estimate* kappa = a.estimate("inverse_focal_per_px");
  ASSERT_NE(kappa, nullptr);
  EXPECT_NEAR(std::abs(kappa->value), f.inverse_focal, 4 * kappa->sigma) << a.e.sentence;
  EXPECT_LT(kappa->sigma, 0.1 * f.inverse_focal);
  EXPECT_LT(a.e.held_out_after, 0.9 * a.e.held_out_before);
  std::puts(a.e.sentence.c_str());
}

TEST(ExplainNrsfm, ScalesOfFramesAreNamed) {
  Film f;
  f.zoom = 0.02;
  const Answer a = explained(solved(film(f), "pta", {{"terms", 2}}));
  ASSERT_THAT(a.named, ::testing::ElementsAre("tracks.scale")) << a.e.sentence;
  EXPECT_LT(a.e.held_out_after, 0.9 * a.e.held_out_before);
  std::puts(a.e.sentence.c_str());
}

TEST(ExplainNrsfm, ObservationsThatDoNotFollowAreNamed) {
  Sequence s = film({});
  s.tracks(2 * 7, 3) += 15;
  s.tracks(2 * 11 + 1, 12) -= 12;
  for (Eigen::Index k = 14; k < 18; ++k) s.tracks(2 * k, 18) += 10;
  const Answer a = explained(solved(s, "pta", {{"terms", 2}}));
  ASSERT_THAT(a.named, ::testing::ElementsAre("tracks.outliers")) << a.e.sentence;
  EXPECT_THAT(a.problem->candidates()[a.e.named[0]].on,
              ::testing::ElementsAre("film/point-3/frame-7", "film/point-12/frame-11", "film/point-18/frames-14-17"));
  EXPECT_LT(a.e.held_out_after, 0.9 * a.e.held_out_before);
  ASSERT_NE(a.estimate("point-18/frames-14-17/slip_u_px"), nullptr);
  EXPECT_NEAR(a.estimate("point-18/frames-14-17/slip_u_px")->value, 10, 1);
  std::puts(a.e.sentence.c_str());
}

// A shape that the basis lacks is no camera's doing.
TEST(ExplainNrsfm, MoreDeformationIsNotTakenForPerspective) {
  Film f;
  f.shapes = 3, f.frames = 18, f.deformation = 0.1;
  const Answer a = explained(solved(film(f), "pta", {{"terms", 2}}));
  EXPECT_TRUE(a.named.empty()) << a.e.sentence;
  EXPECT_EQ(a.e.verdict, Verdict::unknown) << a.e.sentence;
  std::puts(a.e.sentence.c_str());
}

// Weights that are free in every frame take the scales up: these recordings cannot show them.
TEST(ExplainNrsfm, ScalesHideInFreeWeights) {
  Film f;
  f.zoom = 0.02;
  gonio::nrsfm::Solved input = known(film(f));
  for (Eigen::Index k = 0; k < f.frames; ++k)  // the same tracks with the zoom in the shapes
    gonio::nrsfm::shape_of(input.reconstruction.shapes, k) *= 1 + 0.3 * std::sin(double(k * k));
  const Answer a = explained(input);
  EXPECT_TRUE(a.named.empty()) << a.e.sentence;
  for (const Isolability& i : a.e.isolability)
    EXPECT_FALSE(a.problem->candidates()[i.candidate].id() == "tracks.scale" && i.visible);
  std::puts((a.e.sentence + " " + a.e.next_measurement).c_str());
}

// A thing that hardly turns hides its perspective in its shape: that is said before anything is judged.
TEST(ExplainNrsfm, ThingsThatHardlyTurnShowLittlePerspective) {
  const auto isolated = [](double turn_rad) {
    Film f;
    f.shapes = 1, f.turn_rad = turn_rad;
    const Answer a = explained(known(film(f)));
    EXPECT_TRUE(a.named.empty()) << a.e.sentence;
    for (const Isolability& i : a.e.isolability)
      if (a.problem->candidates()[i.candidate].id() == "tracks.perspective") return i;
    return Isolability{};
  };
  const Isolability turning = isolated(0.8), still = isolated(0.03);
  EXPECT_LT(still.surviving_share, 0.1 * turning.surviving_share);
  EXPECT_GT(still.detection_limit.at(0), 10 * turning.detection_limit.at(0));
}

TEST(ExplainNrsfm, HiddenPointsAreNoHindrance) {
  Film f;
  f.inverse_focal = 1e-4;
  Sequence s = film(f);
  for (Eigen::Index p = 0; p < f.points; ++p)  // for a fifth of the frames, as behind something
    for (Eigen::Index k = 0; k < 4; ++k) {
      const Eigen::Index t = (p + k) % f.frames;
      s.visible(t, p) = false;
      s.tracks.block<2, 1>(2 * t, p).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  const Answer a = explained(known(s));
  ASSERT_THAT(a.named, ::testing::ElementsAre("tracks.perspective")) << a.e.sentence;
  const Estimate* kappa = a.estimate("inverse_focal_per_px");
  EXPECT_NEAR(kappa->value, f.inverse_focal, 4 * kappa->sigma) << a.e.sentence;  // the truth's hand is right
}

}  // namespace
}  // namespace gonio::explain
