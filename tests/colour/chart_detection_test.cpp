// Charts in simulated photographs: found in any pose, read with honest covariance, and not seen where there is none.
#include "colour/chart_detection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "base/error.h"
#include "base/random.h"
#include "colour/chart_photograph.h"
#include "colour/patch_readings.h"
#include "stats/distributions.h"

namespace gonio::colour {
namespace {

using testing::HasSubstr;

constexpr int width = 640, height = 427;

const Chart& chart() {
  static const Chart classic = colorchecker_classic("after-2014", "test");
  return classic;
}

ChartSpecimen random_photograph(std::uint64_t seed) {
  Random random(seed, 3);
  ChartSpecimen p;
  p.pose = random_pose(chart(), width, height, seed);
  p.seed = seed, p.room = cluttered_room(seed, width, height);
  p.exposure = std::pow(10, random.uniform(-2, 2));
  const double change = random.uniform(0, 0.6), towards = random.uniform(0, 2 * pi);
  p.gradient = {change * std::cos(towards), change * std::sin(towards)};
  p.shot = p.exposure * std::pow(10, random.uniform(-4.5, -2.7)), p.read = 0.004 * p.exposure;
  p.blur_px = random.uniform(0.3, 1.5);
  if (random.uniform() < 0.5) p.camera_from_xyz = Mat3{{1.6, 0, 0, 0, 1, 0, 0, 0, 0.5}} * p.camera_from_xyz;
  return p;
}

// Largest distance of a patch's centre from where it is, over the patch's width.
double error_of(const ChartPose& found, const ChartPose& pose) {
  double most = 0;
  for (const Patch& patch : chart().patches) {
    const auto outline = outline_of(pose, patch, 1);
    most = std::max(most, norm(found.at(patch.centre) - pose.at(patch.centre)) / norm(outline[1] - outline[0]));
  }
  return most;
}

std::string refusal(const io::Image& picture, const Chart& wanted) {
  try {
    find_chart(picture, wanted, "photo");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.what();
  }
  return "found";
}

// Photographs of these seeds in which the chart was found; one that is found anywhere else fails the test.
int found_of(std::uint64_t first, std::uint64_t last) {
  int found = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const ChartSpecimen p = random_photograph(seed);
    try {
      const FoundChart chart_found = find_chart(photograph_of(chart(), p, width, height), chart(), "photo");
      EXPECT_LT(error_of(chart_found.pose, p.pose), 0.2) << seed;
      ++found;
    } catch (const Error& error) {
      std::printf("%d: %s\n", static_cast<int>(seed), error.what());
    }
  }
  return found;
}

TEST(Detection, FindsChartsInAnyPose) {
  EXPECT_GE(found_of(1, 60), 57);
}

// A minute or two: test_colour --gtest_also_run_disabled_tests --gtest_filter='*Hundred*'.
TEST(Detection, DISABLED_FindsFiveHundredCharts) {
  const int found = found_of(1000, 1499);
  std::printf("found %d of 500\n", found);
  EXPECT_GE(found, 475);
}

TEST(Detection, SeesNoneWhereThereIsNone) {
  ChartSpecimen p;
  p.pose = pose_from_corners({Vec2{-900, -900}, {-600, -900}, {-600, -700}, {-900, -700}}, "test");
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    p.room = cluttered_room(seed, width, height);
    EXPECT_THAT(refusal(photograph_of(chart(), p, width, height), chart()), HasSubstr("photo: shows no ")) << seed;
  }
}

// The same grid with other colours, and the mirror image, are no ColorChecker.
TEST(Detection, KnowsOtherChartsAndMirrors) {
  ChartSpecimen p = random_photograph(3);
  p.blur_px = 0.5, p.gradient = {};
  Chart other = chart();
  Random random(4);
  for (Patch& patch : other.patches) patch.xyz = Vec3{random.uniform(), random.uniform(), random.uniform()} * 0.8;
  EXPECT_THAT(refusal(photograph_of(other, p, width, height), chart()), HasSubstr("the best grid differs by"));
  const io::Image picture = photograph_of(chart(), p, width, height);
  ASSERT_EQ(refusal(picture, chart()), "found");
  io::Image mirrored = picture;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) mirrored.at(x, y, c) = picture.at(width - 1 - x, y, c);
  EXPECT_THAT(refusal(mirrored, chart()), HasSubstr("shows no colorchecker-24"));
}

