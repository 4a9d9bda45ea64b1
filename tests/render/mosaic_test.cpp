// Filters over pixels: where each lies, and what known states of polarization leave behind them.
#include "render/mosaic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "geom/vector.h"
#include "render/sensor_chain.h"

namespace gonio::render {
namespace {

io::Image colours(int width, int height) {  // R 1, G 2, B 3
  io::Image picture(width, height, {"B", "R", "G"});
  for (std::size_t i = 0; i < picture.data.size(); i += 3) {
    picture.data[i] = 3;
    picture.data[i + 1] = 1;
    picture.data[i + 2] = 2;
  }
  return picture;
}

TEST(Bayer, FiltersLieAsTheirNameSays) {
  const auto first_four = [](const std::string& mosaic) {
    const io::Image y = bayer_mosaic(colours(4, 4), mosaic);
    EXPECT_EQ(y.at(2, 2, 0), y.at(0, 0, 0));
    EXPECT_EQ(y.at(3, 1, 0), y.at(1, 1, 0));
    return std::array<float, 4>{y.at(0, 0, 0), y.at(1, 0, 0), y.at(0, 1, 0), y.at(1, 1, 0)};
  };
  EXPECT_THAT(first_four("RGGB"), testing::ElementsAre(1, 2, 2, 3));
  EXPECT_THAT(first_four("GRBG"), testing::ElementsAre(2, 1, 3, 2));
  EXPECT_THAT(first_four("GBRG"), testing::ElementsAre(2, 3, 1, 2));
  EXPECT_THAT(first_four("BGGR"), testing::ElementsAre(3, 2, 2, 1));
  EXPECT_THROW(bayer_mosaic(colours(2, 2), "RGBW"), Error);
}

TEST(Polarizers, KnownStates) {
  for (const double a : {0.0, 0.3, pi / 4, pi / 2, 2.0}) {
    EXPECT_NEAR(behind_polarizer(1, 0, 0, a), 0.5, 1e-15);                        // unpolarized: half
    EXPECT_NEAR(behind_polarizer(1, 1, 0, a), std::cos(a) * std::cos(a), 1e-15);  // Malus 1809
    const double t = 0.7, c = std::cos(a - t);
    EXPECT_NEAR(behind_polarizer(2, 2 * std::cos(2 * t), 2 * std::sin(2 * t), a), 2 * c * c, 1e-14);
  }
}

// Super-pixel [90 45; 135 0]; the four readings give the state back.
TEST(Polarizers, FourAnglesHoldTheLinearState) {
  io::Image stokes(4, 2, {"R", "G", "B", "s1.R", "s1.G", "s1.B", "s2.R", "s2.G", "s2.B"});
  for (std::size_t i = 0; i < stokes.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      stokes.data[9 * i + c] = 1.0f + static_cast<float>(c);
      stokes.data[9 * i + 3 + c] = 0.3f;
      stokes.data[9 * i + 6 + c] = -0.2f;
    }
  const io::Image mosaic = polarizer_mosaic(stokes);
  ASSERT_THAT(mosaic.channels, testing::ElementsAre("R", "G", "B"));
  for (int c = 0; c < 3; ++c)
    for (const int x : {0, 2}) {
      const double i90 = mosaic.at(x, 0, c), i45 = mosaic.at(x + 1, 0, c), i135 = mosaic.at(x, 1, c),
                   i0 = mosaic.at(x + 1, 1, c);
      EXPECT_NEAR(i0 + i90, 1 + c, 1e-6);
      EXPECT_NEAR(i45 + i135, 1 + c, 1e-6);
      EXPECT_NEAR(i0 - i90, 0.3, 1e-6);
      EXPECT_NEAR(i45 - i135, -0.2, 1e-6);
    }
  EXPECT_THROW(polarizer_mosaic(colours(2, 2)), Error);
  // A recording of such a camera has one channel.
  Sensor sensor;
  sensor.mosaic = "polarizers";
  const io::Image raw = recorded(stokes, sensor, "p", 1);
  ASSERT_THAT(raw.channels, testing::ElementsAre("Y"));
  const double y = 0.2126 * 1 + 0.7152 * 2 + 0.0722 * 3;
  EXPECT_NEAR(raw.at(1, 1, 0), (y + 0.3) / 2, 1e-6);
  EXPECT_NEAR(raw.at(1, 0, 0), (y - 0.2) / 2, 1e-6);
}

}  // namespace
}  // namespace gonio::render
