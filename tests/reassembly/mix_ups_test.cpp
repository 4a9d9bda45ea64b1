// What people turn round, over simulated sightings: each mistake is named, and none where there is none.
#include "reassembly/mix_ups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "marker_worlds.h"

namespace gonio::reassembly {
namespace {

using testing::HasSubstr;
using tests::MarkerWorld;

struct Mixed {
  MarkerWorld world;
  std::vector<std::string> cameras;  // views by turns are the left and the right one's
  std::string words() const {
    const Placement placement = place(world.views, bundles(world.views, world.wish), world.pieces, world.wish);
    return mix_up(world.views, cameras, world.pieces, world.wish, placement);
  }
};
Mixed sound() {
  tests::WorldWish wish;
  wish.views = 6;
  wish.body_hides = false;
  const std::vector<Vec3> layout{{0.05, 0, 0.01},      {-0.02, 0.045, 0}, {-0.04, -0.03, 0.02}, {0.01, 0.02, 0.06},
                                 {0.03, -0.04, -0.03}, {0, 0.05, -0.045}, {-0.05, 0.01, -0.02}, {0.02, -0.015, 0.055}};
  Mixed mixed{tests::make_world(wish, std::vector<std::vector<Vec3>>{layout}, 11), {}};
  for (std::size_t v = 0; v < mixed.world.views.size(); ++v) mixed.cameras.push_back(v % 2 == 0 ? "left" : "right");
  return mixed;
}

TEST(MixUps, NothingIsNamedWhereNothingIsWrong) {
  EXPECT_EQ(sound().words(), "");
}

TEST(MixUps, PosesTheOtherWayRound) {
  Mixed m = sound();
  for (View& view : m.world.views) {
    const auto turned = inverse(view.world_from_camera);
    view.world_from_camera = {turned.rotation, turned.translation_m};
  }
  EXPECT_THAT(m.words(), HasSubstr("camera_from_world"));
}

TEST(MixUps, AxesOfOtherPrograms) {
  Mixed m = sound();
  for (View& view : m.world.views)
    view.world_from_camera.rotation = normalized(view.world_from_camera.rotation * Quaternion{0, 1, 0, 0});
  EXPECT_THAT(m.words(), HasSubstr("OpenGL"));
}

TEST(MixUps, MirroredPhotographs) {
  Mixed m = sound();
  for (View& view : m.world.views)
    for (Outline& outline : view.outlines) outline.axis.x = -outline.axis.x;
  EXPECT_THAT(m.words(), HasSubstr("mirrored"));
}

TEST(MixUps, LeftForRight) {
  Mixed m = sound();
  for (std::size_t v = 0; v + 1 < m.world.views.size(); v += 2)
    std::swap(m.world.views[v].outlines, m.world.views[v + 1].outlines);
  EXPECT_THAT(m.words(), HasSubstr("left for right"));
}

TEST(MixUps, PlacesInMillimetres) {
  Mixed m = sound();
  for (View& view : m.world.views) view.world_from_camera.translation_m = 1e3 * view.world_from_camera.translation_m;
  EXPECT_THAT(m.words(), HasSubstr("millimetres"));
}

}  // namespace
}  // namespace gonio::reassembly
