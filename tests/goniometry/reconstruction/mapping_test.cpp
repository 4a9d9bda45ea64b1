// The mapping of reflectances and the cells that are its coordinates.
#include "goniometry/mapping.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "surface/half_angle.h"
#include "surface/merl_table.h"

namespace gonio::tests {
namespace {

using goniometry::Bins;
using goniometry::Cells;

TEST(Mapping, ComesBackOverSixDecades) {
  for (double f = 1e-4; f < 1e3; f *= 1.7)
    for (const double w : {1e-3, 0.02, 0.4, 1.0}) {
      const double level = goniometry::log_level(f, w);
      EXPECT_NEAR(goniometry::of_level(level, w), f, 1e-10 * f + 1e-12 / w);
      const double step = 1e-4 * (f + 1e-3 / w);
      const double slope = (goniometry::log_level(f + 2 * step, w) - goniometry::log_level(f, w)) / (2 * step);
      EXPECT_NEAR(goniometry::level_slope(f + step, w), slope, 1e-6 * slope);
    }
}

TEST(Mapping, TakesNoiseBelowZeroAsNothing) {
  EXPECT_EQ(goniometry::log_level(-0.1, 0.5), goniometry::log_level(0, 0.5));
  EXPECT_EQ(goniometry::of_level(-100, 0.5), 0);
}

// Exchanged directions and mirrored ones are the same cell; neither direction of a cell is below the horizon.
TEST(Cells, FoldReciprocityAndHandedness) {
  for (const Bins& bins : {Bins{20, 10, 12}, Bins{12, 9, 7}}) {
    const Cells cells(bins);
    std::vector<bool> seen(cells.count());
    for (std::size_t h = 0; h < bins[0]; ++h)
      for (std::size_t d = 0; d < bins[1]; ++d)
        for (std::size_t p = 0; p < bins[2]; ++p) {
          const auto cell = cells.cell_of(h, d, p);
          ASSERT_EQ(cell, cells.cell_of(h, d, bins[2] - 1 - p));
          if (cell == Cells::none) continue;
          seen[cell] = true;
          ASSERT_GE(cell, cells.ring_begin(h));
          ASSERT_LT(cell, cells.ring_begin(h + 1));
        }
    for (std::size_t c = 0; c < cells.count(); ++c) {
      ASSERT_TRUE(seen[c]);
      const auto [wo, wi] = cells.directions(c);
      ASSERT_GT(wo.z, 0);
      ASSERT_GT(wi.z, 0);
      ASSERT_NEAR(cells.weight(c), goniometry::cosine_weight(wi, wo), 1e-6);
      const auto blend = cells.blend(wo, wi), exchanged = cells.blend(wi, wo),
                 mirrored = cells.blend({wo.x, -wo.y, wo.z}, {wi.x, -wi.y, wi.z});
      double here = 0, there = 0, other = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        here += blend.cell[k] == c ? blend.share[k] : 0;
        there += exchanged.cell[k] == c ? exchanged.share[k] : 0;
        other += mirrored.cell[k] == c ? mirrored.share[k] : 0;
      }
      ASSERT_NEAR(here, 1, 1e-6);
      ASSERT_NEAR(there, 1, 1e-6);
      ASSERT_NEAR(other, 1, 1e-6);
    }
  }
}

// What lies between cells is what surface::MeasuredTable says, to the precision of its floats; cells below the horizon
// are filled by the same rule. Rings without any cell are filled otherwise here: the table says 0.
TEST(Cells, BlendAsTablesInterpolate) {
  const Bins bins = {24, 18, 24};
  const Cells cells(bins);
  Random random(5);
  std::vector<float> values;
  for (std::size_t c = 0; c < cells.count(); ++c) values.push_back(static_cast<float>(random.uniform() * 0.1));
  io::MerlTable table{bins, {}};
  for (std::size_t place = 0; place < bins[0] * bins[1] * bins[2]; ++place) {
    const auto cell = cells.cell_of(place / bins[2] / bins[1], place / bins[2] % bins[1], place % bins[2]);
    for (int band = 0; band < 3; ++band) table.brdf_per_sr.push_back(cell == Cells::none ? -1 : values[cell]);
  }
  const surface::MeasuredTable measured(table, "t");
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto direction = [&] {
      const double z = random.uniform(0.1, 1), r = std::sqrt(1 - z * z), phi = random.uniform(0, 2 * pi);
      return Vec3{r * std::cos(phi), r * std::sin(phi), z};
    };
    const Vec3 wo = direction(), wi = direction();
    const auto blend = cells.blend(wo, wi);
    double f = 0, sum = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      f += blend.share[k] * values[blend.cell[k]];
      sum += blend.share[k];
    }
    ASSERT_NEAR(sum, 1, 1e-12);
    const double told = measured.evaluate(wo, wi).x;
    ASSERT_NEAR(f, told, 2e-6);
    ++compared;
  }
  EXPECT_EQ(compared, 4000);
}

}  // namespace
}  // namespace gonio::tests
