// Refraction at a plane before the lens (camera/mechanisms/camera_flat_port.h), held against Fermat's principle and
// against what is known of it near the axis.
#include <gtest/gtest.h>

#include "base/random.h"
#include "camera/camera_model.h"
#include "camera/mechanisms/camera_flat_port.h"

namespace gonio::camera {
namespace {

using equation::FlatPort;

struct Case {
  FlatPort port;
  Vec3 point_m;
};
std::vector<Case> cases() {
  std::vector<Case> list;
  Random random(4, 1);
  for (int i = 0; i < 200; ++i) {
    const FlatPort port{random.uniform(0.75, 1.8), random.uniform(0.005, 0.3), random.uniform(-0.2, 0.2),
                        random.uniform(-0.2, 0.2)};
    const double depth = random.uniform(0.35, 1.2);
    list.push_back({port, {random.uniform(-0.4, 0.4) * depth, random.uniform(-0.3, 0.3) * depth, depth}});
  }
  return list;
}

// Fermat: where light crosses the plane its optical path is the shortest one. Golden sections along the line from the
// foot of the camera to that of the point know neither Snell nor this equation.
Vec3 shortest_path_crossing(const FlatPort& port, Vec3 point_m) {
  const Vec3 n = port.normal(), foot = n * port.distance_m;
  const Vec3 across = point_m - n * dot(n, point_m);
  const auto length = [&](double rho) {
    const Vec3 at = foot + across * rho;
    return norm(at) + port.index * norm(point_m - at);
  };
  double low = 0, high = 1;
  const double golden = 0.6180339887498949;
  while (high - low > 1e-9) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (length(a) < length(b) ? high : low) = length(a) < length(b) ? b : a;
  }
  return foot + across * (0.5 * (low + high));
}

TEST(FlatPort, LightTakesTheShortestPath) {
  for (const Case& c : cases()) {
    const Vec3 seen = equation::camera_flat_port(c.port, c.point_m),
               expected = shortest_path_crossing(c.port, c.point_m);
    EXPECT_LT(norm(seen - expected), 1e-6) << c.port.index << " " << c.port.distance_m;
    EXPECT_NEAR(dot(seen, c.port.normal()), c.port.distance_m, 1e-12);
  }
}

// A swimming pool looks three quarters as deep: near the axis depths beyond the plane are divided by the index.
TEST(FlatPort, NearTheAxisDepthsAreDividedByTheIndex) {
  const FlatPort port{4.0 / 3, 0.1, 0, 0};
  const Vec3 seen = equation::camera_flat_port(port, {1e-5, 0, 0.5});
  EXPECT_NEAR(seen.x / seen.z, 1e-5 / (0.1 + 0.4 * 0.75), 1e-12);
}

TEST(FlatPort, AnIndexOfOneAndPointsBeforeThePlaneAreLeftAlone) {
  const Vec3 point{0.1, -0.05, 0.4};
  EXPECT_EQ(equation::camera_flat_port({1, 0.1, 0.2, 0.1}, point), point);
  EXPECT_EQ(equation::camera_flat_port({1.33, 0.8, 0, 0}, point), point);
}

TEST(FlatPort, PixelsAndRaysOfACameraAreInverse) {
  const CameraModel plain({600, 610, 320, 240, {-0.1, 0.02}}, 640, 480);
  for (const Case& c : cases()) {
    const CameraModel camera = plain.with_port(c.port).with_pupil(2e-3);
    const auto pixel = camera.project(c.point_m);
    ASSERT_TRUE(pixel.has_value());
    const Ray ray = camera.ray(*pixel);
    const Vec3 off = cross(c.point_m - ray.origin_m, ray.direction);
    EXPECT_LT(norm(off), 2e-6) << c.port.index;
    EXPECT_NEAR(norm(ray.direction), 1, 1e-12);
  }
}

}  // namespace
}  // namespace gonio::camera
