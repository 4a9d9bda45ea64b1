#include "mesh/revolve.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/topology.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

// A ball of 200 x 256: closed, outwards, of genus 0, its volume within the chords' share, its normals radial.
TEST(Revolved, ABallIsABall) {
  std::vector<Vec2> places;
  for (int i = 1; i < 200; ++i) places.push_back({std::sin(pi * i / 200), -std::cos(pi * i / 200)});
  const io::TriangleMesh ball = revolved(profile_through(places), 256);
  const Soundness sound = soundness(ball);
  EXPECT_TRUE(sound.closed());
  EXPECT_TRUE(sound.manifold());
  EXPECT_EQ(sound.genus_sum, 0);
  EXPECT_NEAR(topology_of(prepare(ball, Shading::smooth, "ball")).volume_m3, 4 * pi / 3, 2e-3);
  for (std::size_t i = 0; i + 2 < ball.positions_m.size(); ++i)  // the ends of the profile look along half a step
    EXPECT_GT(dot(ball.normals[i], ball.positions_m[i]), 0.9999) << i;
}

}  // namespace
}  // namespace gonio::mesh
