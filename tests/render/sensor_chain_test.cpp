// The links of a camera's chain, one by one; |z| < 4.5 where there is noise.
#include "render/sensor_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "camera/intrinsics.h"
#include "geom/vector.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "render/mechanisms/sensor_saturation.h"
#include "scene/mechanisms.h"

namespace gonio::render {
namespace {

using mechanism::Mechanism;
using mechanism::Target;

io::Image picture_of(int width, int height, std::uint64_t seed) {
  io::Image picture(width, height, {"R", "G", "B", "variance.R"});
  Random random(seed);
  for (float& v : picture.data) v = static_cast<float>(random.uniform(0.1, 2));
  return picture;
}
// With all Stokes components.
io::Image polarized_picture(int width, int height, std::uint64_t seed) {
  io::Image picture(width, height,
                    {"R", "G", "B", "s1.R", "s1.G", "s1.B", "s2.R", "s2.G", "s2.B", "s3.R", "s3.G", "s3.B"});
  Random random(seed);
  for (float& v : picture.data) v = static_cast<float>(random.uniform(0.1, 2));
  return picture;
}

manifest::Document document_with(const std::map<std::string, manifest::MechanismUse>& mechanisms) {
  manifest::Document document;
  camera::enter_pinhole(document, "cam", 64, 64, 64);
  manifest::ImageEntry image;
  image.id = "view";
  image.camera = "cam";
  image.exposure_s = 0.1;
  document.images.push_back(image);
  document.mechanisms = mechanisms;
  return document;
}
manifest::MechanismUse use(const manifest::Parameters& parameters, const std::vector<std::string>& on = {}) {
  return {.on = on, .parameters = parameters, .sigma = {}};
}
io::Image recorded_with(const io::Image& picture, const std::map<std::string, manifest::MechanismUse>& mechanisms,
                        const std::string& mosaic = "") {
  manifest::Document document = document_with(mechanisms);
  document.cameras.at("cam").mosaic = mosaic;
  return recorded(picture, sensor_of(document, 0), "view", 7);
}

// Of pictures, and not of board corners or robots alone.
bool concerns_pictures(const Mechanism& m) {
  const auto is_for = [&](const char* domain) { return std::ranges::find(m.domains, domain) != m.domains.end(); };
  return !is_for("boards") && !is_for("robot");
}

// Walks the registry: what is declared for cameras behind the lens is known, and vanishes where it says so. Defocus
// and what a camera's section states belong to the rays that are cast, and render says what it leaves out; lateral
// colour moves what the rays have brought.
TEST(SensorChain, EveryLinkVanishesAtNeutralAndActsOtherwise) {
  const io::Image coloured = picture_of(12, 9, 1), polarized = polarized_picture(12, 9, 1);
  const io::Image as_it_was = recorded_with(coloured, {}), behind = recorded_with(polarized, {}, "polarizers");
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 12; ++x)
      for (int c = 0; c < 3; ++c) ASSERT_EQ(as_it_was.at(x, y, c), coloured.at(x, y, c));
  int count = 0;
  for (const Mechanism* m : mechanism::all_mechanisms()) {
    const bool ours =
        (m->stage == "optics" || m->stage == "sensor") && m->target == Target::camera && concerns_pictures(*m);
    const bool of_rays = m->id == "optics.defocus" || m->id.starts_with("camera.");
    const bool elsewhere = of_rays || scene::beyond_rendering(*m);
    EXPECT_EQ(in_sensor_chain(*m), (ours && !elsewhere) || m->id == "lens.lateral-colour") << m->id;
    if (!in_sensor_chain(*m)) continue;
    ++count;
    const bool of_polarizers = m->domains.front() == "polarization";
    const io::Image &picture = of_polarizers ? polarized : coloured, &plain = of_polarizers ? behind : as_it_was;
    const auto recorded_with = [&](const io::Image& of, const std::map<std::string, manifest::MechanismUse>& uses) {
      return render::recorded_with(of, uses, of_polarizers ? "polarizers" : "");
    };
    manifest::Parameters neutral, other;
    for (const auto& p : m->parameters) {
      neutral[p.name] = p.neutral;
      other[p.name] = m->id == "lens.lateral-colour" || m->id == "sensor.hot-pixel" ? 0.5 * p.upper : p.start;
    }
    EXPECT_EQ(recorded_with(picture, {{m->id, use(neutral)}}).data, plain.data) << m->id;
    EXPECT_EQ(recorded_with(picture, {{m->id, use({})}}).data, plain.data) << m->id;
    EXPECT_EQ(recorded_with(picture, {{m->id, use(other, {"another"})}}).data, plain.data) << m->id;
    EXPECT_NE(recorded_with(picture, {{m->id, use(other)}}).data, plain.data) << m->id;
    other.begin()->second.value[0] = 1e12;
    EXPECT_THROW(recorded_with(picture, {{m->id, use(other)}}), Error) << m->id;
  }
  EXPECT_GE(count, 7);
}

TEST(SensorChain, LinksDoWhatTheirEquationsSay) {
  const io::Image picture = picture_of(40, 30, 2);
  std::array<double, 3> mean{};
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      for (int c = 0; c < 3; ++c) mean[c] += picture.at(x, y, c) / 1200.0;
  const auto value = [&](const std::string& id, const manifest::Parameters& parameters, int c) {
    return recorded_with(picture, {{id, use(parameters)}}).at(11, 7, c);
  };
  const double r = picture.at(11, 7, 0), g = picture.at(11, 7, 1), b = picture.at(11, 7, 2);
  EXPECT_NEAR(value("optics.veiling-glare", {{"share", 0.1}}, 1), g + 0.1 * mean[1], 1e-6);
  EXPECT_NEAR(value("sensor.crosstalk", {{"share", 0.1}}, 2), 0.8 * b + 0.1 * (r + g), 1e-6);
  EXPECT_NEAR(value("sensor.non-linearity", {{"quadratic", -0.2}, {"reference", 2.0}}, 0), r * (1 - 0.1 * r), 1e-6);
  EXPECT_NEAR(value("sensor.row-pattern", {{"amplitude", 0.2}, {"period_px", 28.0}, {"phase_rad", 0.0}}, 0), 1.2 * r,
              1e-6);
  EXPECT_NEAR(value("sensor.black-offset", {{"offset", -0.3}}, 0), r - 0.3, 1e-6);
  EXPECT_NEAR(value("sensor.saturation", {{"full_scale", 0.05}}, 0), 0.05, 1e-7);
  EXPECT_NEAR(value("sensor.saturation", {{"full_scale", 5.0}}, 0), r, 1e-7);
}

// Of 40,000 pixels one in fifty, always the same of a camera, in proportion to the exposure.
TEST(SensorChain, HotPixelsStayWhereTheyAreAndGrowWithTheExposure) {
  io::Image dark(200, 200, {"R", "G", "B"});
  Sensor sensor;
  sensor.camera = "a", sensor.mosaic = "RGGB", sensor.exposure_s = 2;
  sensor.switch_on(*mechanism::find_mechanism("sensor.hot-pixel"), {0.02, 0.5});
  const io::Image one = recorded(dark, sensor, "one", 1);
  sensor.exposure_s = 6;
  const io::Image longer = recorded(dark, sensor, "two", 1);
  double hot = 0, sum = 0;
  for (std::size_t i = 0; i < one.data.size(); ++i) {
    EXPECT_NEAR(longer.data[i], 3 * one.data[i], 1e-5f * (1 + longer.data[i]));
    hot += one.data[i] > 0, sum += one.data[i];
  }
  EXPECT_NEAR(hot, 800, 4.5 * std::sqrt(800 * 0.98));
  EXPECT_NEAR(sum / hot, 0.5 * 2, 4.5 / std::sqrt(800));
  sensor.camera = "b";
  EXPECT_NE(recorded(dark, sensor, "one", 1).data, one.data);
}

// One pixel of six times what it holds, green behind a grid: of the five parts that flow over each neighbour gets its
// share, whatever its filter, and what is read of it is cut off behind.
TEST(SensorChain, WhatAFullPixelCannotHoldFlowsToItsFourNeighbours) {
  io::Image flat(8, 8, {"R", "G", "B"});
  for (float& v : flat.data) v = 0.1f;
  flat.at(3, 4, 1) = 3;
  Sensor sensor;
  sensor.mosaic = "RGGB";
  sensor.switch_on(*mechanism::find_mechanism("sensor.saturation"), {0.5});
  sensor.switch_on(*mechanism::find_mechanism("sensor.blooming"), {0.02, 0.01, 0.5});
  const io::Image raw = recorded(flat, sensor, "raw", 1);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const int away = std::abs(x - 3) + std::abs(y - 4);
      const double wanted = away == 0 ? 0.5 : away > 1 ? 0.1 : x == 3 ? 0.1 + 0.02 * 2.5 : 0.1 + 0.01 * 2.5;
      EXPECT_NEAR(raw.at(x, y, 0), wanted, 1e-6) << x << " " << y;
    }
}

