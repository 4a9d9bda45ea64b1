// Views whose poses and points err by what is known: figures, motions and their intervals, and what overlaps leave
// open. One process: Registration.*
#include "mesh/register.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "base/parallel.h"
#include "linear/solve.h"
#include "mesh/register/register_world.h"
#include "stats/distributions.h"

namespace gonio::mesh {
namespace {

using gonio::tests::flat;
using gonio::tests::free_form;
using gonio::tests::misplace;
using gonio::tests::round_about_y;
using gonio::tests::seen;
using gonio::tests::SeenViews;
using testing::ElementsAre;
using testing::StartsWith;

const io::TriangleMesh& bumps() {
  static const io::TriangleMesh once = free_form();
  return once;
}
const SeenViews coarse{.side = 40, .f_px = 120};

ViewMotion motion(Vec3 turn_rad, Vec3 shift_m) {
  return {quaternion_of_rotation_vector(turn_rad), shift_m};
}
ViewMotion random_motion(Random& random) {
  const auto three = [&](double s) { return Vec3{s * random.normal(), s * random.normal(), s * random.normal()}; };
  const Vec3 turn = three(1e-3);
  return motion(turn, three(3e-4));
}

// Of the refined view against the truth: turn and shift of its centre, over their covariance.
struct Missed {
  Eigen::Matrix<double, 6, 1> by;
  Eigen::Matrix<double, 6, 6> covariance;
  double chi_square() const { return by.dot(linear::inverse(covariance) * by); }
  int inside() const {
    int count = 0;
    for (int k = 0; k < 6; ++k) count += std::abs(by[k]) < 1.959964 * std::sqrt(covariance(k, k));
    return count;
  }
};
Missed missed(const ViewShift& view, const ViewMotion& error) {
  const ViewMotion left = view.motion * error;
  const Vec3 turn = rotation_vector_of(left.rotation), shift = left * view.centre_m - view.centre_m;
  Missed m;
  m.by << turn.x, turn.y, turn.z, shift.x, shift.y, shift.z;
  m.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6>>(view.covariance.data());
  return m;
}

TEST(Registration, OfTrueStatementsTheFigureIsOne) {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Registration found = register_views(seen(bumps(), coarse, seed), {}, {});
    ASSERT_EQ(found.pairs.size(), 1U);
    EXPECT_NEAR(found.before.value, 1, 4 * found.before.sigma);
    EXPECT_GT(found.before.rigid_p, 1e-3);
    EXPECT_LT(found.before.sigma, 0.04);
    EXPECT_TRUE(found.views.empty());
    EXPECT_NEAR(found.before.value * found.before.value,
                found.before.rigid * found.before.rigid + found.before.rest * found.before.rest, 1e-9);
    sum += found.before.value / 8;
  }
  EXPECT_NEAR(sum, 1, 0.02);
}

TEST(Registration, PointsThatErrTwiceAsMuchAreSaidToDoSo) {
  MeasuredPoints points = seen(bumps(), coarse, 3);
  for (auto& covariance : points.covariance_m2)
    for (double& v : covariance) v /= 4;
  const Registration found = register_views(points, {}, {});
  EXPECT_NEAR(found.before.value, 2, 0.1);
  EXPECT_NEAR(found.before.rest, 2, 0.1);
  EXPECT_NEAR(found.before.typical, 2, 0.1);
  EXPECT_GT(found.before.rigid_p, 1e-3);
}

TEST(Registration, AMisplacedViewIsTheFaultOfItsPose) {
  MeasuredPoints points = seen(bumps(), coarse, 3);
  misplace(points, 1, motion({}, {0, 0, 4e-4}));
  const Registration found = register_views(points, {}, {});
  EXPECT_GT(found.before.value, 2);
  EXPECT_NEAR(found.before.rest, 1, 0.05);
  EXPECT_LT(found.before.rigid_p, 1e-9);
  EXPECT_NEAR(found.pairs[0].shift_m, 4e-4, 4e-5);
  EXPECT_GT(found.before.sigma, 5 * found.before.rest_sigma);  // another pose would err by something else
}

// Intervals of 95 % hold the truth, of two views beside the fixed one, whatever the poses' errors are.
TEST(Registration, IntervalsOfMotionsHoldTheTruth) {
  SeenViews three = coarse;
  three.cameras.push_back({0, 0.12, 0.38});
  int inside = 0, all = 0;
  double chi_square = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    MeasuredPoints points = seen(bumps(), three, seed);
    Random random(11, seed);
    std::array<ViewMotion, 3> errors;
    for (std::uint32_t v = 1; v < 3; ++v) errors[v] = random_motion(random), misplace(points, v, errors[v]);
    const Registration found = register_views(points, {}, {.refine = true, .limit_m = 1e-3});
    ASSERT_EQ(found.refused, "") << seed;
    EXPECT_NEAR(found.after.value, 1, 0.06);
    for (std::size_t v = 1; v < 3; ++v) {
      const Missed m = missed(found.views[v], errors[v]);
      inside += m.inside(), all += 6, chi_square += m.chi_square();
    }
  }
  const double share = static_cast<double>(inside) / all, room = 2.6 * std::sqrt(0.05 * 0.95 / all);
  EXPECT_GT(share, 0.93 - room);
  EXPECT_LT(share, std::min(1.0, 0.97 + room));
  EXPECT_GT(stats::chi2_upper(chi_square, all), 1e-4);
  EXPECT_GT(chi_square / all, 0.6);
}

