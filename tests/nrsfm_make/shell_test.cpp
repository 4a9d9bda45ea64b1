// Elastic shells: forces are the energy's slopes, and sheets bend and stretch as plate theory says.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "nrsfm/animatronic_support.h"

namespace gonio::nrsfm {
namespace {

TEST(Shell, ForcesAreTheSlopesOfTheEnergy) {
  Sheet sheet = flat_sheet(0.1, 0.1, 3, 3);
  for (auto& t : sheet.triangles) std::swap(t[1], t[2]);
  Random random(5);
  Eigen::Matrix3Xd rest = sheet.rest;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) rest(2, i) = 0.1 + 0.01 * random.uniform();
  Shell shell(rest, sheet.triangles,
              {.young_pa = 1e5, .poisson = 0.3, .thickness_m = 2e-3, .density_kg_m3 = 1000, .bending_n_m = 1e-3},
              {{0, 15, 3.0}});
  shell.outside_pa = 100;
  Eigen::Matrix3Xd x = rest;
  for (double& c : x.reshaped()) c += 0.004 * random.uniform(-1, 1);
  if (shell.volume(x) < 0) x.row(2) *= -1;
  shell.gas_nm = 130 * shell.volume(x);
  const Eigen::Matrix3Xd g = shell.gradient(x);
  for (int trial = 0; trial < 30; ++trial) {
    const auto i = static_cast<Eigen::Index>(random.below(16));
    const auto axis = static_cast<Eigen::Index>(random.below(3));
    constexpr double h = 1e-6;
    Eigen::Matrix3Xd up = x, down = x;
    up(axis, i) += h, down(axis, i) -= h;
    const double slope = (shell.energy(up) - shell.energy(down)) / (2 * h);
    EXPECT_NEAR(g(axis, i), slope, 1e-5 * g.cwiseAbs().maxCoeff());
  }
}

// Plane stress without force across: E_yy = -nu E_xx of Green's strain.
TEST(Shell, PulledSheetNarrowsByPoissonsRatio) {
  const Sheet sheet = flat_sheet(0.3, 0.05, 36, 6);
  Shell shell(sheet.rest, sheet.triangles, {.young_pa = 1e6, .poisson = 0.4, .thickness_m = 1e-3});
  shell.gravity_m_s2.setZero();
  Eigen::Matrix3Xd x = sheet.rest;
  for (const int i : {0, 36})
    for (int j = 0; j <= 6; ++j) shell.fixed[sheet.at(i, j)] = 1, x(0, sheet.at(i, j)) *= 1.25;
  ASSERT_TRUE(shell.settle(x).converged);
  const auto green = [](double now, double rest) { return (now * now / (rest * rest) - 1) / 2; };
  const double along = green((x.col(sheet.at(20, 3)) - x.col(sheet.at(16, 3))).norm(), 4 * 0.3 / 36);
  const double across = green((x.col(sheet.at(18, 6)) - x.col(sheet.at(18, 0))).norm(), 0.05);
  EXPECT_GT(along, 0.2);
  EXPECT_NEAR(across, -0.4 * along, 0.01 * along);
}

TEST(Shell, HingesTurnAsTheirEdgesFold) {
  for (const double fold : {-2.5, -0.3, 0.0, 0.7, 3.0}) {
    const std::array<Eigen::Vector3d, 4> x{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(1, 1, 0),
                                           Eigen::Vector3d(0.5, -std::cos(fold), -std::sin(fold))};
    EXPECT_NEAR(hinge_angle(x), fold, 1e-12);
  }
}

}  // namespace
}  // namespace gonio::nrsfm
