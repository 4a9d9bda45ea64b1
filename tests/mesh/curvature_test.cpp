// Mean curvature of balls, tubes and saddles, of which it is known.
#include "mesh/curvature.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "geom/rigid.h"
#include "mesh/shapes.h"

namespace gonio::mesh {
namespace {

using shapes::ball;
using shapes::grid;

std::vector<float> curvature_of(const io::TriangleMesh& raw, Shading shading = Shading::smooth) {
  return mean_curvature_per_m(prepare(raw, shading, "mesh.ply"));
}

TEST(Curvature, OfABall) {
  for (const double radius : {0.01, 3.0})
    for (const Shading shading : {Shading::smooth, Shading::flat})
      for (const float c : curvature_of(ball(radius, 4), shading)) ASSERT_NEAR(c * radius, -1, 0.01);
}

TEST(Curvature, OfACavityHasTheOtherSign) {
  io::TriangleMesh hollow = ball(0.5, 3);
  for (auto& t : hollow.triangles) std::swap(t[1], t[2]);
  for (const float c : curvature_of(hollow)) ASSERT_NEAR(c * 0.5, 1, 0.03);
}

// The mean of 1 / r and 0; the rims take their neighbours'.
TEST(Curvature, OfATube) {
  const auto tube = [](double u, double v) {
    return Vec3{0.2 * std::cos(2 * pi * v), 0.2 * std::sin(2 * pi * v), u - 0.5};
  };
  io::TriangleMesh mesh = grid(40, 80, true, tube);
  const auto outwards = averaged_normals(mesh.positions_m, mesh.triangles);
  if (dot(outwards[0], mesh.positions_m[0]) < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  for (const float c : curvature_of(mesh)) ASSERT_NEAR(c, -2.5, 0.01);
}

TEST(Curvature, OfPlanesIsZeroWhateverTheTriangles) {
  Random random(4);
  const auto mesh = grid(20, 20, false, [&](double u, double v) {
    const bool inside = u > 0 && u < 1 && v > 0 && v < 1;
    return Vec3{u + (inside ? random.uniform(-0.02, 0.02) : 0), v + (inside ? random.uniform(-0.02, 0.02) : 0), 0.3};
  });
  for (const float c : curvature_of(mesh)) ASSERT_NEAR(c, 0, 1e-10);
}

// z = (a x^2 + b y^2) / 2 has the mean curvature (a + b) / 2 at its vertex, hollow where it is positive (normal +z).
TEST(Curvature, OfASaddle) {
  for (const auto& [a, b] : {std::pair{3.0, -1.0}, std::pair{2.0, -2.0}, std::pair{-1.0, -3.0}}) {
    auto mesh = grid(80, 80, false, [a = a, b = b](double u, double v) {
      const double x = 0.4 * (u - 0.5), y = 0.4 * (v - 0.5);
      return Vec3{x, y, (a * x * x + b * y * y) / 2};
    });
    EXPECT_NEAR(curvature_of(mesh)[40 * 81 + 40], (a + b) / 2, 0.01);
  }
}

TEST(Curvature, TurnsAndScalesWithTheMesh) {
  const auto wavy = [](double u, double v) { return Vec3{u, v, 0.1 * std::sin(5 * u) * std::cos(4 * v)}; };
  const auto before = curvature_of(grid(30, 30, false, wavy));
  const Mat3 turn = matrix_of(quaternion_of_rotation_vector({0.4, 0.9, -1.2}));
  const auto after = curvature_of(grid(30, 30, false, [&](double u, double v) { return turn * wavy(u, v) * 4.0; }));
  for (std::size_t v = 0; v < before.size(); ++v) ASSERT_NEAR(after[v] * 4, before[v], 1e-5);
}

}  // namespace
}  // namespace gonio::mesh