// A chart of another make: any grid, by its colours alone.
TEST(Detection, TakesOtherGrids) {
  Chart grid = chart();
  grid.name = "nine by five", grid.columns = 9, grid.rows = 5, grid.patches.clear();
  Random random(11);
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 9; ++column) {
      Patch patch;
      patch.name = std::to_string(row) + "-" + std::to_string(column);
      patch.centre = {(column + 0.4) / 8.8, (row + 0.4) / 4.8}, patch.size = {0.8 / 8.8, 0.8 / 4.8};
      patch.xyz = Vec3{random.uniform(0.1, 0.8), random.uniform(0.1, 0.8), random.uniform(0.1, 0.8)};
      patch.lab = optics::lab_from_xyz(patch.xyz, optics::white_d50);
      grid.patches.push_back(patch);
    }
  grid.height_over_width = 4.8 / 8.8;
  ChartSpecimen p;
  p.pose = pose_from_corners({Vec2{520, 90}, {560, 390}, {330, 410}, {300, 70}}, "test");
  p.blur_px = 0.7, p.read = 0.004;
  const FoundChart found = find_chart(photograph_of(grid, p, width, height), grid, "photo");
  EXPECT_LT(norm(found.pose.at({0, 0}) - p.pose.at({0, 0})), 4);
  EXPECT_LT(norm(found.pose.at({1, 1}) - p.pose.at({1, 1})), 4);
  grid.columns = grid.rows = 0;
  EXPECT_THAT(refusal(photograph_of(grid, p, width, height), grid), HasSubstr("has no grid"));
}

TEST(Pose, GoesFromCornersAndBack) {
  const std::array<Vec2, 4> corners{Vec2{100, 50}, {600, 80}, {580, 400}, {90, 380}};
  const auto again = corners_of(pose_from_corners(corners, "test"));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(norm(again[i] - corners[i]), 1e-9);
  EXPECT_THROW(pose_from_corners({corners[0], corners[3], corners[2], corners[1]}, "test"), Error);
  EXPECT_THROW(pose_from_corners({corners[0], corners[2], corners[1], corners[3]}, "test"), Error);
  EXPECT_THROW(pose_from_corners({corners[0], corners[0], corners[0], corners[0]}, "test"), Error);
}

// Means over their stated sigma are standard normal: 24 patches of 25 photographs, three channels. Noise of pixels that
// are neighbours is shared, as behind a mosaic; dust covers some pixels.
TEST(Readings, HaveHonestCovariance) {
  double squares = 0, count = 0;
  ChartSpecimen p;
  p.pose = pose_from_corners({Vec2{60, 50}, {600, 70}, {580, 410}, {50, 390}}, "test");
  const io::Image clean = photograph_of(chart(), p, width, height);
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    Random random(seed);
    io::Image picture = clean;
    std::vector<float> noise(picture.data.size());
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<float>(0.01 * random.normal());
    for (std::size_t i = 3; i < noise.size(); ++i) picture.data[i] += (noise[i] + noise[i - 3]) / 2;
    for (int k = 0; k < 300; ++k)
      picture.at(static_cast<int>(random.below(width)), static_cast<int>(random.below(height)), 1) = 0;
    const auto readings = read_patches(picture, {}, p.pose, chart(), "photo");
    for (std::size_t k = 0; k < 24; ++k)
      for (int c = 0; c < 3; ++c)
        squares += std::pow(readings[k].rgb[c] - read_of(p, chart().patches[k])[c], 2) / readings[k].covariance(c, c),
            ++count;
  }
  // Student's t of 13 degrees of freedom: variance 13 / 11; known to 4 %.
  EXPECT_NEAR(squares / count, 13.0 / 11, 0.15);
}

TEST(Readings, NamePatchesThatCannotBeUsed) {
  ChartSpecimen p;
  p.pose = pose_from_corners({Vec2{60, 50}, {600, 70}, {580, 410}, {50, 390}}, "test");
  io::Image picture = photograph_of(chart(), p, width, height);
  std::vector<PixelState> states(picture.pixels(), PixelState::good);
  const auto mark = [&](std::size_t patch, PixelState state) {
    const Vec2 at = p.pose.at(chart().patches[patch].centre);
    for (int y = -30; y < 30; ++y)
      for (int x = -30; x < 30; ++x)
        states[static_cast<std::size_t>(std::lround(at.y) + y) * width +
               static_cast<std::size_t>(std::lround(at.x) + x)] = state;
  };
  mark(18, PixelState::clipped), mark(0, PixelState::masked);
  const Vec2 at = p.pose.at(chart().patches[7].centre);
  picture.at(static_cast<int>(at.x), static_cast<int>(at.y), 2) = std::numeric_limits<float>::quiet_NaN();
  const auto readings = read_patches(picture, states, p.pose, chart(), "photo");
  EXPECT_EQ(readings[18].left_out, "clipped");
  EXPECT_EQ(readings[0].left_out, "masked");
  EXPECT_EQ(readings[7].left_out, "not-finite");
  EXPECT_EQ(readings[1].left_out, "");
  EXPECT_THROW(read_patches(picture, {}, pose_from_corners({Vec2{-60, 50}, {600, 70}, {580, 410}, {50, 390}}, "test"),
                            chart(), "photo"),
               Error);
  EXPECT_THROW(read_patches(picture, {}, pose_from_corners({Vec2{60, 50}, {80, 50}, {80, 64}, {60, 64}}, "test"),
                            chart(), "photo"),
               Error);
}

}  // namespace
}  // namespace gonio::colour
