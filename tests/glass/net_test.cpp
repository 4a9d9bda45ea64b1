// What networks see of photographs, and whether a photograph is a mosaic of polarizers at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "data.h"
#include "glass/net/seen.h"
#include "glass/net/weights.h"
#include "io/picture.h"
#include "photograph/mosaic.h"
#include "photograph/raw_frame.h"
#include "render/mosaic.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Light {
  double s0, s1, s2;
};
// Behind [90 45; 135 0], by the definition of each axis, with noise of `noise` times the light.
io::Image mosaic_of(int width, int height, const std::function<Light(int, int)>& light, double noise = 0) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  io::Image picture(width, height, {"Y"});
  const int axes[2][2] = {{90, 45}, {135, 0}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Light l = light(x, y);
      const double a = axes[y % 2][x % 2] * M_PI / 180;
      const double value = (l.s0 + l.s1 * std::cos(2 * a) + l.s2 * std::sin(2 * a)) / 2;
      picture.at(x, y, 0) = static_cast<float>(value * (1 + noise * normal(random)));
    }
  return picture;
}
Light steep(int x, int y) {
  const double s0 = 1 + 0.02 * x + 0.03 * y;
  return {s0, 0.12 * s0, -0.05 * s0};
}

void expect_refused(const io::Image& picture, const char* mentions) {
  try {
    demand_mosaic(picture, "photograph.png");
    ADD_FAILURE() << "taken for a mosaic: " << mentions;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    EXPECT_THAT(error.what(), HasSubstr(mentions));
    EXPECT_THAT(error.what(), HasSubstr("photograph.png"));
  }
}

TEST(MosaicEvidence, IsTheDegreeOfPolarizationOverSlopesAndNoise) {
  for (const double noise : {0.0, 0.05}) {
    const MosaicEvidence found = mosaic_evidence(mosaic_of(200, 160, steep, noise));
    EXPECT_NEAR(found.polarization, 0.13, 0.01) << noise;
    EXPECT_LT(found.diagonals, 0.01) << noise;
    EXPECT_NO_THROW(demand_mosaic(mosaic_of(200, 160, steep, noise), "p"));
  }
}

TEST(MosaicEvidence, OtherPicturesAreRefused) {
  const auto unpolarized = [](int x, int y) { return Light{2 + std::sin(0.9 * x) * std::sin(1.1 * y), 0, 0}; };
  expect_refused(mosaic_of(200, 160, unpolarized), "nothing in it is polarized");
  expect_refused(mosaic_of(
                     200, 160,
                     [](int, int) {
                       return Light{1, 0, 0};
                     },
                     0.05),
                 "nothing in it is polarized");
  io::Image coloured(64, 64, {"R", "G", "B"});
  for (std::size_t i = 0; i < coloured.pixels(); ++i) {
    coloured.data[3 * i] = 0.5F, coloured.data[3 * i + 1] = 1, coloured.data[3 * i + 2] = 0.6F;
  }
  for (const char* filters : {"RGGB", "GRBG", "GBRG", "BGGR"})
    expect_refused(render::bayer_mosaic(coloured, filters), "is no mosaic of polarizers");
  // A mask: its edges look polarized as often as not.
  io::Image mask(32, 32, {"Y"});
  for (int y = 9; y < 23; ++y)
    for (int x = 5; x < 20; ++x) mask.at(x, y, 0) = 1;
  EXPECT_THROW(demand_mosaic(mask, "mask"), Error);
  EXPECT_THROW(demand_mosaic(io::Image(64, 64, {"Y"}), "dark"), Error);
}

// Cameras of others: two mosaics, a mosaic of colours, photographs without filters.
TEST(MosaicEvidence, TellsRecordedMosaicsFromOtherPhotographs) {
  GONIO_NEEDS_DATA("polarization/imx250mzr");
  GONIO_NEEDS_DATA("glass/cleargrasp_d435");
  for (const char* name : {"fruits_IMX250MZR.png", "camera_IMX250MZR.png"}) {
    const io::Image mosaic = io::read_picture(tests::data("polarization/imx250mzr") / name);
    EXPECT_NO_THROW(demand_mosaic(mosaic, name));
    const MosaicEvidence found = mosaic_evidence(mosaic);
    EXPECT_NEAR(found.diagonals, 0.02, 0.005) << name;  // sums that the sensor's own polarizers differ by
    // Scaled to a half it is a photograph of s0 alone.
    io::Image half(mosaic.width / 2, mosaic.height / 2, {"Y"});
    for (int y = 0; y < half.height; ++y)
      for (int x = 0; x < half.width; ++x)
        half.at(x, y, 0) = (mosaic.at(2 * x, 2 * y, 0) + mosaic.at(2 * x + 1, 2 * y, 0) +
                            mosaic.at(2 * x, 2 * y + 1, 0) + mosaic.at(2 * x + 1, 2 * y + 1, 0)) /
                           4;
    expect_refused(half, "is no mosaic of polarizers");
  }
  for (const char* name : {"000000080-transparent-rgb-img.jpg", "000000123-opaque-rgb-img.jpg"}) {
    const io::Image colours = io::read_picture(tests::data("glass/cleargrasp_d435") / name);
    expect_refused(render::luminance(colours), "is no mosaic of polarizers");
    expect_refused(render::bayer_mosaic(colours, "RGGB"), "is no mosaic of polarizers");
  }
}

