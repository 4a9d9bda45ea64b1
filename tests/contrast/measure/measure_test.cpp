// Contrast measured in rendered photographs of a data matrix of micro-ridges, against the surfaces that were rendered.
// The world is made once for the tests of this file; seeds are fixed.
// One process: Measure.*
#include "contrast/measure/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "data.h"
#include "manifest/document.h"
#include "sample_world.h"
#include "stats/distributions.h"

namespace gonio::contrast {
namespace {

struct Made {
  tests::ScratchFolder folder;
  tests::SampleWorld world = tests::data_matrix_world("DTU", 4, 5);
  manifest::Document document = tests::photographed(world, folder.path());
  Measured measured = measure(document, "", {}, {});
};
const Made& made() {
  static const Made instance;
  return instance;
}

std::size_t tilt_of(const MeasuredView& view) {
  return static_cast<std::size_t>(std::stoi(view.image.substr(view.image.rfind('-') + 1)));
}

// 18 intervals of 99.9 %: all hold in 98 % of such worlds.
TEST(Measure, ContrastsLieInTheirIntervals) {
  const auto& [folder, world, document, measured] = made();
  ASSERT_EQ(measured.views.size(), 18u);
  for (const MeasuredView& view : measured.views) {
    const double truth = tests::true_michelson(world, view.placement, tilt_of(view));
    EXPECT_LT(std::abs(view.michelson.value - truth),
              stats::student_quantile(0.9995, view.degrees) * view.michelson.sigma)
        << view.image << ": " << view.michelson.value << " +- " << view.michelson.sigma << ", true " << truth;
    EXPECT_LT(view.michelson.sigma, 0.02);
  }
}

TEST(Measure, TheSignTurnsWithTheSample) {
  const Measured& m = made().measured;
  EXPECT_GT(m.mean_michelson(0).value, 10 * m.mean_michelson(0).sigma);
  EXPECT_LT(m.mean_michelson(1).value, -10 * m.mean_michelson(1).sigma);
  ASSERT_TRUE(m.turn_rad);
  EXPECT_NEAR(std::abs(*m.turn_rad), pi / 2, 0.01);
  EXPECT_EQ(m.turns.size(), 9u);
  for (const Turn& turn : m.turns) EXPECT_EQ(tilt_of(m.views[turn.before]), tilt_of(m.views[turn.after]));
}

TEST(Measure, PlantedDefectsAreFoundAndNoOthers) {
  const auto& [folder, world, document, measured] = made();
  std::vector<std::size_t> found;
  for (const CellDefect& defect : measured.defects.found) found.push_back(defect.cell);
  EXPECT_THAT(found, testing::UnorderedElementsAreArray(world.defects));
}

TEST(Measure, TheCodeIsRead) {
  const Measured& m = made().measured;
  ASSERT_TRUE(m.code);
  EXPECT_EQ(m.code->text, "DTU");
  EXPECT_EQ(m.code->quarter_turns, 0);
  EXPECT_FALSE(m.code->inverted);
}

}  // namespace
}  // namespace gonio::contrast
