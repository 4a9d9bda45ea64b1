// Rays meet what they should, where they should, and never the surface they have just left.
#include "render/ray_caster.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "scenes.h"

namespace gonio::render {
namespace {

using tests::SceneBuilder;

Vec3 random_direction(Random& random) {
  const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

std::shared_ptr<const mesh::Mesh> globe(double radius_m, mesh::Shading shading = mesh::Shading::smooth) {
  return std::make_shared<const mesh::Mesh>(mesh::prepare(tests::globe(radius_m, 40, 80), shading, "globe"));
}

TEST(RayCaster, SphereAndPlaneToTheLastDigits) {
  SceneBuilder builder;
  builder.object(scene::Sphere{0.1}, builder.diffuse(0.5), {0.3, 0.2, 0.1});
  builder.object(scene::Plane{2, 1}, 0, {0, 0, 0}, {0, 0, 0.4});
  const auto scene = builder.scene();
  const RayCaster caster(scene.instances);
  const auto top = caster.closest({0.3, 0.2, 7}, {0, 0, -1});
  ASSERT_TRUE(top);
  EXPECT_EQ(top->instance, 0u);
  EXPECT_NEAR(top->distance_m, 6.8, 1e-14);
  EXPECT_NEAR(top->normal.z, 1, 1e-14);
  const auto table = caster.closest({-0.3, 0.2, 7}, {0, 0, -1});
  ASSERT_TRUE(table);
  EXPECT_EQ(table->instance, 1u);
  EXPECT_NEAR(table->position_m.z, 0, 1e-15);
  EXPECT_FALSE(caster.closest({0.9, 0.9, 7}, {0, 0, -1}));  // beside the turned plane
}

TEST(RayCaster, ManyAnalyticShapesAgreeWithALoopOverAll) {
  SceneBuilder builder;
  builder.diffuse(0.5);
  Random random(1);
  struct Ball {
    Vec3 centre_m;
    double radius_m;
  };
  std::vector<Ball> balls;
  for (int i = 0; i < 200; ++i) {
    balls.push_back({{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0.01, 0.1)});
    builder.object(scene::Sphere{balls.back().radius_m}, 0, balls.back().centre_m);
  }
  const auto scene = builder.scene();
  const RayCaster caster(scene.instances);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 origin{random.uniform(-3, 3), random.uniform(-3, 3), 3}, direction = random_direction(random);
    double nearest = far_away;
    for (const Ball& ball : balls) {
      const Vec3 arm = ball.centre_m - origin;
      const double along = dot(arm, direction), depth = ball.radius_m * ball.radius_m - dot(arm, arm) + along * along;
      if (depth > 0 && along > 0) nearest = std::min(nearest, along - std::sqrt(depth));
    }
    const auto met = caster.closest(origin, direction);
    ASSERT_EQ(met.has_value(), nearest < far_away) << i;
    if (met) {
      EXPECT_NEAR(met->distance_m, nearest, 1e-9);
    }
  }
}

TEST(RayCaster, NothingLeaksThroughAClosedMesh) {
  for (const double scale : {1e-3, 0.1, 10.0}) {
    SceneBuilder builder;
    builder.object(globe(scale), builder.diffuse(0.5), {3 * scale, -2 * scale, 5 * scale});
    const auto scene = builder.scene();
    const RayCaster caster(scene.instances);
    Random random(2);
    Vec3 direction = random_direction(random);
    auto at = caster.closest({3 * scale, -2 * scale, 5 * scale}, direction);
    for (int i = 0; i < 100000; ++i) {
      ASSERT_TRUE(at) << "bounce " << i << " at scale " << scale;
      do direction = random_direction(random);
      while (dot(direction, at->geometric_normal) < 1e-4);
      at = caster.closest_from(*at, direction);
    }
  }
}

TEST(RayCaster, ConvexBodiesDoNotShadowThemselves) {
  for (const bool analytic : {true, false}) {
    SceneBuilder builder;
    const scene::Shape shape = analytic ? scene::Shape(scene::Sphere{0.1}) : scene::Shape(globe(0.1));
    builder.object(shape, builder.diffuse(0.5), {0.5, 0.5, 0.5});
    const auto scene = builder.scene();
    const RayCaster caster(scene.instances);
    Random random(3);
    for (int i = 0; i < 100000; ++i) {
      const Vec3 out = random_direction(random);
      const auto at = caster.closest(Vec3{0.5, 0.5, 0.5} + out, -out);
      ASSERT_TRUE(at);
      const Vec3 direction = random_direction(random);
      const double cosine = dot(direction, at->geometric_normal);
      if (cosine < 0) {
        EXPECT_TRUE(caster.occluded(*at, direction));
      }
      if (cosine > 1e-3) {
        EXPECT_FALSE(caster.occluded(*at, direction)) << i << " cosine " << cosine;
      }
    }
  }
}

TEST(RayCaster, OccludersCountOnlyUpToTheLight) {
  SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.diffuse(0.5));
  builder.object(scene::Plane{1, 1}, 0, {0, 0, 0.5});
  const auto scene = builder.scene();
  const RayCaster caster(scene.instances);
  const auto at = caster.closest({0.1, 0.1, 0.2}, {0, 0, -1});
  ASSERT_TRUE(at);
  EXPECT_TRUE(caster.occluded(*at, {0, 0, 1}, 0.51));
  EXPECT_FALSE(caster.occluded(*at, {0, 0, 1}, 0.49));
  EXPECT_TRUE(caster.occluded(*at, {0, 0, -1}, 0.01));  // by the plane itself
}

TEST(RayCaster, NormalsFaceTheRay) {
  SceneBuilder builder;
  builder.object(globe(0.1), builder.diffuse(0.5));
  const auto scene = builder.scene();
  const RayCaster caster(scene.instances);
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 origin = random_direction(random) * (i % 2 ? 0.3 : 0.05), direction = random_direction(random);
    const auto at = caster.closest(origin, direction);
    if (!at) continue;
    EXPECT_LT(dot(at->geometric_normal, direction), 0);
    EXPECT_LT(dot(at->normal, direction), 0);
    EXPECT_NEAR(norm(at->normal), 1, 1e-12);
    if (norm(origin) < 0.1) {
      EXPECT_LT(dot(at->normal, at->position_m), 0);  // seen from inside
    }
  }
}

}  // namespace
}  // namespace gonio::render
