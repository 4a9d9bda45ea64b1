// Structured missing data: what few frames see stays near the rest, and the rank is that of the shapes.
#include <gtest/gtest.h>

#include "made.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::testing {
namespace {

// The first points are seen at the sequence's two ends alone, `seen` frames in all.
void hide_middle(Sequence& s, Eigen::Index points, Eigen::Index seen) {
  for (Eigen::Index p = 0; p < points; ++p)
    for (Eigen::Index f = seen / 2; f < s.frames() - (seen - seen / 2); ++f) hide(s, f, p);
}

TEST(CompletionRank, is_that_of_the_shapes) {
  for (const Eigen::Index shapes : {1, 2, 3}) {
    Sequence s = low_rank_sequence(40, 40, shapes, 0.005);
    hide_in_runs(s, 12);
    EXPECT_EQ(completion_rank(s, 1e-2, 8), shapes);
  }
}

TEST(CompletionRank, does_not_grow_with_noise) {
  Sequence s = low_rank_sequence(40, 40, 2, 0.1);
  hide_in_runs(s, 12);
  EXPECT_LE(completion_rank(s, 1e-3, 8), 2);
}

// Six frames offer 12 equations for the 9 coordinates of a point: without priors noise in them becomes depth of any
// size.
TEST(FewFrames, do_not_throw_points_far_away) {
  const Sequence whole = low_rank_sequence(40, 40, 3, 0.02);
  Sequence s = whole;
  hide_middle(s, 8, 6);
  for (const char* solver : {"csf", "csf2", "ksta"}) {
    const SolverValues values{{"rank", 3}, {"camera_rank", 3}, {"dct_terms", 6}};
    const double all = error_of(answer(solver, whole, values), whole, Alignment::frame_rotation);
    EXPECT_LT(error_of(answer(solver, s, values), s, Alignment::frame_rotation), all + 0.25) << solver;
  }
}

TEST(FewFrames, are_enough_where_tracks_are_exact) {
  Sequence s = low_rank_sequence(40, 40, 2, 0);
  hide_middle(s, 8, 8);
  const SolverValues values{{"rank", 2}, {"camera_rank", 2}, {"dct_terms", 2}};
  EXPECT_LT(error_of(answer("csf", s, values), s, Alignment::global_similarity), 1e-2);
}

// Complete tracks, true cameras that hardly turn, and more basis shapes than there are: without the priors noise
// becomes depth there, too.
TEST(Priors, keep_depths_in_bounds_where_cameras_hardly_turn) {
  Sequence s = low_rank_sequence(40, 40, 2, 0);
  Random random(9);
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    CameraFromObject& camera = s.cameras[std::size_t(f)];
    const Eigen::AngleAxisd whole(camera.rotation);
    camera.rotation = Eigen::AngleAxisd(0.25 * whole.angle(), whole.axis()).toRotationMatrix();
    s.tracks.middleRows<2>(2 * f) = (camera.rotation * shape_of(*s.truth, f)).topRows<2>();
  }
  s.tracks += 0.02 * normals(80, 40, random);
  Start start = centred_start(s, 5);
  start.rows.resize(80, 3);
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    start.rows.middleRows<2>(2 * f) = s.cameras[std::size_t(f)].rotation.topRows<2>();
  ShapeTrajectoryProblem problem = linear_problem(s, start, 10);
  const Eigen::MatrixXd cosines = Eigen::MatrixXd::Identity(10, 5);
  const auto error = [&](const ShapeTrajectory& fit) {
    return e3d(shapes_of(fit.coefficients, fit.basis), *s.truth, Alignment::none);
  };
  const double without = error(fit_shape_trajectory(problem, cosines));
  const double with = error(fit_with_translation(problem, cosines, start.translation));
  RecordProperty("without", std::to_string(without));
  RecordProperty("with", std::to_string(with));
  EXPECT_LT(with, 0.5 * without);
  EXPECT_LT(with, 0.08);
}

}  // namespace
}  // namespace gonio::nrsfm::testing
