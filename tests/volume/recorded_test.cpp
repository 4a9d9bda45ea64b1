// Recorded volumes: components and Euler numbers as scikit-image and SciPy count them (SOURCE.md beside the data), and
// surfaces beside marching cubes' areas.
#include <gtest/gtest.h>

#include "data.h"
#include "volume/surfaces.h"
#include "volume/topology.h"

namespace gonio::volume {
namespace {

// Marching cubes of whole numbers at T + 0.5 sees the voxels above T as inside, as we do at T + 0.5.
Contour sound_contour(io::VolumeSource& source, double threshold, Connectivity inside = Connectivity::twenty_six) {
  ContourWish wish;
  wish.threshold = threshold;
  wish.inside = inside;
  Contour surface = contour(source, wish);
  EXPECT_EQ(tests::soundness(surface.positions, surface.triangles).euler, 2 * euler_number(source, threshold, inside));
  return surface;
}

// Marching cubes leaves the surface open at the border; ours has half a voxel and the caps beyond it.
Contour within_border(const Contour& surface, const io::VolumeSource& source) {
  Contour part = surface;
  std::erase_if(part.triangles, [&](const auto& t) {
    for (unsigned a = 0; a < 3; ++a) {
      float sum = 0;
      for (const std::uint32_t v : t) sum += surface.positions[v][a];
      if (sum < 0 || sum > 3 * static_cast<float>(source.head().size[a] - 1)) return true;
    }
    return false;
  });
  return part;
}

TEST(RecordedVolume, EngineBlock) {
  GONIO_NEEDS_DATA("ct/engine_block");
  const auto engine = io::open_volume(gonio::tests::data("ct/engine_block") / "engine.nrrd");
  const Components all = components(*engine, 71, Connectivity::six);
  ASSERT_EQ(all.list.size(), 1u);
  EXPECT_EQ(all.list[0].voxels, 1156699u);
  EXPECT_EQ(euler_number(*engine, 71, Connectivity::twenty_six), -19);
  const Contour surface = sound_contour(*engine, 71.5);
  const tests::Soundness found = tests::soundness(surface.positions, surface.triangles);
  EXPECT_TRUE(found.sound()) << found.text();
  const double inner = tests::area(within_border(surface, *engine));
  EXPECT_NEAR(inner / 222858, 1, 0.01);
  RecordProperty("area_within_border", std::to_string(inner));
  RecordProperty("triangles", std::to_string(surface.triangles.size()));
}

TEST(RecordedVolume, EngineBlocksInserts) {
  GONIO_NEEDS_DATA("ct/engine_block");
  const auto engine = io::open_volume(gonio::tests::data("ct/engine_block") / "engine.nrrd");
  const Components all = components(*engine, 179, Connectivity::six);
  ASSERT_EQ(all.list.size(), 5u);
  EXPECT_EQ(all.list[0].voxels, 55207u);
  EXPECT_EQ(all.list[1].voxels, 9233u);
  EXPECT_EQ(all.list[2].voxels, 8686u);
  const auto largest = only(*engine, all, chosen(all, {.largest = 1}), 0);
  EXPECT_EQ(euler_number(*largest, 179, Connectivity::twenty_six), -6);
  sound_contour(*largest, 179.5);
}

TEST(RecordedVolume, Tooth) {
  GONIO_NEEDS_DATA("ct/tooth");
  const auto tooth = io::open_volume(gonio::tests::data("ct/tooth") / "tooth.nrrd");
  EXPECT_EQ(components(*tooth, 128, Connectivity::six).list.size(), 1u);
  EXPECT_EQ(euler_number(*tooth, 128, Connectivity::twenty_six), 1);
  EXPECT_EQ(euler_number(*tooth, 118, Connectivity::twenty_six), 5);
  EXPECT_EQ(components(*tooth, 193, Connectivity::six).list.size(), 2u);
  const Contour surface = sound_contour(*tooth, 128.5);
  const double inner = tests::area(within_border(surface, *tooth));
  EXPECT_NEAR(inner / 43731, 1, 0.01);
  RecordProperty("area_within_border", std::to_string(inner));
  RecordProperty("triangles", std::to_string(surface.triangles.size()));
}

TEST(RecordedVolume, BostonTeapot) {
  GONIO_NEEDS_DATA("ct/boston_teapot_atlas.png");
  io::VolumeWish wish;
  wish.tiles = std::array<std::size_t, 2>{16, 16};
  const auto teapot = io::open_volume(gonio::tests::data("ct/boston_teapot_atlas.png"), wish);
  const Components all = components(*teapot, 40, Connectivity::six);
  EXPECT_EQ(all.list.size(), 117u);
  EXPECT_EQ(all.list[0].voxels, 644678u);
  const Contour surface = sound_contour(*teapot, 40.5);
  const double inner = tests::area(within_border(surface, *teapot));
  EXPECT_NEAR(inner / 268737, 1, 0.01);
  RecordProperty("area_within_border", std::to_string(inner));
  RecordProperty("triangles", std::to_string(surface.triangles.size()));
}

// The data folder's README: at 40 the largest of 117 components holds the pot and the table that it stands on. The
// table's values are half the pot's; by them it goes, and the specks by their size; what lies in the pot stays or goes
// as asked. The core may lie anywhere between the two.
TEST(RecordedVolume, BostonTeapotLeavesItsTable) {
  GONIO_NEEDS_DATA("ct/boston_teapot_atlas.png");
  io::VolumeWish wish;
  wish.tiles = std::array<std::size_t, 2>{16, 16};
  const auto teapot = io::source_of(io::read_volume(gonio::tests::data("ct/boston_teapot_atlas.png"), wish));
  std::uint64_t joined = 0;
  for (const Component& one : components(*teapot, 40, Connectivity::six).list) joined += one.voxels;
  for (const double core : {65.0, 85.0}) {
    const Components parts = split_components(*teapot, 40, Connectivity::six, {core, 3});
    std::uint64_t all = 0;
    for (const Component& one : parts.list) all += one.voxels;
    EXPECT_EQ(all, joined);
    const Component &pot = parts.list[0], &table = parts.list[1];
    EXPECT_FALSE(pot.light);
    EXPECT_NEAR(pot.voxels / 513000.0, 1, 0.01) << core;
    EXPECT_EQ(pot.high[0], 243u);  // the spout; the table reaches from 2 to 253
    EXPECT_TRUE(table.light);
    EXPECT_GE(table.low[1], 195u);
    EXPECT_LT(table.mean_value, 55);
    KeepRule rule{.at_least_voxels = 5000, .above_mean = 60};
    const auto stay = [&] { return std::ranges::count(chosen(parts, rule).keep, true); };
    EXPECT_EQ(stay(), 2);  // the pot and what lies in it
    rule.drop_enclosed = true;
    EXPECT_EQ(stay(), 1);
    const auto alone = only(*teapot, parts, chosen(parts, rule), 0);
    const Components left = components(*alone, 40, Connectivity::six);
    ASSERT_EQ(left.list.size(), 1u);
    EXPECT_EQ(left.list[0].voxels, pot.voxels);
  }
}

}  // namespace
}  // namespace gonio::volume
