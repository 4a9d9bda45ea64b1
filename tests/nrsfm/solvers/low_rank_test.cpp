// Shapes of least nuclear norm: optimality, coupling, and the block-matrix method on truths that it contains, on
// recorded sequences, and under changes that must not matter.
#include "nrsfm/solve/low_rank.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data.h"
#include "made.h"
#include "nrsfm/files.h"

namespace gonio::nrsfm::testing {
namespace {

// Of S#, as the squares of U sqrt(s); a decomposition of its own here would take the compiler a minute.
double nuclear_norm(const Shapes& shapes) {
  return motion_rows(rearranged(shapes), shapes.rows()).squaredNorm();
}

// Shapes that reproject alike: `depths` (F x P) more along what each frame's camera does not see.
Shapes deeper(const Shapes& shapes, const Eigen::MatrixXd& rows, const Eigen::MatrixXd& depths) {
  Shapes result = shapes;
  for (Eigen::Index f = 0; f < depths.rows(); ++f) {
    const Eigen::Vector3d unseen =
        Eigen::Vector3d(rows.row(2 * f)).cross(Eigen::Vector3d(rows.row(2 * f + 1))).normalized();
    shape_of(result, f) += unseen * depths.row(f);
  }
  return result;
}

Eigen::MatrixXd true_rows(const Sequence& s) {
  Eigen::MatrixXd rows(2 * s.frames(), 3);
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    rows.middleRows<2>(2 * f) = s.cameras[std::size_t(f)].rotation.topRows<2>();
  return rows;
}

TEST(Rearranged, goes_there_and_back) {
  Random random(1);
  const Shapes shapes = normals(12, 7, random);
  const Eigen::MatrixXd rows = rearranged(shapes);
  EXPECT_EQ(rows.rows(), 4);
  EXPECT_EQ(rows(2, 7 + 3), shapes(3 * 2 + 1, 3));  // frame 2, y, point 3
  EXPECT_EQ(arranged(rows), shapes);
}

TEST(LowRank, reprojects_exactly_and_lies_no_higher_than_its_bound_says) {
  const Sequence s = low_rank_sequence(20, 15, 3, 0.05);
  const Eigen::MatrixXd w = centred(s).w, rows = true_rows(s);
  const LowRankShapes found = low_rank_shapes({w, rows, {}, 0}, {1e-6, 5000});
  ASSERT_TRUE(found.converged);
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const Eigen::MatrixXd seen = rows.middleRows<2>(2 * f) * shape_of(found.shapes, f);
    EXPECT_LT((seen - w.middleRows<2>(2 * f)).norm(), 1e-12 * w.norm());
  }
  EXPECT_NEAR(found.nuclear_norm, nuclear_norm(found.shapes), 1e-9 * found.nuclear_norm);
  EXPECT_GE(found.nuclear_norm, found.bound);
  EXPECT_LT(found.nuclear_norm, found.bound * (1 + 1e-4));
  Random random(2);
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::MatrixXd direction = normals(s.frames(), s.points(), random);
    for (const double size : {1e-1, 1e-2, 1e-3})
      EXPECT_GE(nuclear_norm(deeper(found.shapes, rows, size * direction)), found.bound);
  }
}

TEST(LowRank, bound_holds_after_few_steps_too) {
  const Sequence s = low_rank_sequence(20, 15, 3, 0.05);
  const Eigen::MatrixXd w = centred(s).w, rows = true_rows(s);
  const double least = low_rank_shapes({w, rows, {}, 0}, {1e-6, 5000}).nuclear_norm;
  for (const int steps : {1, 3, 10, 30}) {
    const LowRankShapes early = low_rank_shapes({w, rows, {}, 0}, {1e-6, steps});
    EXPECT_FALSE(early.converged);
    EXPECT_EQ(early.iterations, steps);
    EXPECT_LE(early.bound, least * (1 + 1e-9));
    EXPECT_GE(early.nuclear_norm, least * (1 - 1e-6));
  }
}