TEST(Seen, IsStokesAndIntensitiesInMeanLight) {
  const io::Image mosaic = mosaic_of(32, 24, [](int, int) { return Light{3, 0.6, -0.3}; });
  Planes stokes = seen_of(mosaic, "stokes", 2, "p");
  ASSERT_EQ(stokes.channels, 3u);
  ASSERT_EQ(stokes.width, 16u);
  ASSERT_EQ(stokes.height, 12u);
  Planes behind = seen_of(mosaic, "intensities", 2, "p");
  ASSERT_EQ(behind.channels, 4u);
  in_mean_light(stokes, "stokes", "p"), in_mean_light(behind, "intensities", "p");
  const double stokes_expected[] = {1, 0.2, -0.1}, behind_expected[] = {0.6, 0.45, 0.4, 0.55};
  for (std::size_t i = 0; i < stokes.pixels(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(stokes.plane(c)[i], stokes_expected[c], 1e-5);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(behind.plane(c)[i], behind_expected[c], 1e-5);
  }
}

// The same light as a mosaic, as Stokes vectors of one band and of three.
TEST(Seen, IsTheSameHoweverThePhotographSaysIt) {
  const Light light{2, 0.5, 0.25};
  const io::Image mosaic = mosaic_of(16, 16, [&](int, int) { return light; });
  io::Image one(16, 16, {"Y", "s1.Y", "s2.Y"}),
      three(16, 16, {"R", "G", "B", "s1.R", "s1.G", "s1.B", "s2.R", "s2.G", "s2.B"});
  for (std::size_t i = 0; i < one.pixels(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = static_cast<float>(k == 0 ? light.s0 : k == 1 ? light.s1 : light.s2);
      one.data[3 * i + k] = value;
      for (std::size_t c = 0; c < 3; ++c) three.data[9 * i + 3 * k + c] = value;
    }
  for (const char* input : {"stokes", "intensities"}) {
    const Planes by_mosaic = seen_of(mosaic, input, 1, "p");
    for (const io::Image* picture : {&one, &three}) {
      const Planes other = seen_of(*picture, input, 1, "p");
      ASSERT_EQ(other.values.size(), by_mosaic.values.size());
      for (std::size_t i = 0; i < other.values.size(); ++i)
        EXPECT_NEAR(other.values[i], by_mosaic.values[i], 1e-5) << input;
    }
  }
  EXPECT_THROW(seen_of(mosaic, "rgb", 1, "p"), Error);
  EXPECT_THROW(seen_of(mosaic, "stokes", 17, "p"), Error);
  EXPECT_THROW(seen_of(io::Image(8, 8, {"R", "G", "B"}), "stokes", 1, "p"), Error);
  Planes dark{3, 1, 1, {0, 0, 0}};
  EXPECT_THROW(in_mean_light(dark, "stokes", "p"), Error);
}

TEST(Calibration, IsLinearBetweenLevels) {
  const Calibration c{{0.2, 0.6, 0.9}, {1, 3, 4}};
  EXPECT_DOUBLE_EQ(c.quantile(0.6), 3);
  EXPECT_DOUBLE_EQ(c.quantile(0.4), 2);
  EXPECT_DOUBLE_EQ(c.quantile(0.1), 1);
  EXPECT_DOUBLE_EQ(c.quantile(0.99), 4);
}

class Records : public testing::Test {
 protected:
  std::string good() const {
    return R"({"configuration": {"input": "stokes", "light": "bare", "loss": "scales", "levels": 4},
      "heads": ["mask", "depth", "front"], "size_px": [64, 48], "network_sha256": ")" +
           sha256("network") + R"(",
      "calibration": {"mask": {"temperature": 1.5}, "depth": {"levels": [0.5, 0.9], "quantiles": [1, 2]},
                      "front": {"levels": [0.5, 0.9], "quantiles": [1, 3]}}})";
  }
  void write(const std::string& record) const {
    write_file(folder_ / "run.json", record), write_file(folder_ / "network.onnx", "network");
  }
  void expect_refused(const std::string& from, const std::string& to, const char* mentions) const {
    std::string record = good();
    record.replace(record.find(from), from.size(), to);
    write(record);
    try {
      read_weights(folder_.path());
      ADD_FAILURE() << to;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_THAT(error.what(), HasSubstr(mentions));
      EXPECT_THAT(error.what(), HasSubstr("train it again"));
    }
  }
  const tests::ScratchFolder folder_;
};

TEST_F(Records, AreRead) {
  write(good());
  const Weights weights = read_weights(folder_.path());
  EXPECT_EQ(weights.input, "stokes");
  EXPECT_TRUE(weights.scales);
  EXPECT_EQ(step_of(weights), 8);
  EXPECT_EQ(weights.height_px, 48);
  EXPECT_DOUBLE_EQ(weights.temperature, 1.5);
  EXPECT_EQ(weights.calibration.size(), 2u);
  EXPECT_EQ(std::string(weights.network.begin(), weights.network.end()), "network");
}

TEST_F(Records, ThatDoNotFitAreRefused) {
  try {
    read_weights(folder_ / "nowhere");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::no_input);
    EXPECT_THAT(error.what(), HasSubstr("no weights of its own"));
  }
  expect_refused("\"stokes\"", "\"sound\"", "input");
  expect_refused("\"levels\": 4", "\"levels\": 40", "levels");
  expect_refused("\"mask\", \"depth\"", "\"depth\", \"mask\"", "heads");
  expect_refused("[64, 48]", "[64]", "size_px");
  expect_refused("1.5", "0", "temperature");
  expect_refused("[1, 3]", "[3, 1]", "quantiles");
  expect_refused("[1, 3]", "[1]", "as many");
  expect_refused("network_sha256\": \"", "network_sha256\": \"0", "is not the network");
}

}  // namespace
}  // namespace gonio::glass
