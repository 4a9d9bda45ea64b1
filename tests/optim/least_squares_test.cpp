#include "optim/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <random>

#include "optim/ceres_fit.h"

namespace gonio::optim {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

struct Written final : Model {
  using Function = std::function<VectorXd(const VectorXd&)>;
  explicit Written(Function f) : of(std::move(f)) {}
  bool residuals(const VectorXd& x, VectorXd& r) const override {
    r = of(x);
    return r.allFinite();
  }
  Function of;
};

Limits fine() {
  Limits limits;
  limits.most_steps = 500;
  limits.small_fall = {1e-14, 1e-30};
  return limits;
}

VectorXd rosenbrock(const VectorXd& x) {
  return Vector2d(10 * (x[1] - x[0] * x[0]), 1 - x[0]);
}

TEST(LeastSquares, FindsRosenbrocksValley) {
  const Fit found = fit(Written(rosenbrock), Vector2d(-1.2, 1), {}, fine());
  EXPECT_NEAR(found.x[0], 1, 1e-8);
  EXPECT_NEAR(found.x[1], 1, 1e-8);
  EXPECT_LT(found.descended.steps, 40);
  EXPECT_TRUE(found.descended.settled()) << sentence(found.descended);
}

// Powell's singular function: the slopes lose rank at the minimum, where convergence is but linear.
TEST(LeastSquares, ReachesPowellsSingularMinimumAndSaysThatItIsNotDetermined) {
  const Written model([](const VectorXd& x) {
    return Eigen::Vector4d(x[0] + 10 * x[1], std::sqrt(5) * (x[2] - x[3]), std::pow(x[1] - 2 * x[2], 2),
                           std::sqrt(10) * std::pow(x[0] - x[3], 2));
  });
  Limits limits = fine();
  limits.floor = 1e-28;
  const Fit found = fit(model, Eigen::Vector4d(3, -1, 0, 1), {}, limits);
  EXPECT_LT(found.cost, 1e-25);
  EXPECT_LT(found.x.norm(), 1e-5);
  EXPECT_FALSE(found.determined);
  EXPECT_TRUE(std::isinf(found.covariance(0, 0)));
}

// Betts' and Hock-Schittkowski's problem 2: Rosenbrock with x2 >= 1.5 has its minimum at the bound.
TEST(LeastSquares, HoldsWhatPressesAgainstABound) {
  Terms terms;
  terms.lower = Vector2d(-10, 1.5);
  terms.upper = Vector2d(10, 10);
  const Fit found = fit(Written(rosenbrock), Vector2d(2, 2), terms, fine());
  const double a = std::sqrt(598.0 / 1200), x1 = 2 * a * std::cos(std::acos(1 / (400 * a * a * a)) / 3);
  EXPECT_NEAR(found.x[0], x1, 1e-8);
  EXPECT_EQ(found.x[1], 1.5);
  EXPECT_NEAR(found.cost, 0.0504261879, 1e-9);
  EXPECT_EQ(found.held, std::vector<Eigen::Index>{1});
  EXPECT_EQ(found.covariance(1, 1), 0);
  EXPECT_GT(found.covariance(0, 0), 0);
}

TEST(LeastSquares, ABoundThatDoesNotPressChangesNothing) {
  Terms terms;
  terms.lower = Vector2d(-2, -2);
  terms.upper = Vector2d(2, 2);
  const Fit found = fit(Written(rosenbrock), Vector2d(-1.2, 1), terms, fine());
  EXPECT_NEAR(found.x[0], 1, 1e-8);
  EXPECT_TRUE(found.held.empty());
}

struct Straight {
  MatrixXd a;
  VectorXd y;
  Straight(int rows, int columns, std::mt19937& random, const VectorXd& truth) : a(rows, columns), y(rows) {
    std::normal_distribution<double> normal;
    for (double& v : a.reshaped()) v = normal(random);
    a.col(0) *= 1e4;  // units must not matter
    y = a * truth;
    for (double& v : y) v += normal(random);
  }
};

TEST(LeastSquares, PriorsAndCovarianceOfALinearModelAreTheClosedForm) {
  std::mt19937 random(7);
  const Straight line(12, 3, random, Eigen::Vector3d(1e-4, 2, -1));
  Terms terms;
  terms.priors = {{0, 3e-4, 2e-5}, {2, -0.5, 0.2}};
  const Fit found =
      fit(Written([&](const VectorXd& x) { return VectorXd(line.a * x - line.y); }), VectorXd::Zero(3), terms, fine());
  MatrixXd h = line.a.transpose() * line.a;
  VectorXd g = line.a.transpose() * line.y;
  for (const Prior& p : terms.priors) {
    h(p.parameter, p.parameter) += 1 / (p.sigma * p.sigma);
    g[p.parameter] += p.mean / (p.sigma * p.sigma);
  }
  const MatrixXd covariance = h.inverse();
  const VectorXd x = covariance * g;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.x[i] / x[i], 1, 1e-7) << i;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(found.covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k)),
                  covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k)), 1e-6);
  }
}

