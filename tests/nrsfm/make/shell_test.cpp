// Elastic shells: forces are the energy's slopes, and sheets bend and stretch as plate theory says.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "nrsfm/make/animatronic_support.h"

namespace gonio::nrsfm {
namespace {

TEST(Shell, ForcesAreTheSlopesOfTheEnergy) {
  Sheet sheet = flat_sheet(0.1, 0.1, 3);
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

// Energy of small deflections z = r'Kr / 2 against D A / 2 ((tr K)^2 - 8/3 det K). Edges on the rim have no hinge, the
// triangles at the ends are halves: a strip along the rim, a row wide, may err by its whole energy.
TEST(Shell, HingesBendAsAnIsotropicPlate) {
  const Sheet sheet = flat_sheet(1, 1, 60);
  const Shell weightless(sheet.rest, sheet.triangles, {.young_pa = 1e-6, .density_kg_m3 = 0, .bending_n_m = 2.5});
  const double width = 2 * sheet.rest.row(1).maxCoeff(), strip = 2 * sheet.cell_m * (1 + 1 / width);
  const auto energy = [&](double xx, double yy, double xy) {
    Eigen::Matrix3Xd x = sheet.rest;
    x.row(2) = 1e-3 * (xx * x.row(0).array().square() / 2 + yy * x.row(1).array().square() / 2 +
                       xy * x.row(0).array() * x.row(1).array());
    return weightless.energy(x) / (1e-6 * 2.5 * width / 2);
  };
  const auto expect = [&](double is, double theory) { EXPECT_NEAR(is, theory, theory * strip); };
  expect(energy(1, 0, 0), 1);
  expect(energy(0, 1, 0), 1);
  expect(energy(0.5, 0.5, 0.5), 1);  // cylinders along and across the rows, and at 45 degrees
  expect(energy(1, 1, 0), 4 - 8.0 / 3);
  expect(energy(1, -1, 0), 8.0 / 3);
  expect(energy(0, 0, 1), 8.0 / 3);
}

// Deflection of the tip under its own weight: q L^4 / (8 B), small against L. The stiffness B lies between that of a
// strip whose edges are free to curl, D (1 - 1/9), and D; the clamp between the last vertices that are held and the
// first that are not.
TEST(Shell, CantileverSagsAsPlateTheorySays) {
  constexpr double length = 0.1, young = 1e8, thickness = 5e-4, gravity = 0.3;
  const Sheet sheet = flat_sheet(length, 0.017, 40);
  Shell shell(sheet.rest, sheet.triangles,
              {.young_pa = young, .poisson = 1.0 / 3, .thickness_m = thickness, .density_kg_m3 = 1000});
  shell.gravity_m_s2 = {0, 0, -gravity};
  for (Eigen::Index v = 0; v < sheet.rest.cols(); ++v)
    shell.fixed[static_cast<std::size_t>(v)] = sheet.rest(0, v) < -length / 2 + 1.01 * sheet.cell_m;
  Eigen::Matrix3Xd x = sheet.rest;
  ASSERT_TRUE(shell.settle(x, 1e-8).converged);
  const double d = young * std::pow(thickness, 3) / (12 * (1 - 1.0 / 9)), load = 1000 * thickness * gravity;
  const auto sag = [&](double cells_held, double stiffness) {
    return load * std::pow(length - cells_held * sheet.cell_m, 4) / (8 * stiffness);
  };
  const double tip = -x.row(2).minCoeff();
  EXPECT_LT(tip, 0.02 * length);
  EXPECT_GT(tip, sag(1.5, d));
  EXPECT_LT(tip, sag(0.5, d * (1 - 1.0 / 9)));
}

// Plane stress without force across: E_yy = -nu E_xx of Green's strain.
TEST(Shell, PulledSheetNarrowsByPoissonsRatio) {
  const Sheet sheet = flat_sheet(0.3, 0.05, 36);
  Shell shell(sheet.rest, sheet.triangles, {.young_pa = 1e6, .poisson = 0.4, .thickness_m = 1e-3});
  shell.gravity_m_s2.setZero();
  Eigen::Matrix3Xd x = sheet.rest;
  for (Eigen::Index v = 0; v < x.cols(); ++v)
    if (std::abs(x(0, v)) > 0.1499) shell.fixed[static_cast<std::size_t>(v)] = 1, x(0, v) *= 1.25;
  ASSERT_TRUE(shell.settle(x).converged);
  const auto strain = [&](double x_m, double y_m) {  // between the vertices next to (-x, -y) and (x, y)
    Eigen::Index a = 0, b = 0;
    (sheet.rest.colwise() + Eigen::Vector3d(x_m, y_m, 0)).colwise().norm().minCoeff(&a);
    (sheet.rest.colwise() - Eigen::Vector3d(x_m, y_m, 0)).colwise().norm().minCoeff(&b);
    return ((x.col(b) - x.col(a)).squaredNorm() / (sheet.rest.col(b) - sheet.rest.col(a)).squaredNorm() - 1) / 2;
  };
  EXPECT_GT(strain(0.02, 0), 0.2);
  EXPECT_NEAR(strain(0, 0.025), -0.4 * strain(0.02, 0), 0.01 * strain(0.02, 0));
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
