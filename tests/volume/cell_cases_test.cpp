// The 256 cases of a cell, held against what cell_cases.h promises of them.
#include "volume/cell_cases.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "volume/sheet_vertex.h"

namespace gonio::volume {
namespace {

constexpr double end_margin = 0x1p-7;

std::set<int> crossed_edges(unsigned mask) {
  std::set<int> crossed;
  for (int edge = 0; edge < 12; ++edge)
    if ((mask >> lower_corner(edge) & 1) != (mask >> upper_corner(edge) & 1)) crossed.insert(edge);
  return crossed;
}

std::array<double, 3> point_on(int edge, double t) {
  const int low = lower_corner(edge);
  std::array<double, 3> p{static_cast<double>(low & 1), static_cast<double>(low >> 1 & 1),
                          static_cast<double>(low >> 2)};
  p[edge / 4] = t;
  return p;
}

TEST(CellCases, EveryCrossingIsOnOneLoop) {
  for (unsigned mask = 0; mask < 256; ++mask) {
    const CellCase& kind = cell_cases()[mask];
    if (kind.tunnel) continue;
    std::multiset<int> on_loops;
    for (unsigned s = 0; s < kind.sheets; ++s)
      for (unsigned n = 0; n < kind.sheet[s].count; ++n) on_loops.insert(kind.sheet[s].edges[n]);
    const std::set<int> crossed = crossed_edges(mask);
    EXPECT_TRUE(std::equal(crossed.begin(), crossed.end(), on_loops.begin(), on_loops.end())) << mask;
  }
}

// Four pairs of opposite corners make a tunnel; one way and no other.
TEST(CellCases, TunnelsAreAllButTwoOppositeCorners) {
  int tunnels = 0;
  for (unsigned mask = 0; mask < 256; ++mask) {
    if (!cell_cases()[mask].tunnel) continue;
    ++tunnels;
    const unsigned missing = ~mask & 255;
    EXPECT_EQ(std::popcount(missing), 2);
    EXPECT_EQ(std::countr_zero(missing) + std::bit_width(missing) - 1, 7);
  }
  EXPECT_EQ(tunnels, 4);
}

// By symmetry: each of the 22 classes of cells under rotation and reflection has one number of sheets.
TEST(CellCases, TurnedCellsHaveAsManySheets) {
  for (unsigned mask = 0; mask < 256; ++mask)
    for (int axis = 0; axis < 3; ++axis) {
      unsigned mirrored = 0, turned = 0;
      for (int corner = 0; corner < 8; ++corner) {
        if ((mask >> corner & 1) == 0) continue;
        mirrored |= 1u << (corner ^ 1 << axis);
        turned |= 1u << ((corner << 1 & 7) | corner >> 2);
      }
      EXPECT_EQ(cell_cases()[mask].sheets, cell_cases()[mirrored].sheets) << mask;
      EXPECT_EQ(cell_cases()[mask].sheets, cell_cases()[turned].sheets) << mask;
      EXPECT_EQ(std::popcount(cell_cases()[mask].ambiguous), std::popcount(cell_cases()[turned].ambiguous)) << mask;
    }
}

// What sheet_vertex.cpp relies on: with crossings anywhere between the ends, the mean of a loop's crossings keeps its
// distance from the cell's faces, every crossing from its sheet's plane, and those of other sheets lie beyond it. All
// are linear in the crossings, so that the extreme ones tell.
TEST(CellCases, MeansKeepTheirDistanceAndPlanesSeparate) {
  for (unsigned mask = 0; mask < 256; ++mask) {
    const CellCase& kind = cell_cases()[mask];
    for (unsigned s = 0; s < kind.sheets; ++s) {
      const Sheet& sheet = kind.sheet[s];
      for (unsigned ends = 0; ends < 1u << sheet.count; ++ends) {
        std::array<double, 3> mean{};
        for (unsigned n = 0; n < sheet.count; ++n) {
          const auto p = point_on(sheet.edges[n], (ends >> n & 1) != 0 ? 1 - end_margin : end_margin);
          double height = 0;
          for (unsigned a = 0; a < 3; ++a) {
            mean[a] += p[a] / sheet.count;
            height += sheet.plane[a] * p[a];
          }
          ASSERT_TRUE(!kind.shared || height <= sheet.bound - end_margin) << mask;
        }
        for (const double m : mean) {
          ASSERT_GT(m, 0x1p-10) << mask;
          ASSERT_LT(m, 1 - 0x1p-10) << mask;
        }
      }
      for (unsigned other = 0; other < kind.sheets; ++other) {
        if (other == s) continue;
        for (unsigned n = 0; n < kind.sheet[other].count; ++n)
          for (const double t : {0.0, 1.0}) {
            const auto p = point_on(kind.sheet[other].edges[n], t);
            double height = 0;
            for (unsigned a = 0; a < 3; ++a) height += sheet.plane[a] * p[a];
            ASSERT_GE(height, sheet.bound) << mask;
          }
      }
    }
  }
}

}  // namespace
}  // namespace gonio::volume
