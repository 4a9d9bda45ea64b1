// Unions of subspaces: which frames go together, and what that does for their shapes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "made.h"
#include "nrsfm/solve/self_expression.h"

namespace gonio::nrsfm::testing {
namespace {

// Rows of two subspaces of two dimensions each that share nothing but the mean; the first half lies in the first.
Eigen::MatrixXd two_planes(Eigen::Index frames, double noise, Random& random) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Ones(frames, 1) * normals(1, 30, random);
  rows.topRows(frames / 2) += normals(frames / 2, 2, random) * normals(2, 30, random);
  rows.bottomRows(frames - frames / 2) += normals(frames - frames / 2, 2, random) * normals(2, 30, random);
  return rows + noise * normals(frames, 30, random);
}

TEST(SelfExpression, joins_frames_of_one_subspace_and_explains_them) {
  Random random(1);
  for (const double noise : {0.0, 0.02}) {
    const Eigen::MatrixXd rows = two_planes(40, noise, random);
    const Eigen::MatrixXd c = self_expression(rows, 5);
    EXPECT_EQ(c.diagonal().cwiseAbs().maxCoeff(), 0);
    const double within = c.topLeftCorner(20, 20).cwiseAbs().sum() + c.bottomRightCorner(20, 20).cwiseAbs().sum();
    EXPECT_GT(within, 0.8 * c.cwiseAbs().sum()) << noise;
    const Eigen::MatrixXd less = rows.rowwise() - rows.colwise().mean();
    EXPECT_LT((less - c.transpose() * less).norm(), (0.1 + 2 * noise) * less.norm()) << noise;
    for (Eigen::Index f = 0; f < 40; ++f) EXPECT_LT((c.col(f).array() != 0).count(), 20) << f;
  }
}

TEST(SelfExpression, of_shapes_that_are_all_alike_is_zero) {
  EXPECT_EQ(self_expression(Eigen::MatrixXd::Ones(5, 9), 5), Eigen::MatrixXd::Zero(5, 5));
}

// First one motion, then another.
Sequence two_motions(double noise) {
  Sequence s = low_rank_sequence(60, 30, 1, 0);
  Random random(8);
  Eigen::MatrixXd basis = 0.4 * normals(12, s.points(), random);
  basis.colwise() -= basis.rowwise().mean().eval();
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const Eigen::Index first = f < 30 ? 0 : 2;
    const double t = 2 * M_PI * double(f % 30) / 15;
    shape_of(*s.truth, f) +=
        std::sin(t) * basis.middleRows<3>(3 * first) + std::sin(1.7 * t) * basis.middleRows<3>(3 * first + 3);
    s.tracks.middleRows<2>(2 * f) = (s.cameras[std::size_t(f)].rotation * shape_of(*s.truth, f)).topRows<2>();
  }
  s.tracks += noise * normals(2 * s.frames(), s.points(), random);
  return s;
}

TEST(Subspaces, of_two_motions_are_nearer_than_one_basis_for_both) {
  const Sequence s = two_motions(0.03);
  const SolverValues cameras{{"camera_rank", 5}};
  const Solution solution = answer("subspaces", s, cameras);
  EXPECT_TRUE(solution.converged);
  const double error = error_of(solution, s, Alignment::frame_rotation);
  RecordProperty("e3d", std::to_string(error));
  EXPECT_LT(error, error_of(answer("spfm", s, cameras), s, Alignment::frame_rotation));
  EXPECT_LT(solution.reprojection_rms, 1e-9);
}

// What noise hides from the points left out calls for no more helpers.
TEST(Subspaces, take_their_sparsity_from_tracks) {
  double last = 1e9;
  for (const double noise : {0.001, 0.03, 0.2}) {
    const Sequence s = two_motions(noise);
    const Solution chosen = answer("subspaces", s, {{"camera_rank", 5}});
    const double sparsity = chosen.values.at("sparsity");
    EXPECT_GE(sparsity, 2);
    EXPECT_LE(sparsity, last) << noise;
    last = sparsity;
    const Solution set = answer("subspaces", s, {{"camera_rank", 5}, {"sparsity", sparsity}});
    EXPECT_EQ(set.reconstruction.shapes, chosen.reconstruction.shapes);
  }
  EXPECT_LT(last, 80);
}

TEST(Subspaces, without_weight_are_the_shapes_of_least_nuclear_norm) {
  const Sequence s = low_rank_sequence(30, 20, 2, 0.02);
  const Shapes a = answer("subspaces", s, {{"camera_rank", 2}, {"weight", 0}}).reconstruction.shapes;
  EXPECT_EQ(a, answer("spfm", s, {{"camera_rank", 2}}).reconstruction.shapes);
}

TEST(Subspaces, do_not_depend_on_orders_nor_on_the_images_frame) {
  EXPECT_LT(change_when_reordered("subspaces", low_rank_sequence(30, 24, 2, 0.01), {{"camera_rank", 2}}, true), 0.05);
}

TEST(Subspaces, refuse_missing_tracks) {
  EXPECT_THAT(refusal_of_a_missing_track("subspaces"),
              ::testing::HasSubstr("missing, and subspaces needs all of them"));
}

}  // namespace
}  // namespace gonio::nrsfm::testing
