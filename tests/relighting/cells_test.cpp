#include "relighting/cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/random.h"

namespace gonio::relighting {
namespace {

std::vector<std::array<int, 2>> scattered(std::size_t count) {
  std::set<std::array<int, 2>> places;
  Random random(5, 1);
  while (places.size() < count)
    places.insert({static_cast<int>(random.below(200)), static_cast<int>(random.below(120))});
  return {places.begin(), places.end()};
}

TEST(Cells, EveryPixelIsInOneCell) {
  const std::vector<std::array<int, 2>> pixels = scattered(1000);
  const auto cells = cells_of(pixels, 12);
  ASSERT_EQ(cells.size(), 12u);
  std::vector<int> times(pixels.size());
  for (const auto& cell : cells) {
    EXPECT_GE(cell.size(), 80u);
    EXPECT_LE(cell.size(), 86u);
    for (const std::size_t p : cell) ++times[p];
  }
  EXPECT_EQ(std::ranges::count(times, 1), 1000);
}

// Two cells' boxes share a border at most: of columns that were cut across, none lies within another.
TEST(Cells, LieBesideEachOther) {
  const std::vector<std::array<int, 2>> pixels = scattered(1000);
  const auto cells = cells_of(pixels, 12);
  const auto box = [&](const std::vector<std::size_t>& cell, std::size_t axis) {
    const auto [low, high] = std::ranges::minmax(cell, {}, [&](std::size_t p) { return pixels[p][axis]; });
    return std::array{pixels[low][axis], pixels[high][axis]};
  };
  for (std::size_t a = 0; a < cells.size(); ++a)
    for (std::size_t b = a + 1; b < cells.size(); ++b) {
      int apart = 0;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto one = box(cells[a], axis), other = box(cells[b], axis);
        apart += one[1] <= other[0] || other[1] <= one[0];
      }
      EXPECT_GE(apart, 1) << a << " and " << b;
    }
}

TEST(Cells, FewPixelsMakeFewCells) {
  EXPECT_EQ(cells_of(scattered(100), 12).size(), 2u);
  EXPECT_EQ(cells_of(scattered(10), 12).size(), 1u);
  EXPECT_TRUE(cells_of({}, 12).empty());
}

TEST(Cells, OnlyFewPicturesAreCut) {
  EXPECT_EQ(cells_each(3, 3), 1u);
  EXPECT_EQ(cells_each(2, 3), 6u);
  EXPECT_EQ(cells_each(1, 3), 12u);
  EXPECT_EQ(cells_each(0, 3), 1u);
}

}  // namespace
}  // namespace gonio::relighting