// With a coupling the sum is convex as before: no direction goes down, and the deeper slope is zero at the answer.
TEST(LowRank, with_coupling_has_the_least_sum) {
  const Sequence s = low_rank_sequence(20, 15, 3, 0.05);
  const Eigen::MatrixXd w = centred(s).w, rows = true_rows(s);
  Eigen::MatrixXd steps = Eigen::MatrixXd::Zero(19, 20);  // differences of neighbouring frames
  for (Eigen::Index f = 0; f < 19; ++f) steps.block<1, 2>(f, f) << -1, 1;
  const LowRankProblem problem{w, rows, steps.transpose() * steps, 2};
  const LowRankShapes found = low_rank_shapes(problem, {1e-7, 20000});
  ASSERT_TRUE(found.converged);
  const auto sum = [&](const Shapes& x) {
    return nuclear_norm(x) + problem.coupling / 2 * (steps * rearranged(x)).squaredNorm();
  };
  const double least = sum(found.shapes);
  EXPECT_LT(least, 0.999 * sum(low_rank_shapes({w, rows, {}, 0}, {1e-6, 5000}).shapes));
  Random random(3);
  for (int trial = 0; trial < 30; ++trial) {
    const Eigen::MatrixXd direction = normals(s.frames(), s.points(), random);
    for (const double size : {1e-1, 1e-2, 1e-3})
      EXPECT_GE(sum(deeper(found.shapes, rows, size * direction)), least * (1 - 1e-6));
  }
}

TEST(Spfm, gives_back_shapes_of_low_rank) {
  const Sequence s = low_rank_sequence(40, 40, 3, 0);
  const Solution solution = answer("spfm", s, {{"camera_rank", 3}});
  EXPECT_TRUE(solution.converged);
  EXPECT_LT(error_of(solution, s, Alignment::global_similarity), 1e-3);
  EXPECT_LT(solution.reprojection_rms, 1e-9);
}

TEST(Spfm, finds_its_cameras_rank_and_bears_noise) {
  for (const double noise : {0.005, 0.02}) {
    const Sequence s = low_rank_sequence(40, 40, 3, noise);
    EXPECT_LT(error_of(answer("spfm", s), s, Alignment::frame_rotation), 6 * noise) << noise;
  }
}

TEST(Spfm, does_not_depend_on_orders_nor_on_the_images_frame) {
  EXPECT_LT(change_when_reordered("spfm", low_rank_sequence(30, 24, 2, 0.01), {{"camera_rank", 2}}, true), 0.02);
}

TEST(Spfm, refuses_missing_tracks) {
  EXPECT_THAT(refusal_of_a_missing_track("spfm"),
              ::testing::HasSubstr("of the tracks are missing, and spfm needs all of them"));
}

struct Recorded {
  std::string file;
  Alignment alignment;
  double published = 0, share = 1;
};
void PrintTo(const Recorded& r, std::ostream* out) {
  *out << r.file;
}
class SpfmOn : public ::testing::TestWithParam<Recorded> {};
// e3D of the block-matrix method in table 1 of Dai, Li & He (IJCV 2014), quoted from memory, and how much of it this
// program, with its own choice of the cameras' rank, may have.
INSTANTIATE_TEST_SUITE_P(Recorded, SpfmOn,
                         ::testing::Values(Recorded{"torresani/walking_rearranged.mat", Alignment::none, 0.1298, 1.0},
                                           Recorded{"torresani/face_rearranged.mat", Alignment::none, 0.0303, 1.0},
                                           Recorded{"torresani/jaws_rearranged.mat", Alignment::none, 0.2311, 1.1},
                                           Recorded{"pta_mocap/stretch.mat", Alignment::global_rotation, 0.1034, 1.2}),
                         [](const auto& test) { return std::to_string(test.index); });

TEST_P(SpfmOn, is_near_the_published_error) {
  GONIO_NEEDS_DATA("nrsfm");
  const Sequence s = read_sequence(tests::data("nrsfm") / GetParam().file);
  const Solution solution = answer("spfm", s);
  const double error = error_of(solution, s, GetParam().alignment);
  RecordProperty("e3d", std::to_string(error));
  EXPECT_LT(error, GetParam().share * GetParam().published);
}

}  // namespace
}  // namespace gonio::nrsfm::testing