TEST(Registration, WhereNothingIsMisplacedNothingMoves) {
  double chi_square = 0;
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    const Registration found = register_views(seen(bumps(), coarse, seed), {}, {.refine = true, .limit_m = 1e-3});
    ASSERT_EQ(found.refused, "");
    chi_square += missed(found.views[1], {}).chi_square();
    EXPECT_EQ(found.views[0].motion, ViewMotion{});
  }
  EXPECT_GT(stats::chi2_upper(chi_square, 36), 1e-3);
}

std::vector<std::string> open_of(const io::TriangleMesh& thing, const SeenViews& views = {.side = 50, .f_px = 150}) {
  const Registration found = register_views(seen(thing, views, 2), {}, {.refine = true});
  EXPECT_EQ(found.slides, !found.refused.empty());
  EXPECT_EQ(found.views[0].held, 6U);
  return found.views[1].open;
}

TEST(Registration, SaysWhatSlides) {
  EXPECT_THAT(open_of(flat()), ElementsAre("sliding in the plane across (0.00, 0.00, 1.00)",
                                           StartsWith("turning about the axis (0.00, 0.00, 1.00) through (")));
  EXPECT_THAT(open_of(shapes::ball(0.07, 6)), ElementsAre(StartsWith("turning about every axis through (")));
  EXPECT_THAT(open_of(round_about_y(0.05, 0)),
              ElementsAre("sliding along (0.00, 1.00, 0.00)",
                          StartsWith("turning about the axis (0.00, 1.00, 0.00) through (")));
  EXPECT_THAT(open_of(round_about_y(0.045, 0.45), {.side = 90, .f_px = 270}),
              ElementsAre(StartsWith("turning about the axis (0.00, 1.00, 0.00) through (")));
  EXPECT_THAT(open_of(bumps()), ElementsAre());
}

TEST(Registration, HoldMovesWhatIsHeldAlone) {
  MeasuredPoints points = seen(flat(), coarse, 4);
  const ViewMotion error = motion({8e-4, -6e-4, 1e-3}, {3e-4, 2e-4, 4e-4});
  misplace(points, 1, error);
  EXPECT_TRUE(register_views(points, {}, {.refine = true}).slides);
  const Registration found = register_views(points, {}, {.refine = true, .hold = true});
  ASSERT_EQ(found.refused, "");
  const ViewShift& view = found.views[1];
  EXPECT_EQ(view.held, 3U);
  EXPECT_FALSE(view.open.empty());
  EXPECT_NEAR(view.shift_m.z, -4e-4, 5 * std::sqrt(view.covariance[35]));
  EXPECT_NEAR(view.turn_rad.x, -8e-4, 5 * std::sqrt(view.covariance[0]));
  EXPECT_LT(std::abs(view.turn_rad.z), 2e-5);
  EXPECT_LT(std::hypot(view.shift_m.x, view.shift_m.y), 1e-5);
  EXPECT_NEAR(found.after.value, 1, 0.06);
}

