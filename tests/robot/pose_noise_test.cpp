// The one estimate of a robot's noise: the most likely by a likelihood written out in full matrices; a component that
// wants to be negative takes nothing from the others; directions that nothing tells stay at rest.
#include "robot/handeye/pose_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/random.h"

namespace gonio::robot::handeye {
namespace {

constexpr Eigen::Index unknowns = 5;

// Poses with levers of half a metre: a turn of the tool and one of the board both turn the board, and differ in what
// they shift. `truth` scatters them; five unknowns move them.
std::vector<NoisyPose> poses(const Noise& truth, int count, std::uint64_t seed) {
  Random random(seed, 3);
  std::vector<NoisyPose> list;
  for (int i = 0; i < count; ++i) {
    NoisyPose pose{{}, std::vector<double>(6 * unknowns), {}};
    for (std::size_t k = 0; k < 3; ++k) {
      pose.scatter.by_turn[7 * k] = pose.scatter.by_shift[7 * k + 3] = pose.scatter.by_board[7 * k] = 1;
      for (std::size_t r = 3; r < 6; ++r) pose.scatter.by_turn[6 * k + r] = random.uniform(-0.5, 0.5);
      pose.scatter.measured[7 * k] = 1e-4 * 1e-4;
      pose.scatter.measured[7 * (k + 3)] = 1e-4 * 1e-4;
    }
    for (double& slope : pose.jacobian) slope = random.normal();
    for (std::size_t r = 0; r < 6; ++r) pose.residual[r] = 1e-4 * random.normal();
    const auto shake = [&](const PoseScatter::Effect& effect, double size) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double by = size * random.normal();
        for (std::size_t r = 0; r < 6; ++r) pose.residual[r] += effect[6 * k + r] * by;
      }
    };
    shake(pose.scatter.by_turn, truth.robot_rad);
    shake(pose.scatter.by_shift, truth.robot_m);
    shake(pose.scatter.by_board, truth.board_rad);
    list.push_back(pose);
  }
  return list;
}

// Logarithm of the restricted likelihood (Harville 1974), from matrices over all poses.
double likelihood(const std::vector<NoisyPose>& list, const Noise& noise) {
  const auto rows = static_cast<Eigen::Index>(6 * list.size());
  Eigen::MatrixXd v = Eigen::MatrixXd::Zero(rows, rows), j(rows, unknowns);
  Eigen::VectorXd r(rows);
  for (Eigen::Index i = 0; i < rows / 6; ++i) {
    const NoisyPose& pose = list[static_cast<std::size_t>(i)];
    const PoseScatter& s = pose.scatter;
    Eigen::Matrix<double, 6, 6> block = Eigen::Map<const Eigen::Matrix<double, 6, 6>>(s.measured.data());
    for (const auto& [effect, size] : {std::pair{s.by_turn, noise.robot_rad}, std::pair{s.by_shift, noise.robot_m},
                                       std::pair{s.by_board, noise.board_rad}}) {
      const Eigen::Map<const Eigen::Matrix<double, 6, 3>> g(effect.data());
      block += size * size * g * g.transpose();
    }
    v.block<6, 6>(6 * i, 6 * i) = block;
    j.middleRows<6>(6 * i) = Eigen::Map<const Eigen::Matrix<double, 6, unknowns>>(pose.jacobian.data());
    r.segment<6>(6 * i) = Eigen::Map<const Eigen::Matrix<double, 6, 1>>(pose.residual.data());
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(v);
  const Eigen::MatrixXd weighted = factor.solve(j), h = j.transpose() * weighted;
  const Eigen::VectorXd left = r - j * h.llt().solve(weighted.transpose() * r);
  const auto half_log = [](const Eigen::MatrixXd& lower) { return lower.diagonal().array().log().sum(); };
  return -half_log(factor.matrixL()) - half_log(h.llt().matrixL()) - 0.5 * left.dot(factor.solve(left));
}

TEST(PoseNoise, IsTheMostLikely) {
  const Noise truth{1, 3e-4, 5e-4, 4e-4};
  const auto list = poses(truth, 40, 1);
  const Noise found = estimate_noise(list);
  const double best = likelihood(list, found);
  for (double Noise::*component : {&Noise::robot_m, &Noise::robot_rad, &Noise::board_rad}) {
    EXPECT_NEAR(found.*component / truth.*component, 1, 0.35);
    for (const double factor : {0.98, 1.02}) {
      Noise other = found;
      other.*component *= factor;
      EXPECT_LT(likelihood(list, other), best);
      other.*component = found.*component * (1 + 0.01 * (factor - 1));
      EXPECT_NEAR(likelihood(list, other), best, 1e-4);  // a flat top
    }
  }
}

TEST(PoseNoise, IsRightOnAverage) {
  const Noise truth{1, 3e-4, 5e-4, 4e-4};
  constexpr int sets = 60;
  Noise mean2{0, 0, 0, 0};
  for (std::uint64_t seed = 0; seed < sets; ++seed) {
    const Noise found = estimate_noise(poses(truth, 20, 100 + seed));
    for (double Noise::*component : {&Noise::robot_m, &Noise::robot_rad, &Noise::board_rad})
      mean2.*component += found.*component * found.*component / sets;
  }
  for (double Noise::*component : {&Noise::robot_m, &Noise::robot_rad, &Noise::board_rad})
    EXPECT_NEAR(std::sqrt(mean2.*component) / truth.*component, 1, 0.05);
}

// A board that does not turn: whether that is asked or known, robot and camera scatter alike.
TEST(PoseNoise, AComponentThatWouldBeNegativeTakesNothingFromTheOthers) {
  int at_zero = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    auto list = poses({1, 3e-4, 5e-4, 0}, 20, seed);
    const Noise asked = estimate_noise(list);
    for (NoisyPose& pose : list) pose.scatter.by_board = {};
    const Noise known = estimate_noise(list);
    EXPECT_EQ(known.board_rad, 0);
    if (asked.board_rad > 1e-6) continue;
    ++at_zero;
    EXPECT_NEAR(asked.robot_rad / known.robot_rad, 1, 1e-4) << seed;
    EXPECT_NEAR(asked.robot_m / known.robot_m, 1, 1e-4) << seed;
  }
  EXPECT_GE(at_zero, 3);
}

// Two unknowns that do the same: each takes a half, whatever prior and noise.
TEST(PoseNoise, WhatNothingTellsApartStaysAtRest) {
  auto list = poses({1, 0, 0, 0}, 10, 5);
  for (NoisyPose& pose : list) {
    std::copy_n(pose.jacobian.begin(), 6, pose.jacobian.begin() + 6);
    for (std::size_t r = 0; r < 6; ++r) pose.residual[r] = -1e-3 * pose.jacobian[r];
    pose.scatter.measured = {};
  }
  const std::vector<double> prior = {1e8, 1e2, 0, 0, 0};
  for (const double size : {1e-7, 1e-5, 1e-3}) {
    const PoseFit fit = fit_poses(list, {1, size, size, 0}, prior);
    if (size < 1e-4) {
      EXPECT_NEAR(fit.change[0] + fit.change[1], 1e-3, 1e-5);
    }
    EXPECT_NEAR(fit.change[0] / (fit.change[0] + fit.change[1]), 0.5, 0.01) << size;
  }
}

}  // namespace
}  // namespace gonio::robot::handeye
