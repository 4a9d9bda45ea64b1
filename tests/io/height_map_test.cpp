// Height maps: what the instruments' files hold, a round trip, and damaged files.
#include "io/height_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/little_endian.h"
#include "io/random_map.h"

namespace gonio::io {
namespace {

std::string refusal(std::string_view bytes) {
  try {
    parse_height_map(bytes, "t.sur");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.problem();
  }
  return "none";
}

// Sq: root mean square about the mean; Sa: mean of the amounts. About a plane where `levelled`.
struct Roughness {
  double sa = 0, sq = 0;
};
Roughness roughness(const HeightMap& map, bool levelled) {
  const double cx = 0.5 * (static_cast<double>(map.width) - 1), cy = 0.5 * (static_cast<double>(map.height) - 1);
  double n = 0, mean = 0, zx = 0, zy = 0, xx = 0, yy = 0;
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      const double z = map.at(x, y);
      if (!std::isfinite(z)) continue;
      const double u = static_cast<double>(x) - cx, v = static_cast<double>(y) - cy;
      n += 1, mean += z, zx += z * u, zy += z * v, xx += u * u, yy += v * v;
    }
  mean /= n;
  const double slope_x = levelled ? zx / xx : 0, slope_y = levelled ? zy / yy : 0;
  Roughness r;
  for (std::size_t y = 0; y < map.height; ++y)
    for (std::size_t x = 0; x < map.width; ++x) {
      const double z =
          map.at(x, y) - mean - slope_x * (static_cast<double>(x) - cx) - slope_y * (static_cast<double>(y) - cy);
      if (!std::isfinite(z)) continue;
      r.sa += std::abs(z) / n, r.sq += z * z / n;
    }
  r.sq = std::sqrt(r.sq);
  return r;
}

// What another program says of the same files, to the digits that it prints.
TEST(HeightMap, RecordedFilesHaveTheRoughnessThatAnotherProgramFinds) {
  GONIO_NEEDS_DATA("surface");
  const HeightMap one = read_height_map(tests::data("surface/test_1.opd")),
                  two = read_height_map(tests::data("surface/test_2.opd")),
                  three = read_height_map(tests::data("surface/test_1.nms")),
                  disc = read_height_map(tests::data("surface/test_uncompressed.sur"));
  EXPECT_EQ(one.width, 736u);
  EXPECT_EQ(one.height, 480u);
  EXPECT_NEAR(one.step_x_m, 1.634e-6, 1e-9);
  EXPECT_NEAR(one.step_y_m, 1.907e-6, 1e-9);
  EXPECT_NEAR(roughness(one, false).sa, 1.594e-6, 1e-9);
  EXPECT_NEAR(roughness(one, false).sq, 1.927e-6, 1e-9);
  EXPECT_NEAR(roughness(two, false).sa, 0.921e-6, 1e-9);
  EXPECT_NEAR(roughness(two, false).sq, 1.165e-6, 1e-9);
  EXPECT_NEAR(three.step_x_m, 0.3125e-6, 1e-12);
  EXPECT_NEAR(roughness(three, false).sq, 0.719e-6, 1e-9);
  EXPECT_NEAR(roughness(three, true).sq, 0.0335e-6, 1e-9);
  EXPECT_NEAR(disc.step_x_m, 19.6e-9, 0.05e-9);
  EXPECT_NEAR(roughness(disc, false).sq, 0.1192e-6, 1e-10);
  EXPECT_NEAR(roughness(disc, true).sq, 0.0557e-6, 1e-10);
}

TEST(HeightMap, SurfRoundTrip) {
  const tests::ScratchFolder folder;
  const HeightMap map = random_map();
  write_surf(folder / "m.sur", map);
  const HeightMap back = read_height_map(folder / "m.sur");
  ASSERT_EQ(back.width, 7u);
  ASSERT_EQ(back.height, 5u);
  EXPECT_NEAR(back.step_x_m / 2e-6, 1, 1e-7);
  EXPECT_NEAR(back.step_y_m / 3e-6, 1, 1e-7);
  for (std::size_t i = 0; i < 35; ++i) {
    if (i == 8)
      EXPECT_TRUE(std::isnan(back.z_m[i]));
    else
      EXPECT_NEAR(back.z_m[i], map.z_m[i], 1e-14);
  }
}

TEST(HeightMap, DamagedFilesAreRefusedBeforeTheyAreBelieved) {
  const tests::ScratchFolder folder;
  write_surf(folder / "m.sur", random_map());
  const std::string good = read_file(folder / "m.sur");
  for (const std::size_t length : {std::size_t{0}, std::size_t{12}, std::size_t{511}, good.size() - 1})
    EXPECT_NE(refusal(good.substr(0, length)), "none") << length;
  const auto changed = [&](std::size_t place, auto value) {
    std::string bytes = good;
    store_at(bytes, place, value);
    return refusal(bytes);
  };
  EXPECT_THAT(changed(108, std::int32_t{-7}), testing::HasSubstr("claims -7 x 5 points"));
  EXPECT_THAT(changed(112, std::int32_t{30000}), testing::HasSubstr("bytes where its head asks for"));
  EXPECT_THAT(changed(98, std::int16_t{24}), testing::HasSubstr("points of 24 bits"));
  EXPECT_THAT(changed(120, 0.0f), testing::HasSubstr("no step between points along x"));
  EXPECT_THAT(changed(334, std::int16_t{-1}), testing::HasSubstr("comment of negative length"));
  EXPECT_THAT(refusal("DIGITAL WATCH of 1991"), testing::HasSubstr("is no height map that gonio reads"));
}

// Every beginning of a recorded file is refused or read, never believed beyond its end.
TEST(HeightMap, CutFilesOfEveryFormatAreRefused) {
  GONIO_NEEDS_DATA("surface");
  for (const char* name : {"surface/test_1.opd", "surface/test_1.nms", "surface/test_uncompressed.sur"}) {
    const std::string bytes = read_file(tests::data(name));
    for (const std::size_t length : {20ul, 100ul, 600ul, 4000ul, 6010ul, 100000ul})
      EXPECT_NE(refusal(std::string_view(bytes).substr(0, length)), "none") << name << " " << length;
  }
}

}  // namespace
}  // namespace gonio::io