// What no overlap holds stays where the poses say, and as uncertain; what it holds is better known than before.
TEST(Registration, StatedPosesHoldWhatSlides) {
  MeasuredPoints points = seen(flat(), coarse, 5);
  misplace(points, 1, motion({}, {0, 0, 3e-4}));
  PoseDoubt doubt{.camera_m = points.viewpoints_m[1][0]};
  for (std::size_t k = 0; k < 6; ++k) doubt.covariance[7 * k] = k < 3 ? 1e-6 : 4e-8;
  const Registration found = register_views(points, {std::nullopt, doubt}, {.refine = true});
  ASSERT_EQ(found.refused, "");
  EXPECT_TRUE(found.views[1].open.empty());
  EXPECT_NEAR(found.views[1].shift_m.z, -3e-4, 5e-5);
  EXPECT_LT(std::sqrt(found.views[1].covariance[35]), 3e-5);
  EXPECT_GT(std::sqrt(found.views[1].covariance[21]), 1.5e-4);
  EXPECT_LT(std::hypot(found.views[1].shift_m.x, found.views[1].shift_m.y), 2e-4);
}

// A sheet of 1 mm from both of its sides: surfaces lie close, and face apart.
TEST(Registration, SurfacesThatFaceApartAreNoPairs) {
  io::TriangleMesh thin = flat();
  const io::TriangleMesh other = flat();
  const auto first = static_cast<std::uint32_t>(thin.positions_m.size());
  for (const Vec3 p : other.positions_m) thin.positions_m.push_back({p.x, p.y, -1e-3});
  for (const auto& t : other.triangles) thin.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  SeenViews both = coarse;
  both.cameras[1] = {0.12, -0.02, -0.4};
  const Registration found = register_views(seen(thin, both, 1), {}, {.refine = true});
  EXPECT_TRUE(found.pairs.empty());
  EXPECT_EQ(found.before.residuals, 0U);
}

// Found from afar where surfaces are wavy enough; where not, that is said, and not that something slides.
TEST(Registration, ViewsThatEndElsewhereAreNotMoved) {
  const auto turned_by = [](double angle, double reach_m) {
    MeasuredPoints points = seen(bumps(), coarse, 6);
    misplace(points, 1, motion({0, 0, angle}, {0.01, 0.02, 0.004}));
    return register_views(points, {}, {.refine = true, .limit_m = 1e-3, .reach_m = reach_m});
  };
  EXPECT_NEAR(turned_by(0.3, 0).after.value, 1, 0.06);
  for (const Registration& found : {turned_by(2.5, 0), turned_by(1.5, 0), turned_by(0.6, 0.01)}) {
    EXPECT_NE(found.refused, "");
    EXPECT_FALSE(found.slides);
    EXPECT_EQ(found.after.value, found.before.value);
  }
}

TEST(Registration, DoesNotDependOnThreads) {
  MeasuredPoints points = seen(bumps(), coarse, 7);
  misplace(points, 1, motion({1e-3, 0, 0}, {0, 2e-4, 3e-4}));
  const int before = threads();
  set_threads(1);
  const Registration one = register_views(points, {}, {.refine = true, .limit_m = 1e-3});
  set_threads(3);
  const Registration three = register_views(points, {}, {.refine = true, .limit_m = 1e-3});
  set_threads(before);
  EXPECT_EQ(one.views[1].motion, three.views[1].motion);
  EXPECT_EQ(one.views[1].covariance, three.views[1].covariance);
  EXPECT_EQ(one.after.value, three.after.value);
}

}  // namespace
}  // namespace gonio::mesh
