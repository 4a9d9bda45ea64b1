// Mechanisms of objects as edits of instances: what each equation says of a point, and that nothing changes at neutral.
#include "scene/placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::scene {
namespace {

std::shared_ptr<const mesh::Mesh> tetrahedron() {
  auto mesh = std::make_shared<mesh::Mesh>();
  mesh->positions_m = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.2, 0}, {0, 0, 0.3}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh->normals = mesh::averaged_normals(mesh->positions_m, mesh->triangles);
  return mesh;
}
Instance standing(Shape shape) {
  Instance instance;
  instance.id = "cup";
  instance.shape = std::move(shape);
  instance.world_from_object = {quaternion_of_rotation_vector({0, 0, 0.4}), {1, 2, 3}};
  return instance;
}
Vec3 vertex(const Instance& instance, std::size_t i) {
  return instance.world_from_object * std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape)->positions_m[i];
}
const mechanism::Mechanism& of(const char* id) {
  return *mechanism::find_mechanism(id);
}

TEST(Placement, EveryMechanismOfObjectsIsKnownAndVanishesAtNeutral) {
  int count = 0;
  for (const mechanism::Mechanism* m : mechanism::all_mechanisms()) {
    if (m->target != mechanism::Target::object) continue;
    ++count;
    ASSERT_TRUE(applies_to_objects(*m)) << m->id;
    std::vector<double> neutral, other;
    for (const auto& p : m->parameters) neutral.push_back(p.neutral), other.push_back(p.start);
    const bool ground = m->id.starts_with("ground.");  // of planes
    const Instance before = ground ? standing(Plane{1, 1}) : standing(tetrahedron());
    const Instance same = moved(before, *m, neutral), changed = moved(before, *m, other);
    EXPECT_EQ(same.world_from_object, before.world_from_object) << m->id;
    if (ground) {
      EXPECT_TRUE(std::holds_alternative<Plane>(same.shape) && !std::holds_alternative<Plane>(changed.shape)) << m->id;
      continue;
    }
    EXPECT_EQ(vertex(same, 3), vertex(before, 3)) << m->id;
    EXPECT_FALSE(vertex(changed, 3) == vertex(before, 3)) << m->id;
  }
  EXPECT_GE(count, 4);
}

TEST(Placement, PosesTurnAboutTheMiddleOfTheBox) {
  const Instance before = standing(tetrahedron());
  const Vec3 middle = before.world_from_object * Vec3{0.05, 0.1, 0.15};
  const Vec3 turn{0.01, -0.02, 0.03}, shift{0.001, 0.002, -0.003};
  const Instance after =
      moved(before, of("geometry.pose"), std::vector<double>{shift.x, shift.y, shift.z, turn.x, turn.y, turn.z});
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 expected =
        middle + matrix_of(quaternion_of_rotation_vector(turn)) * (vertex(before, i) - middle) + shift;
    EXPECT_LT(norm(vertex(after, i) - expected), 1e-12);
  }
}

TEST(Placement, GrowthOffsetAndContactDoWhatTheySay) {
  const Instance before = standing(tetrahedron());
  const Instance grown = moved(before, of("geometry.scale"), std::vector<double>{0.05});
  EXPECT_NEAR(norm(vertex(grown, 3) - vertex(grown, 0)), 0.3 * 1.05, 1e-12);
  const Instance shrunk = moved(before, of("geometry.shrinkage"), std::vector<double>{0.1, 0, -0.1});
  EXPECT_NEAR(vertex(shrunk, 3).z - vertex(shrunk, 0).z, 1.1 * (vertex(before, 3).z - vertex(before, 0).z), 1e-12);
  EXPECT_NEAR(norm(vertex(shrunk, 1) - vertex(shrunk, 0)), 0.9 * norm(vertex(before, 1) - vertex(before, 0)), 1e-12);
  const Instance thicker = moved(before, of("geometry.offset"), std::vector<double>{0.001});
  EXPECT_NEAR(norm(vertex(thicker, 1) - vertex(before, 1)), 0.001, 1e-12);
  const Instance sunk = moved(before, of("geometry.contact"), std::vector<double>{0.002});
  EXPECT_NEAR(vertex(sunk, 2).z, vertex(before, 2).z - 0.002, 1e-12);
  const Instance ball = moved(standing(Sphere{0.1}), of("geometry.scale"), std::vector<double>{-0.1});
  EXPECT_NEAR(std::get<Sphere>(ball.shape).radius_m, 0.09, 1e-12);
}

TEST(Placement, BendingIsASquareAboutTheMiddle) {
  const Instance before = standing(tetrahedron());
  const std::vector<double> curl{0.4, -0.2, 0.1};
  const Instance bent = moved(before, of("geometry.bend"), curl);
  const auto& was = *std::get<std::shared_ptr<const mesh::Mesh>>(before.shape);
  const auto& is = *std::get<std::shared_ptr<const mesh::Mesh>>(bent.shape);
  Vec3 lower = was.positions_m[0], upper = lower;
  for (const Vec3 p : was.positions_m) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), 0};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), 0};
  }
  for (std::size_t i = 0; i < was.positions_m.size(); ++i) {
    const Vec3 d = was.positions_m[i] - (lower + upper) * 0.5;
    const double height = 0.5 * (0.4 * d.x * d.x - 0.2 * d.y * d.y) + 0.1 * d.x * d.y;
    EXPECT_NEAR(is.positions_m[i].z - was.positions_m[i].z, height, 1e-15);
  }
}

TEST(Placement, APlaneThatIsNotFlatIsAMeshOfTheSameHeights) {
  const Instance bent = moved(standing(Plane{2, 1}), of("ground.not-flat"), std::vector<double>{0.4, -0.2, 0.1});
  const auto& mesh = *std::get<std::shared_ptr<const mesh::Mesh>>(bent.shape);
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i) {
    const Vec3 p = mesh.positions_m[i];
    EXPECT_NEAR(p.z, 0.2 * p.x * p.x - 0.1 * p.y * p.y + 0.1 * p.x * p.y, 1e-15);
    EXPECT_NEAR(norm(mesh.normals[i]), 1, 1e-12);
    EXPECT_GT(mesh.normals[i].z, 0.5);
  }
  for (const auto& t : mesh.triangles)
    EXPECT_GT(cross(mesh.positions_m[t[1]] - mesh.positions_m[t[0]], mesh.positions_m[t[2]] - mesh.positions_m[t[0]]).z,
              0);
}

TEST(Placement, NamesAndCountsAreChecked) {
  std::vector<Instance> instances = {standing(Sphere{0.1})};
  manifest::MechanismUse use;
  use.on = {"plate"};
  EXPECT_THROW(apply_mechanism(instances, of("geometry.scale"), use, "m#/mechanisms/geometry.scale"), Error);
  use.on = {"cup"};
  use.parameters["growth"] = manifest::Parameter(std::vector<double>{0.1, 0.2});
  EXPECT_THROW(apply_mechanism(instances, of("geometry.scale"), use, "m#/mechanisms/geometry.scale"), Error);
}

}  // namespace
}  // namespace gonio::scene
