#include "geom/rigid.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace gonio {
namespace {

Vec3 random_direction(Random& random) {
  return normalized(Vec3{random.normal(), random.normal(), random.normal()});
}

// Distance of two rotations: q and -q are the same one.
double difference(const Quaternion& a, const Quaternion& b) {
  const double d = std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
  const Quaternion e = conjugate(a) * b;
  return d > 0.5 ? norm(Vec3{e.x, e.y, e.z}) : 1.0;
}

// Angles where the closed forms lose their digits: 0, pi and what lies beside them.
std::vector<double> delicate_angles() {
  std::vector<double> angles = {0, 1e-300, 1e-160, 1e-20, 1e-9, 1e-4, 1.0001e-4, 0.5, 1, pi / 2, 2, 3, pi};
  for (const double gap : {1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) angles.push_back(pi - gap);
  return angles;
}

TEST(Rigid, RotationVectorRoundTrip) {
  Random random(7);
  for (const double angle : delicate_angles())
    for (int k = 0; k < 100; ++k) {
      const Vec3 v = random_direction(random) * angle;
      const Vec3 back = rotation_vector_of(quaternion_of_rotation_vector(v));
      const double error = angle > pi - 1e-9 ? std::min(norm(back - v), norm(back + v)) : norm(back - v);
      EXPECT_LE(error, 1e-15 * std::max(angle, 1e-290) * 20) << "angle " << angle;
    }
}

TEST(Rigid, MatrixRoundTrip) {
  Random random(8);
  for (const double angle : delicate_angles())
    for (int k = 0; k < 100; ++k) {
      const Quaternion q = quaternion_of_rotation_vector(random_direction(random) * angle);
      const Quaternion back = quaternion_of(matrix_of(q));
      EXPECT_GE(back.w, 0.0);
      EXPECT_LE(difference(q, back), 2e-15) << "angle " << angle;
    }
}

TEST(Rigid, HalfTurnsAboutTheAxes) {
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Quaternion q = quaternion_of_rotation_vector(axis * pi);
    EXPECT_LE(difference(q, quaternion_of(matrix_of(q))), 1e-15);
    EXPECT_NEAR(norm(rotation_vector_of(q)), pi, 1e-15);
  }
}

TEST(Rigid, MatrixOfAQuarterTurnAboutZ) {
  const Vec3 p = matrix_of(quaternion_of_rotation_vector({0, 0, pi / 2})) * Vec3{1, 0, 0};
  EXPECT_NEAR(p.x, 0, 1e-15);
  EXPECT_NEAR(p.y, 1, 1e-15);
  EXPECT_NEAR(p.z, 0, 1e-15);
}

TEST(Rigid, CompositionIsApplicationInTurn) {
  Random random(9);
  for (int k = 0; k < 1000; ++k) {
    const Rigid<frame::World, frame::Tool> world_from_tool{
        quaternion_of_rotation_vector(random_direction(random) * random.uniform(0, pi)), random_direction(random)};
    const Rigid<frame::Tool, frame::Camera> tool_from_camera{
        quaternion_of_rotation_vector(random_direction(random) * random.uniform(0, pi)), random_direction(random)};
    const Vec3 p_camera = random_direction(random);
    const Rigid<frame::World, frame::Camera> world_from_camera = world_from_tool * tool_from_camera;
    EXPECT_LE(norm(world_from_camera * p_camera - world_from_tool * (tool_from_camera * p_camera)), 1e-14);
    EXPECT_LE(norm(inverse(world_from_camera) * (world_from_camera * p_camera) - p_camera), 1e-14);
  }
}

TEST(Vector, BasisIsOrthonormalAndRightHandedEverywhere) {
  Random random(10);
  std::vector<Vec3> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}, normalized(Vec3{1e-9, 0, -1})};
  for (int k = 0; k < 1000; ++k) normals.push_back(random_direction(random));
  for (const Vec3 n : normals) {
    const Basis basis(n);
    EXPECT_NEAR(dot(basis.t, basis.b), 0, 1e-15);
    EXPECT_LE(norm(cross(basis.t, basis.b) - n), 1e-14);
    const Vec3 v = random_direction(random);
    EXPECT_LE(norm(basis.to_world(basis.to_local(v)) - v), 1e-14);
  }
}

}  // namespace
}  // namespace gonio
