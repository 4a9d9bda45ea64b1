// Projection onto the motion manifold, and the solver that alternates by it: exact recovery with and without missing
// tracks, invariances, recorded sequences.
#include <gtest/gtest.h>

#include "data.h"
#include "made.h"
#include "nrsfm/files.h"
#include "nrsfm/solve/motion_manifold.h"

namespace gonio::nrsfm::testing {
namespace {

CameraRows random_rows(Random& random) {
  return nearest_rows(normals(2, 3, random));
}

Eigen::MatrixXd on_manifold(const CameraRows& rows, const Eigen::VectorXd& weights) {
  Eigen::MatrixXd motion(2, 3 * weights.size());
  for (Eigen::Index k = 0; k < weights.size(); ++k) motion.middleCols<3>(3 * k) = weights(k) * rows;
  return motion;
}

TEST(NearestMotion, leaves_what_lies_on_the_manifold) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const CameraRows rows = random_rows(random);
    const Eigen::MatrixXd motion = on_manifold(rows, normals(3, 1, random));
    const OnManifold found = nearest_motion(motion, random_rows(random));
    EXPECT_TRUE(found.certified);
    EXPECT_LT((on_manifold(found.rotation, found.weights) - motion).norm(), 1e-6 * motion.norm());
    EXPECT_LT((found.rotation * found.rotation.transpose() - Eigen::Matrix2d::Identity()).norm(), 1e-9);
  }
}

// Where the certificate holds no search may find anything nearer: 60 climbs from random rotations.
TEST(NearestMotion, is_the_nearest_of_all_where_it_says_so) {
  Random random(2);
  int certified = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Eigen::MatrixXd motion = normals(2, 9, random);
    const OnManifold found = nearest_motion(motion, random_rows(random));
    const double distance = (on_manifold(found.rotation, found.weights) - motion).norm();
    certified += found.certified ? 1 : 0;
    for (int search = 0; search < 60 && found.certified; ++search) {
      CameraRows rows = random_rows(random);
      Eigen::VectorXd weights(3);
      for (int step = 0; step < 60; ++step) {
        CameraRows sum = CameraRows::Zero();
        for (Eigen::Index k = 0; k < 3; ++k) {
          weights(k) = motion.middleCols<3>(3 * k).cwiseProduct(rows).sum() / 2;
          sum += weights(k) * motion.middleCols<3>(3 * k);
        }
        rows = nearest_rows(sum);
      }
      EXPECT_GE((on_manifold(rows, weights) - motion).norm(), distance * (1 - 1e-5));
    }
  }
  EXPECT_GE(certified, 30);  // the relaxation is tight for most matrices of pure noise, and for all near the manifold
}

TEST(NearestMotion, keeps_to_the_side_of_its_start) {
  Random random(3);
  const CameraRows rows = random_rows(random);
  const Eigen::MatrixXd motion = on_manifold(rows, normals(2, 1, random));
  EXPECT_GT(nearest_motion(motion, rows).rotation.cwiseProduct(rows).sum(), 0);
  EXPECT_LT(nearest_motion(motion, -rows).rotation.cwiseProduct(rows).sum(), 0);
}

const SolverValues kThree{{"rank", 3}, {"camera_rank", 3}};

TEST(MetricProjection, gives_back_shapes_of_its_rank_with_and_without_missing_tracks) {
  Sequence s = low_rank_sequence(40, 30, 3, 0);
  EXPECT_LT(error_of(answer("metric_projection", s, kThree), s, Alignment::global_similarity), 1e-4);
  Random random(5);
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (random.uniform() < 0.3) hide(s, f, p);
  EXPECT_LT(error_of(answer("metric_projection", s, kThree), s, Alignment::global_similarity), 1e-3);
}

TEST(MetricProjection, errors_stay_in_proportion_to_noise) {
  for (const bool missing : {false, true}) {
    for (const double noise : {0.005, 0.02}) {
      Sequence s = low_rank_sequence(40, 30, 3, noise);
      if (missing) hide_in_runs(s, 12);
      const Solution solution = answer("metric_projection", s, kThree);
      EXPECT_LT(error_of(solution, s, Alignment::frame_rotation), 4 * noise) << noise << missing;
      EXPECT_LT(solution.reprojection_rms, 1.5 * noise);
    }
  }
}

TEST(MetricProjection, does_not_depend_on_the_order_of_points_nor_on_the_images_frame) {
  const SolverValues two{{"rank", 2}, {"camera_rank", 2}};
  EXPECT_LT(change_when_reordered("metric_projection", low_rank_sequence(30, 24, 2, 0.01), two, false), 0.05);
}

// Published: 0.5607 (walking) and 0.1571 (shark), table 1 of Gotardo & Martinez (CVPR 2011), quoted from memory. A
// model of three shapes contains the shark.
TEST(MetricProjection, on_recorded_sequences_is_better_than_published) {
  GONIO_NEEDS_DATA("nrsfm/torresani");
  const auto folder = tests::data("nrsfm/torresani");
  for (const auto& [file, most] : {std::pair{"walking_rearranged.mat", 0.2}, {"jaws_rearranged.mat", 0.02}}) {
    const Sequence s = read_sequence(folder / file);
    SolverOptions options;
    options.most_iterations = 15;
    const Solution solution = solve(*find_solver("metric_projection"), s, options);
    const double error = error_of(solution, s, Alignment::none);
    RecordProperty(file, std::to_string(error));
    EXPECT_LT(error, most) << file;
  }
}

}  // namespace
}  // namespace gonio::nrsfm::testing
