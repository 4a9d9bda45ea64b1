// Perspective on top of shapes that are too few: found where it is, with an interval that holds, and not found where
// only shapes are lacking. The fits beneath it.
#include "nrsfm/solve/near_camera.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "linear/svd.h"
#include "nrsfm/solve/deforming_fit.h"
#include "tracks_world.h"

namespace gonio::nrsfm {
namespace {

using gonio::explain::testing::film;
using gonio::explain::testing::Film;
using gonio::explain::testing::solved;

UsedTracks all_of(const Sequence& s) {
  return {s.tracks, Eigen::ArrayXXd::Ones(s.frames(), s.points())};
}

// The film's own shapes, weights and cameras.
DeformingShape truth_of(const Film& f, const Sequence& s) {
  DeformingShape t;
  Eigen::MatrixXd rows(s.frames(), 3 * s.points());
  for (Eigen::Index k = 0; k < s.frames(); ++k) {
    t.rotation.push_back(s.cameras[static_cast<std::size_t>(k)].rotation);
    rows.row(k) = shape_of(*s.truth, k).reshaped().transpose();
  }
  const linear::DividedSvd svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  t.weights = svd.matrixU().leftCols(f.shapes);
  t.basis.resize(3 * f.shapes, s.points());
  for (Eigen::Index p = 0; p < s.points(); ++p)
    for (Eigen::Index k = 0; k < f.shapes; ++k)
      t.basis.block<3, 1>(3 * k, p) = svd.singularValues()(k) * svd.matrixV().block<3, 1>(3 * p, k);
  t.shift.resize(2, s.frames());
  for (Eigen::Index k = 0; k < s.frames(); ++k)
    t.shift.col(k) = s.cameras[static_cast<std::size_t>(k)].translation.head<2>();
  t.kappa = f.inverse_focal;
  return t;
}

TEST(DeformingFit, ComesBackToExactTracks) {
  Film f;
  f.noise_px = 0, f.inverse_focal = 5e-4;
  const Sequence s = film(f);
  DeformingShape start = truth_of(f, s);
  EXPECT_LT(residuals(all_of(s), start).norm(), 1e-9);
  Random random(4);
  for (Eigen::Index i = 0; i < start.weights.size(); ++i) start.weights.data()[i] += 0.02 * random.normal();
  for (Eigen::Matrix3d& r : start.rotation)
    r = gonio::explain::testing::turned(0.1 * random.normal(), 0.1 * random.normal(), 0.1 * random.normal()) * r;
  start.kappa = 0;
  const DeformingFit fit = fit_deforming(all_of(s), start, {.perspective = true, .most_steps = 60, .tolerance = 1e-8});
  EXPECT_LT(std::sqrt(fit.squares / static_cast<double>(s.tracks.size())), 1e-4);
  EXPECT_NEAR(fit.shape.kappa, f.inverse_focal, 1e-3 * f.inverse_focal);
}

// What survives is at right angles to what every other number can do, and its whole is the derivative.
TEST(DeformingFit, SignatureOfPerspective) {
  Film f;
  f.inverse_focal = 2e-4;
  const Sequence s = film(f);
  const UsedTracks tracks = all_of(s);
  const DeformingShape fit = fit_deforming(tracks, truth_of(f, s), {}).shape;
  const PerspectiveColumn column = perspective_column(tracks, fit);
  DeformingShape up = fit, down = fit, moved = fit;
  up.kappa += 1e-7, down.kappa -= 1e-7;
  const Eigen::MatrixXd differences = (residuals(tracks, down) - residuals(tracks, up)) / 2e-7;
  EXPECT_LT((column.whole - differences).norm(), 1e-5 * differences.norm());
  moved.weights(3, 1) += 1e-3, moved.basis(2, 5) += 0.1, moved.shift(1, 7) += 0.1;
  const Eigen::MatrixXd change = residuals(tracks, fit) - residuals(tracks, moved);
  EXPECT_LT(std::abs(change.cwiseProduct(column.surviving).sum()), 1e-3 * change.norm() * column.surviving.norm());
  EXPECT_LT(column.surviving.norm(), column.whole.norm());
}

Film lacking(double inverse_focal, std::uint64_t seed) {
  Film f;
  f.frames = 24, f.points = 24, f.shapes = 4, f.deformation = 0.05, f.noise_px = 0.05;
  f.inverse_focal = inverse_focal, f.seed = seed;
  return f;
}

NearCamera asked(const Film& f) {
  const Solved s = solved(film(f), "pta", {{"terms", 2}});
  return find_near_camera(s.sequence, solved_model(s));
}

TEST(NearCamera, PerspectiveIsFoundBeneathShapesThatAreLacking) {
  int found = 0, holds = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const NearCamera n = asked(lacking(8e-4, 100 + seed));  // depths of 250 px: a fifth of the distance
    ASSERT_EQ(n.steps.size(), 2u);
    EXPECT_EQ(n.steps[1].shapes, n.steps[0].shapes + 1);
    found += n.stands;
    for (const NearCamera::Step& step : n.steps)
      std::printf("%zu shapes: gain %.2f, t %.1f and %.1f, kappa %.3g +- %.2g; a shape %.2f\n", step.shapes,
                  step.log_gain, step.t_of_points, step.t_of_stretches, step.kappa, step.sigma, n.of_a_shape);
    const double sign = n.steps[1].kappa < 0 ? -1 : 1;
    holds += std::min(sign * n.lower, sign * n.upper) <= 8e-4 && 8e-4 <= std::max(sign * n.lower, sign * n.upper);
  }
  EXPECT_GE(found, 2);
  EXPECT_GE(holds, 2);
}

// 2 % of 6: more than one has a chance of 0.6 %.
TEST(NearCamera, ShapesThatAreLackingAreNotTakenForPerspective) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) found += asked(lacking(0, 200 + seed)).stands;
  EXPECT_LE(found, 1);
}

TEST(NearCamera, NothingIsAskedWhereNoShapeIsLacking) {
  Film f;
  const Solved s = solved(film(f), "pta", {{"terms", 2}});
  const NearCamera n = find_near_camera(s.sequence, solved_model(s), 1.5 * std::sqrt(2.0) * f.noise_px);
  EXPECT_FALSE(n.lacking);
  EXPECT_FALSE(n.stands);
  EXPECT_TRUE(n.steps.empty());
}

}  // namespace
}  // namespace gonio::nrsfm
