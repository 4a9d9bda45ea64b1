#include "alignment/segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "data.h"
#include "geom/vector.h"
#include "io/picture.h"

namespace gonio::alignment {
namespace {

constexpr int size = 96;
constexpr manifest::Noise camera{16000, 0.0005};
constexpr std::size_t pixels = static_cast<std::size_t>(size) * size;

// A ball (a disc with normals) on a plane under a lamp, seen from above, its shadow a disc that is shifted away from
// the lamp. 4x4 samples per pixel.
struct World {
  double x = 48, y = 48, radius = 18, hole = 0;  // of the ball, and of a hole through which the ground shows
  Vec3 albedo{0.7, 0.4, 0.3};
  double ambient = 0.06;
  double texture = 0;  // standard deviation of the logarithm of the ground's albedo
  bool ball = true;
};
struct Shown {
  io::Image picture{size, size, {"R", "G", "B"}};
  std::vector<Label> labels = std::vector<Label>(pixels, Label::ground);
  double object_area = 0;
};

Shown show(const World& world, Vec3 lamp, unsigned seed) {
  Shown shown;
  std::mt19937 pattern(5), random(seed);
  std::normal_distribution<double> normal;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double ground = 0.5 * std::exp(world.texture * normal(pattern));
      Vec3 sum{};
      int object = 0, shadow = 0;
      for (int k = 0; k < 16; ++k) {
        const double u = x + (k % 4 - 1.5) / 4, v = y + (k / 4 - 1.5) / 4;
        const double dx = u - world.x, dy = v - world.y, d = std::hypot(dx, dy), slope = 0.45 * world.radius / lamp.z;
        const Vec3 to_lamp = lamp - Vec3{u, v, 0};
        const double light = 2e4 * lamp.z / std::pow(norm(to_lamp), 3);
        if (world.ball && d < world.radius && d > world.hole) {
          const Vec3 up = normalized(Vec3{dx, dy, std::sqrt(world.radius * world.radius - d * d)});
          const double lit = std::max(0.0, dot(up, normalized(to_lamp))) * 2e4 / dot(to_lamp, to_lamp);
          sum += world.albedo * (1.4 * lit + world.ambient), ++object;
          continue;
        }
        const double sx = dx + slope * (lamp.x - 48), sy = dy + slope * (lamp.y - 48), s = std::hypot(sx, sy);
        const bool dark = world.ball && s < world.radius && s > world.hole;
        sum += Vec3{ground, ground, ground} * ((dark ? 0 : light) + world.ambient), shadow += dark;
      }
      const std::size_t p = static_cast<std::size_t>(y) * size + static_cast<std::size_t>(x);
      shown.labels[p] = object > 8 ? Label::object : 2 * shadow > 16 - object ? Label::shadow : Label::ground;
      shown.object_area += object / 16.0;
      for (int c = 0; c < 3; ++c) {
        const double value = sum[c] / 16;
        shown.picture.at(x, y, c) =
            static_cast<float>(value + normal(random) * std::hypot(std::sqrt(value / camera.gain), camera.read));
      }
    }
  return shown;
}

const Vec3 left{-20, 40, 90}, right{120, 30, 90}, upper{60, -20, 100};

double overlap(const Segmentation& found, const std::vector<Label>& truth, Label label) {
  double both = 0, either = 0;
  for (std::size_t p = 0; p < truth.size(); ++p) {
    both += found.labels[p] == label && truth[p] == label;
    either += found.labels[p] == label || truth[p] == label;
  }
  return both / either;
}
std::vector<Shown> shown_by_three(const World& world) {
  return {show(world, left, 1), show(world, right, 2), show(world, upper, 3)};
}
std::vector<io::Image> pictures_of(const std::vector<Shown>& shown) {
  std::vector<io::Image> pictures;
  for (const Shown& s : shown) pictures.push_back(s.picture);
  return pictures;
}
std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.what();
  }
  return "none";
}

void expect_found_by_lamps(const World& world, const manifest::Noise& noise, double object, double shadow) {
  const auto shown = shown_by_three(world);
  const auto found = segment_by_lamps(pictures_of(shown), noise, "ball");
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GT(overlap(found[k], shown[k].labels, Label::object), object) << k;
    EXPECT_GT(overlap(found[k], shown[k].labels, Label::shadow), shadow) << k;
    EXPECT_DOUBLE_EQ(found[k].certainty, 1) << k;
    double area = 0;
    for (const float share : found[k].object_share) area += static_cast<double>(share);
    EXPECT_NEAR(area, shown[k].object_area, 0.15 * 2 * pi * world.radius) << k;  // the rim lies within 0.15 px
  }
}

TEST(SegmentByLamps, FindsObjectAndShadows) {
  expect_found_by_lamps({}, camera, 0.98, 0.93);
}

TEST(SegmentByLamps, FindsAnObjectOfTheGroundsColour) {
  World grey;
  grey.albedo = {0.5, 0.5, 0.5};
  expect_found_by_lamps(grey, camera, 0.93, 0.85);
}

TEST(SegmentByLamps, MeasuresANoiseThatNobodyStates) {
  expect_found_by_lamps({}, {}, 0.98, 0.93);
}

TEST(SegmentByLamps, KeepsAHole) {
  World ring;
  ring.radius = 24, ring.hole = 9;
  const auto shown = shown_by_three(ring);
  const auto found = segment_by_lamps(pictures_of(shown), camera, "ring");
  EXPECT_GT(overlap(found[0], shown[0].labels, Label::object), 0.96);
  EXPECT_NE(found[0].labels[48 * size + 48], Label::object);
}

