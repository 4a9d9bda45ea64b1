// What the page of an alignment shows: the way of each start, and regions against masks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "alignment/align_bodies.h"
#include "alignment/alignment_world.h"
#include "alignment/convergence.h"
#include "alignment/model_region.h"
#include "alignment/region_difference.h"

namespace gonio::alignment {
namespace {

using testing::world_of;
using Fate = Tried::Fate;

TEST(Convergence, TheWayIsRecordedAndLookingOnChangesNothing) {
  const auto world = world_of({.solid = 3, .seed = 31, .size_px = 240});
  const Aligned plain = align_bodies(world.input, {.from = AlignWish::From::stated}).front();
  const Aligned seen = align_bodies(world.input, {.from = AlignWish::From::stated, .record = true}).front();
  EXPECT_EQ(plain.fitted.setting.bodies[0].world_from_object.rotation,
            seen.fitted.setting.bodies[0].world_from_object.rotation);
  EXPECT_TRUE(plain.tried.back().rms_px.empty());
  ASSERT_EQ(seen.tried.size(), 1u);
  const Tried& way = seen.tried[0];
  EXPECT_EQ(way.fate, Fate::taken);
  EXPECT_GT(way.rms_px.front(), 3);
  EXPECT_NEAR(way.rms_px.back(), seen.fitted.rms_px, 0.02);
  EXPECT_LT(*std::min_element(way.rms_px.begin(), way.rms_px.end()), 1.2 * way.rms_px.back());
}

TEST(Convergence, OfASearchEachStartHasALineAndTheTakenOneIsLast) {
  const auto world = world_of({.solid = 0, .seed = 33, .from_nothing = true, .size_px = 240});
  const Aligned found = align_bodies(world.input, {.from = AlignWish::From::nothing, .record = true}).front();
  EXPECT_EQ(std::count_if(found.tried.begin(), found.tried.end(), [](const Tried& t) { return t.fate == Fate::taken; }),
            1);
  EXPECT_EQ(found.tried.back().fate, Fate::taken);
  EXPECT_GE(found.tried.size(), 5u);
  const report::Plot plot = convergence_plot("solid", found.tried);
  EXPECT_TRUE(plot.log_y);
  EXPECT_EQ(plot.series.size(), found.tried.size());
  EXPECT_EQ(plot.series.back().name, "taken: " + found.tried.back().from);
  EXPECT_NE(plot.series.back().style, plot.series.front().style);
  EXPECT_EQ(plot.series.front().name, "dropped");
  EXPECT_EQ(table_of_starts("solid", found.tried).rows.size(), found.tried.size());
}

// Masks as the truth has them, with a strip of which nobody can tell; the model stands beside it.
TEST(RegionDifference, CountsWhatIsMissedAndWhatLiesBeyond) {
  constexpr int size = 160;
  const auto world = world_of({.solid = 4, .seed = 35, .size_px = size});
  const AlignmentInput& in = world.input;
  const auto inside = [&](const Setting& s, const RimSubject& subject) {
    std::vector<float> share = model_region(in, s, subject);
    const std::vector<float> over = model_region(in, s, {subject.station, subject.body, {}});
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (subject.lamp) share[i] = std::min(share[i], 1 - over[i]);
      share[i] = share[i] > 0.5F ? 1.0F : 0.0F;
    }
    return share;
  };
  std::vector<std::uint8_t> unknown(static_cast<std::size_t>(size) * size, 0);
  std::fill_n(unknown.begin() + size * size / 2, 2 * size, std::uint8_t{1});
  std::vector<MaskRegions::Mask> masks;
  const RimSubject body{0, 0, {}}, shadow{0, 0, 0};
  masks.push_back({testing::object, "solid", "", false, inside(world.truth, body), true, unknown});
  masks.push_back({testing::shadow, "solid", "", true, inside(world.truth, shadow), true, {}});
  const std::vector<float> seen = masks[0].share;
  const MaskRegions regions(size, size, std::move(masks));
  Setting beside = world.truth;
  beside.bodies[0].world_from_object.translation_m += Vec3{0.006, 0.003, 0};
  const auto two = region_differences(in, {0, 1}, regions, {beside, world.truth});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].masks.at(0).wrong(), 0);
  EXPECT_EQ(two[1].masks.at(1).wrong(), 0);
  EXPECT_EQ(two[1].masks[0].overlap(), 1);

  const std::vector<float> made = inside(beside, body);
  std::size_t missed = 0, beyond = 0, both = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (!unknown[i]) missed += seen[i] > made[i], beyond += made[i] > seen[i], both += made[i] > 0.5F && seen[i] > 0.5F;
  const MaskMatch& match = two[0].masks.at(0);
  EXPECT_EQ(match.what, "solid");
  EXPECT_EQ(two[0].masks.at(1).what, "shadow of solid");
  EXPECT_GT(missed, 20u);
  EXPECT_GT(beyond, 20u);
  EXPECT_EQ(match.missed, missed);
  EXPECT_EQ(match.beyond, beyond);
  EXPECT_EQ(match.both, both);
  EXPECT_EQ(match.compared, seen.size() - 2u * size);
  EXPECT_GT(two[0].masks[1].missed, 0u);

  EXPECT_EQ(two[0].picture.width, two[1].picture.width);
  EXPECT_EQ(two[0].picture.height, two[1].picture.height);
  const auto coloured = [](const io::Image& picture) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < picture.pixels(); ++p) count += picture.data[3 * p] != picture.data[3 * p + 2];
    return count;
  };
  EXPECT_GE(coloured(two[0].picture), missed + beyond);
  EXPECT_EQ(coloured(two[1].picture), 0u);
}

TEST(RegionDifference, WhatCannotBeSeenCoversNothing) {
  constexpr int size = 120;
  const auto world = world_of({.solid = 0, .seed = 36, .size_px = size});
  std::vector<MaskRegions::Mask> masks;
  masks.push_back({testing::object, "solid", "", false, model_region(world.input, world.truth, {0, 0, {}}), true, {}});
  const MaskRegions regions(size, size, std::move(masks));
  Setting behind = world.truth;
  const auto& camera = behind.stations[0].world_from_camera;
  behind.bodies[0].world_from_object.translation_m = camera * Vec3{0, 0, -1};
  const auto one = region_differences(world.input, {0}, regions, {behind});
  EXPECT_EQ(one[0].masks.at(0).both + one[0].masks[0].beyond, 0u);
  EXPECT_GT(one[0].masks[0].missed, 100u);
  EXPECT_EQ(words_of(one[0]).substr(0, 7), "solid: ");
}

}  // namespace
}  // namespace gonio::alignment
