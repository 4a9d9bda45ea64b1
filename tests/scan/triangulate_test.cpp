// Points of planes, steps and balls: errors across the surface against the stated covariances, bias, and a rig that is
// not as it is said to be.
#include "scan/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scan/scan_world.h"

namespace gonio::scan {
namespace {

using tests::ScanWorld;

constexpr Axis both[] = {Axis::column, Axis::row};

struct Off {
  double rms = 0, bias = 0, stated = 0;  // m, across the surface
};

// Of points that do not lie at the shape's own edges (the step's, the ball's rim).
Off off_of(const ScanWorld& world, const Cloud& cloud) {
  double squares = 0, sum = 0, stated = 0, count = 0;
  for (const ScanPoint& p : cloud.points) {
    const std::array<double, 3> at{p.position_m.x, p.position_m.y, p.position_m.z};
    Vec3 n{world.tilt, 0, -1};
    if (world.shape == ScanWorld::Shape::ball) n = {at[0], at[1], at[2] - world.distance};
    n = normalized(n);
    if (world.shape == ScanWorld::Shape::ball && n.z > -0.5) continue;
    if (world.shape == ScanWorld::Shape::step && std::abs(at[0] - 0.01) < 0.006) continue;
    const std::array<double, 6>& c = p.covariance;
    const Vec3 cn{c[0] * n.x + c[1] * n.y + c[2] * n.z, c[1] * n.x + c[3] * n.y + c[4] * n.z,
                  c[2] * n.x + c[4] * n.y + c[5] * n.z};
    const double off = tests::off_shape(world, at);
    squares += off * off, sum += off, stated += dot(n, cn), ++count;
  }
  EXPECT_GT(count, 2000);
  return {std::sqrt(squares / count), sum / count, std::sqrt(stated / count)};
}

constexpr ScanWorld::Shape shapes[] = {ScanWorld::Shape::plane, ScanWorld::Shape::step, ScanWorld::Shape::ball};

TEST(Triangulate, PointsOfAProjectorHaveTheErrorsThatTheyState) {
  const double periods[] = {1, 6, 40};
  for (const ScanWorld::Shape shape : shapes) {
    ScanWorld world;
    world.shape = shape;
    const Codes codes = tests::decoded(world, world.left, cosine_sequence(480, 360, both, periods, 4));
    const Cloud cloud = points_of_projector(codes, tests::station_of(world.left), tests::station_of(world.projector));
    const Off off = off_of(world, cloud);
    EXPECT_NEAR(off.rms / off.stated, 1, 0.2) << static_cast<int>(shape);
    EXPECT_LT(std::abs(off.bias), 0.2 * off.stated) << static_cast<int>(shape);
    EXPECT_NEAR(cloud.epipolar_chi_square, 1, 0.2);
  }
}

TEST(Triangulate, PointsOfTwoCamerasHaveTheErrorsThatTheyState) {
  const double periods[] = {1, 6, 40};
  for (const ScanWorld::Shape shape : shapes)
    for (const bool gray : {false, true}) {
      ScanWorld world;
      world.shape = shape;
      const Sequence s = gray ? gray_sequence(480, 360, both) : cosine_sequence(480, 360, both, periods, 4);
      const Codes left = tests::decoded(world, world.left, s), right = tests::decoded(world, world.right, s);
      const Cloud cloud =
          points_of_cameras(left, tests::station_of(world.left), right, tests::station_of(world.right), 480);
      const Off off = off_of(world, cloud);
      EXPECT_NEAR(off.rms / off.stated, 1, gray ? 0.25 : 0.2) << static_cast<int>(shape) << gray;
      EXPECT_LT(std::abs(off.bias), 0.2 * off.stated) << static_cast<int>(shape) << gray;
      EXPECT_GT(cloud.matched, 10000u);
    }
}

// A camera that is turned by 0.1 degrees about its own x axis sees a pixel beside where it is said to.
TEST(Triangulate, ARigThatIsNotAsItIsSaidContradictsItself) {
  const double periods[] = {1, 6, 40};
  ScanWorld world;
  const Sequence s = cosine_sequence(480, 360, both, periods, 4);
  const Codes left = tests::decoded(world, world.left, s), right = tests::decoded(world, world.right, s);
  Station turned = tests::station_of(world.right);
  turned.rig_from_camera.rotation =
      turned.rig_from_camera.rotation * quaternion_of_rotation_vector({0.1 * pi / 180, 0, 0});
  const Cloud right_one =
      points_of_cameras(left, tests::station_of(world.left), right, tests::station_of(world.right), 480);
  const Cloud wrong_one = points_of_cameras(left, tests::station_of(world.left), right, turned, 480);
  EXPECT_LT(right_one.epipolar_chi_square, 1.5);
  EXPECT_GT(wrong_one.epipolar_chi_square, 20 * right_one.epipolar_chi_square);
  EXPECT_GT(off_of(world, wrong_one).stated, 3 * off_of(world, right_one).stated);
}

}  // namespace
}  // namespace gonio::scan