TEST(SensorChain, PrnuIsTheSameInEveryPictureOfACameraAndNoiseIsNot) {
  io::Image flat(200, 200, {"R", "G", "B"});
  for (float& v : flat.data) v = 1;
  Sensor sensor;
  sensor.camera = "a";
  sensor.switch_on(*mechanism::find_mechanism("sensor.prnu"), {0.02});
  const io::Image one = recorded(flat, sensor, "one", 1), two = recorded(flat, sensor, "two", 1);
  EXPECT_EQ(one.data, two.data);
  double square = 0;
  for (const float v : one.data) square += (v - 1.0) * (v - 1.0);
  const auto n = static_cast<double>(one.data.size());
  EXPECT_NEAR(square / n / 4e-4, 1, 4.5 * std::sqrt(2 / n));
  sensor.camera = "b";
  EXPECT_NE(recorded(flat, sensor, "one", 1).data, one.data);
  sensor.links.clear();
  sensor.noise = {.gain = 1000, .read = 0.01};
  EXPECT_NE(recorded(flat, sensor, "one", 1).data, recorded(flat, sensor, "two", 1).data);
}

// Photon noise goes with what the filter passes; offset and full scale come after it.
TEST(SensorChain, NoiseBehindAMosaicAndBeforeOffsetAndSaturation) {
  io::Image flat(256, 256, {"R", "G", "B"});
  for (std::size_t i = 0; i < flat.data.size(); ++i) flat.data[i] = 0.2f * static_cast<float>(1 + i % 3);
  Sensor sensor;
  sensor.mosaic = "GRBG";
  sensor.noise = {.gain = 500, .read = 0.01};
  sensor.switch_on(*mechanism::find_mechanism("sensor.black-offset"), {0.1});
  const io::Image raw = recorded(flat, sensor, "raw", 3);
  ASSERT_THAT(raw.channels, testing::ElementsAre("Y"));
  const std::array<double, 4> level = {0.4, 0.2, 0.6, 0.4};
  for (int f = 0; f < 4; ++f) {
    double sum = 0, square = 0;
    constexpr double n = 128 * 128;
    for (int y = f / 2; y < 256; y += 2)
      for (int x = f % 2; x < 256; x += 2) sum += raw.at(x, y, 0);
    const double mean = sum / n, variance = level[f] / 500 + 1e-4;
    for (int y = f / 2; y < 256; y += 2)
      for (int x = f % 2; x < 256; x += 2) square += std::pow(raw.at(x, y, 0) - mean, 2);
    EXPECT_NEAR(mean, level[f] + 0.1, 4.5 * std::sqrt(variance / n)) << f;
    EXPECT_NEAR(square / n / variance, 1, 4.5 * std::sqrt(2 / n) + 0.005) << f;
  }
  sensor.switch_on(*mechanism::find_mechanism("sensor.saturation"), {0.5});
  const io::Image clipped = recorded(flat, sensor, "raw", 3);
  for (const float v : clipped.data) ASSERT_LE(v, 0.5f);
}

// Against the mean of many readings that were noisy first and cut off then.
TEST(SaturationOfNoise, IsTheMeanOfWhatWasCutOff) {
  constexpr double full = 0.5, sigma = 0.02;
  Random random(3, 1);
  for (const double v : {0.3, 0.46, 0.49, 0.5, 0.52, 0.7}) {
    double sum = 0;
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i) sum += std::min(v + sigma * random.normal(), full);
    EXPECT_NEAR(equation::sensor_saturation_of_noise(v, full, sigma), sum / count, 4 * sigma / std::sqrt(count)) << v;
  }
  EXPECT_EQ(equation::sensor_saturation_of_noise(0.7, 0, sigma), 0.7);
  EXPECT_EQ(equation::sensor_saturation_of_noise(0.7, full, 0), full);
}

}  // namespace
}  // namespace gonio::render