TEST(LeastSquares, IntervalsCover) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  constexpr int trials = 400;
  int covered = 0;
  for (int t = 0; t < trials; ++t) {
    VectorXd y(20);
    for (int i = 0; i < 20; ++i) y[i] = 5 * std::exp(-0.15 * i) + 0.1 * normal(random);
    const Written model([&](const VectorXd& x) {
      VectorXd r(20);
      for (int i = 0; i < 20; ++i) r[i] = (x[0] * std::exp(-x[1] * i) - y[i]) / 0.1;
      return r;
    });
    const Fit found = fit(model, Vector2d(3, 0.3), {}, fine());
    covered += std::abs(found.x[1] - 0.15) < 1.96 * std::sqrt(found.covariance(1, 1));
  }
  EXPECT_NEAR(covered / double(trials), 0.95, 3 * std::sqrt(0.95 * 0.05 / trials));
}

TEST(LeastSquares, RobustLossesFindTheirOwnMinimum) {
  // One number and one outlier: Huber's minimum of {0, 0, 0, 10} with w = 1 balances 3 x = 1.
  const Written model([](const VectorXd& x) { return VectorXd(Eigen::Vector4d(0, 0, 0, 10).array() - x[0]); });
  Terms terms;
  terms.loss = Loss::huber;
  terms.width = 1;
  Limits limits = fine();
  EXPECT_NEAR(fit(model, VectorXd::Constant(1, 5), terms, limits).x[0], 1.0 / 3, 1e-6);
  terms.loss = Loss::cauchy;
  const double at = fit(model, VectorXd::Constant(1, 1), terms, limits).x[0];
  EXPECT_NEAR(3 * at / (1 + at * at), (10 - at) / (1 + (10 - at) * (10 - at)), 1e-6);
  // Two coordinates as one: a pair at distance 5 counts as one outlier.
  const Written pairs([](const VectorXd& x) {
    VectorXd r(6);
    r << x[0], x[1], x[0], x[1], x[0] - 3, x[1] - 4;
    return r;
  });
  terms.loss = Loss::huber;
  terms.group = 2;
  const Fit pair = fit(pairs, Vector2d(1, 1), terms, limits);
  EXPECT_NEAR(pair.x[0], 0.3, 1e-6);  // 2 |x| = 1, towards the outlier
  EXPECT_NEAR(pair.x[1], 0.4, 1e-6);
}

// A direction on a circle, held as cosine and sine: changes compose, and the covariance is of the angle.
TEST(LeastSquares, ParametersMayBeATurn) {
  struct Circle final : Model {
    bool residuals(const VectorXd& x, VectorXd& r) const override {
      r = (x - Vector2d(-0.6, 0.8)) / 0.01;
      return true;
    }
    Eigen::Index freedoms(const VectorXd&) const override { return 1; }
    VectorXd moved(const VectorXd& x, const VectorXd& d) const override {
      const double c = std::cos(d[0]), s = std::sin(d[0]);
      return Vector2d(c * x[0] - s * x[1], s * x[0] + c * x[1]);
    }
  };
  const Fit found = fit(Circle{}, Vector2d(1, 0), {}, fine());
  EXPECT_NEAR(found.x[0], -0.6, 1e-9);
  EXPECT_NEAR(found.x.norm(), 1, 1e-12);
  ASSERT_EQ(found.covariance.rows(), 1);
  EXPECT_NEAR(found.covariance(0, 0), 1e-4, 1e-10);
  const Fit peer = fit_by_ceres(Circle{}, Vector2d(1, 0), fine());
  EXPECT_NEAR(peer.x[0], -0.6, 1e-9);
  EXPECT_NEAR(peer.covariance(0, 0), 1e-4, 1e-10);
}

}  // namespace
}  // namespace gonio::optim
