// Missing tracks: at random and in runs of frames, as occlusion leaves them.
#include <gtest/gtest.h>

#include "synthetic.h"

namespace gonio::nrsfm::testing {
namespace {

constexpr auto kAlignment = Alignment::global_similarity;

TEST(Completion, is_exact_for_exact_tracks) {
  for (const bool runs : {false, true}) {
    const Sequence whole = made({.shapes = 2, .cosines = 2});
    Sequence s = whole;
    if (runs)
      hide_in_runs(s, 18);
    else
      hide_at_random(s, 0.3);
    const Completion filled = complete(s, 6, 2000);
    const Eigen::MatrixXd tracks = filled.w.colwise() + filled.translation;
    EXPECT_LT((tracks - whole.tracks).norm(), 1e-4 * whole.tracks.norm()) << (runs ? "runs" : "at random");
    EXPECT_TRUE(filled.converged);
  }
}

// More shapes than the rank holds, points that few frames see: where least squares run away, what is filled in is
// nearer the truth than the mean of the points is.
TEST(Completion, stays_in_bounds_where_little_is_seen) {
  for (const Eigen::Index rank : {3, 6, 9}) {
    const Sequence whole = made({.frames = 40, .points = 40, .shapes = 4, .cosines = 8, .deformation = 0.3});
    Sequence s = whole;
    hide_in_runs(s, 16);
    for (Eigen::Index p = 16; p < 24; ++p)
      for (Eigen::Index f = 3; f < 40; ++f) hide(s, f, p);
    const Completion filled = complete(s, rank);
    const Eigen::MatrixXd tracks = filled.w.colwise() + filled.translation;
    const double size = (whole.tracks.colwise() - whole.tracks.rowwise().mean()).norm();
    EXPECT_LT((tracks - whole.tracks).norm(), 0.6 * size) << rank;
  }
}

TEST(Completion, keeps_what_was_measured) {
  Sequence s = made({.shapes = 2, .cosines = 2, .noise = 0.01});
  hide_at_random(s, 0.2);
  const Completion filled = complete(s, 6);
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (s.visible(f, p)) {
        const Eigen::Vector2d there = filled.w.block<2, 1>(2 * f, p) + filled.translation.segment<2>(2 * f);
        ASSERT_LT((there - s.tracks.block<2, 1>(2 * f, p)).norm(), 1e-12);
      }
}

class Missing : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Missing, ::testing::Values("rigid", "csf", "csf2", "ksta", "em_ppca"),
                         [](const auto& test) { return test.param; });

SolverValues values_of(const std::string& solver) {
  if (solver == "rigid") return {{"refine", 1}};
  if (solver == "em_ppca") return {{"rank", 1}};
  return {{"rank", 2}, {"camera_rank", 2}, {"dct_terms", 4}};
}

TEST_P(Missing, costs_little_where_the_model_fits) {
  const bool rigid = GetParam() == "rigid";
  const Recipe recipe{
      .frames = 40, .points = 30, .shapes = rigid ? 1 : 2, .cosines = rigid ? 1 : 4, .deformation = 0.2, .noise = 2e-3};
  const Sequence whole = made(recipe);
  const double with_all = error_of(answer(GetParam(), whole, values_of(GetParam())), whole, kAlignment);
  for (const bool runs : {false, true}) {
    Sequence s = whole;
    if (runs)
      hide_in_runs(s, 10);
    else
      hide_at_random(s, 0.25);
    const Solution solution = answer(GetParam(), s, values_of(GetParam()));
    EXPECT_TRUE(solution.reconstruction.shapes.allFinite());
    EXPECT_LT(error_of(solution, s, kAlignment), 2 * with_all + 0.02) << (runs ? "runs" : "at random");
  }
}

TEST(Missing, is_exact_for_csf_and_rigid_from_exact_tracks) {
  Sequence s = made({.shapes = 1, .cosines = 1});
  hide_in_runs(s, 20);
  EXPECT_LT(error_of(answer("rigid", s, {{"refine", 1}}), s, kAlignment), 1e-4);
  Sequence deforming = made({.shapes = 2, .cosines = 4, .deformation = 0.2});
  hide_at_random(deforming, 0.25);
  EXPECT_LT(
      error_of(answer("csf", deforming, {{"rank", 2}, {"camera_rank", 2}, {"dct_terms", 4}}), deforming, kAlignment),
      1e-3);
}

}  // namespace
}  // namespace gonio::nrsfm::testing
