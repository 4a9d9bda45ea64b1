#include "optim/bfgs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"

namespace gonio::optim {
namespace {

using Eigen::VectorXd;

// Rosenbrock's valley, minimum 0 at (1, 1).
double valley(const VectorXd& x, VectorXd* slopes) {
  const double a = 1 - x[0], b = x[1] - x[0] * x[0];
  if (slopes != nullptr) *slopes << -2 * a - 400 * x[0] * b, 200 * b;
  return a * a + 100 * b * b;
}

TEST(Bfgs, WalksAlongAValley) {
  const Minimum found = minimise_by_bfgs(valley, VectorXd{{-1.2, 1}});
  EXPECT_NEAR(found.x[0], 1, 1e-5);
  EXPECT_NEAR(found.x[1], 1, 1e-5);
  EXPECT_LT(found.descended.cost, 1e-10);
  EXPECT_GT(found.descended.steps, 5);
  EXPECT_TRUE(found.descended.settled());
}

// The point whose summed distance from five others is least, one of which is far off: no squares, and an answer that
// squares would not give.
TEST(Bfgs, FindsWhatSquaresDoNot) {
  Eigen::Matrix<double, 2, 5> points;
  points << 0, 2, 0, 2, 100, 0, 0, 2, 2, 100;
  const auto distance = [&](const VectorXd& x, VectorXd* slopes) {
    double sum = 0;
    if (slopes != nullptr) slopes->setZero();
    for (int k = 0; k < 5; ++k) {
      const Eigen::Vector2d d = x - points.col(k);
      const double r = std::hypot(d.norm(), 1e-3);
      sum += r;
      if (slopes != nullptr) *slopes += d / r;
    }
    return sum;
  };
  const Minimum found = minimise_by_bfgs(distance, VectorXd{{20, 30}});
  VectorXd slopes(2);
  distance(found.x, &slopes);
  EXPECT_LT(slopes.norm(), 1e-4);
  EXPECT_LT(found.x.norm(), 3);
}

TEST(Bfgs, StopsWhereItIsToldAndIsNeverWorseThanTheStart) {
  Limits limits;
  limits.most_steps = 3;
  const VectorXd start{{-1.2, 1}};
  const Minimum found = minimise_by_bfgs(valley, start, limits);
  EXPECT_LE(found.descended.cost, valley(start, nullptr));
  EXPECT_EQ(found.descended.stop, Stop::steps);
  // Slopes that lie: nothing lower is found, and the start comes back.
  const auto lying = [](const VectorXd& x, VectorXd* slopes) {
    if (slopes != nullptr) *slopes = -2 * x;
    return x.squaredNorm();
  };
  EXPECT_LE(minimise_by_bfgs(lying, VectorXd{{1, 1}}).descended.cost, 2);
  const auto nowhere = [](const VectorXd&, VectorXd*) { return std::numeric_limits<double>::quiet_NaN(); };
  EXPECT_THROW(minimise_by_bfgs(nowhere, start), Error);
}

}  // namespace
}  // namespace gonio::optim