TEST(SegmentByLamps, SaysWhyThereIsNothing) {
  const auto shown = shown_by_three({});
  const auto pictures = pictures_of(shown);
  EXPECT_EQ(refusal([&] {
              segment_by_lamps({pictures.data(), 1}, camera, "a");
            }),
            "a: fewer than two pictures; give two or more, each under another lamp");
  const std::vector<io::Image> same{show({}, left, 1).picture, show({}, left, 7).picture};
  EXPECT_NE(refusal([&] { segment_by_lamps(same, camera, "a"); }).find("no two lamps differ"), std::string::npos);
  World bare;
  bare.ball = false;
  EXPECT_NE(refusal([&] { segment_by_lamps(pictures_of(shown_by_three(bare)), camera, "a"); }).find("no object"),
            std::string::npos);
  World cut;
  cut.x = 6;
  EXPECT_NE(
      refusal([&] { segment_by_lamps(pictures_of(shown_by_three(cut)), camera, "a"); }).find("meets the left border"),
      std::string::npos);
  std::vector<io::Image> sizes = pictures;
  sizes[1] = io::Image(8, 8, {"R", "G", "B"});
  EXPECT_NE(refusal([&] { segment_by_lamps(sizes, camera, "a"); }).find("another size"), std::string::npos);
}

TEST(SegmentByBackground, TellsShadowByTexture) {
  World world;
  world.texture = 0.15;
  World empty = world;
  empty.ball = false;
  const Shown shown = show(world, right, 1);
  const Segmentation found = segment_by_background(shown.picture, show(empty, right, 2).picture, camera, "ball");
  EXPECT_GT(overlap(found, shown.labels, Label::object), 0.84);
  EXPECT_GT(overlap(found, shown.labels, Label::shadow), 0.8);
}

TEST(SegmentByBackground, NeedsTheSamePlace) {
  EXPECT_NE(refusal([] {
              segment_by_background(show({}, left, 1).picture, io::Image(8, 8, {"R", "G", "B"}), camera, "a");
            }).find("another size"),
            std::string::npos);
}

TEST(SegmentAlone, LeavesTheDarkSideUnknownRatherThanGuess) {
  const Shown shown = show({}, right, 1);
  const Segmentation found = segment_alone(shown.picture, camera, "ball");
  double wrong = 0, things = 0, unknown = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    things += shown.labels[p] != Label::ground;
    wrong += found.labels[p] != Label::unknown && found.labels[p] != shown.labels[p];
    unknown += found.labels[p] == Label::unknown;
  }
  EXPECT_LT(wrong, 0.1 * things);
  EXPECT_LT(unknown, 0.35 * things);
  EXPECT_GT(overlap(found, shown.labels, Label::shadow), 0.65);
  EXPECT_NEAR(found.certainty, 1 - unknown / static_cast<double>(pixels), 1e-12);
}

TEST(SegmentAlone, RefusesBareGround) {
  World bare;
  bare.ball = false;
  EXPECT_NE(refusal([&] { segment_alone(show(bare, left, 1).picture, camera, "a"); }).find("no object"),
            std::string::npos);
}

TEST(SegmentByStrokes, FollowsThem) {
  const Shown shown = show({}, right, 1);
  std::vector<Label> strokes(pixels, Label::unknown);
  for (std::size_t i = 0; i < 24; ++i) {
    strokes[(36 + i) * size + 48] = strokes[48 * size + 36 + i] = Label::object;
  }
  for (std::size_t i = 4; i < size - 4; ++i) strokes[4 * size + i] = strokes[(size - 5) * size + i] = Label::ground;
  for (std::size_t y = 38; y < 60; ++y)
    strokes[y * size + 35] = strokes[y * size + 36] = Label::object;  // its dark side
  for (std::size_t y = 40; y < 60; ++y) strokes[y * size + 26] = strokes[y * size + 27] = Label::shadow;
  const Segmentation found = segment_by_strokes(shown.picture, strokes, "ball");
  EXPECT_GT(overlap(found, shown.labels, Label::object), 0.9);
  EXPECT_GT(overlap(found, shown.labels, Label::shadow), 0.85);
  EXPECT_EQ(found.labels, segment_by_strokes(shown.picture, strokes, "ball").labels);
  EXPECT_NE(refusal([&] {
              segment_by_strokes(shown.picture, std::vector<Label>(pixels, Label::unknown), "a");
            }).find("marked"),
            std::string::npos);
}

// Areas by projecting the mesh with 16x16 samples a pixel.
TEST(SegmentByLamps, FindsTheRecordedBunny) {
  GONIO_NEEDS_DATA("recordings/practice-1");
  constexpr double objects[]{3328, 3793, 2400}, perimeters[]{280, 260, 240};
  constexpr double shadows[3][3]{{1123, 590, 558}, {235, 1152, 366}, {2092, 155, 839}};
  for (std::size_t station = 0; station < 3; ++station) {
    std::vector<io::Image> pictures;
    for (int lamp = 0; lamp < 3; ++lamp)
      pictures.push_back(
          io::read_picture(tests::data("recordings/practice-1") /
                           ("image_0" + std::to_string(station) + "_0" + std::to_string(lamp) + ".exr")));
    const auto found = segment_by_lamps(pictures, camera, "practice-1");
    for (std::size_t lamp = 0; lamp < 3; ++lamp) {
      const auto& labels = found[lamp].labels;
      EXPECT_NEAR(static_cast<double>(std::count(labels.begin(), labels.end(), Label::object)), objects[station],
                  0.15 * perimeters[station]);
      EXPECT_NEAR(static_cast<double>(std::count(labels.begin(), labels.end(), Label::shadow)), shadows[station][lamp],
                  0.02 * shadows[station][lamp] + 25);
    }
  }
}

}  // namespace
}  // namespace gonio::alignment
