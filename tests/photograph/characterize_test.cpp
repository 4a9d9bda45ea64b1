// Figures of simulated sensors after EMVA 1288: right within 2 %, with intervals that cover, and untouched by an uneven
// lamp.
#include "photograph/characterize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.h"

namespace gonio::photograph {
namespace {

// Photons to codes of 12 bits: each sample with a sensitivity and an offset of its own, dark current, a well that is
// full.
struct Sensor {
  int side = 64;
  double gain = 0.2, read = 12, dark_per_s = 40, well = 17000, prnu = 0.01, dsnu = 6, black = 120;
  double falls_off = 0;   // of the lamp, from the middle to the corner
  double bends = 0;       // of the response, relative at the full well
  double rate = 1.7e6;    // electrons per second
  double flickers = 0;    // of the lamp, from frame to frame
  double ceiling = 4095;  // code
  std::string mosaic = "Mono";
};

class Made {
 public:
  Made(const Sensor& sensor, std::uint64_t seed) : s_(sensor), random_(seed) {
    std::normal_distribution<double> normal;
    for (int i = 0; i < s_.side * s_.side; ++i)
      sensitivity_.push_back(1 + s_.prnu * normal(random_)), offset_.push_back(s_.dsnu * normal(random_));
  }
  // Electrons of the middle, by light alone.
  double light(double t) const {
    const double e = s_.rate * t;
    return e * (1 - s_.bends * e / s_.well);
  }
  RawFrame frame(bool dark, double t) {
    RawFrame f{.width = s_.side, .height = s_.side, .mosaic = Mosaic::named(s_.mosaic, "test")};
    f.floor = -s_.black, f.full_scale = 4095 - s_.black - 0.5, f.full_code = 65535;
    std::normal_distribution<double> normal;
    const double lamp = dark ? 0 : light(t) * (1 + s_.flickers * normal(random_)), middle = (s_.side - 1) / 2.0;
    for (int y = 0; y < s_.side; ++y)
      for (int x = 0; x < s_.side; ++x) {
        const auto i = static_cast<std::size_t>(y * s_.side + x);
        const double r2 = (std::pow(x - middle, 2) + std::pow(y - middle, 2)) / (2 * middle * middle);
        const double mean = lamp * (1 - s_.falls_off * r2) * sensitivity_[i] + s_.dark_per_s * t;
        const double caught = std::min(s_.well, static_cast<double>(std::poisson_distribution<long>(mean)(random_)));
        const double code = s_.black + s_.gain * (caught + offset_[i] + s_.read * normal(random_));
        f.codes.push_back(static_cast<float>(std::clamp(std::round(code), 0.0, s_.ceiling) - s_.black));
      }
    return f;
  }
  SensorFigures figures(const std::vector<double>& lit, const std::vector<double>& dark, int dark_frames = 4) {
    SensorSeries series;
    for (const double t : lit)
      for (int k = 0; k < 2; ++k) series.frames.push_back({"lit", false, t});
    for (const double t : dark)
      for (int k = 0; k < dark_frames; ++k) series.frames.push_back({"dark", true, t});
    series.read = [&](std::size_t k) { return frame(series.frames[k].dark, series.frames[k].exposure_s); };
    return characterize(sum_series(series));
  }

 private:
  Sensor s_;
  std::mt19937_64 random_;
  std::vector<double> sensitivity_, offset_;
};

const std::vector<double> dark_times{0.001, 2, 5};
// 5 to 70 % of the full well of 10 ms, and finely about it.
std::vector<double> lit_times(double step = 0.02) {
  std::vector<double> times;
  for (const double share : {0.08, 0.2, 0.32, 0.44, 0.5, 0.62}) times.push_back(0.01 * share);
  for (double share = 0.8; share < 1.1; share += step) times.push_back(0.01 * share);
  return times;
}

// Mean, at the exposure with the largest temporal variance, of samples whose Gaussian shot noise is cut off at the
// well, over the spread of sensitivities: it lies below the well itself.
double most_varying(const Sensor& s) {
  double best = 0, place = 0;
  for (double share = 0.9; share < 1.05; share += 0.0005) {
    double mean = 0, variance = 0, weight = 0;
    for (double z = -4; z <= 4; z += 0.1) {
      const double m = share * s.well * (1 + s.prnu * z), sigma = std::sqrt(m), a = (s.well - m) / sigma,
                   p = std::exp(-0.5 * a * a) / std::sqrt(2 * M_PI), below = 0.5 * std::erfc(-a / std::sqrt(2)),
                   g = std::exp(-0.5 * z * z), first = m * below - sigma * p + s.well * (1 - below),
                   second = (m * m + m) * below - sigma * (m + s.well) * p + s.well * s.well * (1 - below);
      mean += g * first, variance += g * (second - first * first), weight += g;
    }
    if (variance / weight > best) best = variance / weight, place = mean / weight;
  }
  return place;
}

struct Truth {
  const char* name;
  double value;
};
std::vector<Truth> truths(const Sensor& s) {
  const double full = most_varying(s);
  const double least = std::sqrt(s.read * s.read + 1 / (12 * s.gain * s.gain) + 0.25) + 0.5;
  return {{"system gain", s.gain},
          {"read noise", s.read},
          {"read noise in codes", s.read * s.gain},
          {"dark current", s.dark_per_s},
          {"dark current by variance", s.dark_per_s},
          {"full well", full},
          {"clipping level", s.well},
          {"SNR max", std::sqrt(full)},
          {"sensitivity threshold", least},
          {"dynamic range", full / least},
          {"DSNU", s.dsnu},
          {"PRNU", 100 * s.prnu}};
}

TEST(Characterize, FiguresOfASimulatedSensorAreRight) {
  for (const double falls_off : {0.0, 0.3}) {
    Sensor sensor{.side = 256, .falls_off = falls_off};
    if (falls_off > 0) sensor.flickers = 0.002;
    const SensorFigures f = Made(sensor, 3).figures(lit_times(), dark_times);
    ASSERT_EQ(f.planes.size(), 1u);
    for (const Truth& t : truths(sensor)) {
      // Corners fill later than the middle: there is no one exposure at which the sensor is full.
      if (falls_off > 0 && (std::string(t.name) == "full well" || std::string(t.name) == "SNR max" ||
                            std::string(t.name) == "dynamic range" || std::string(t.name) == "clipping level"))
        continue;
      const SensorFigure* found = f.planes[0].find(t.name);
      ASSERT_NE(found, nullptr) << t.name;
      EXPECT_NEAR(found->value, t.value, std::max(0.02 * t.value, 2 * found->sigma)) << t.name;
      EXPECT_LT(found->sigma, 0.02 * t.value) << t.name;
    }
    EXPECT_NEAR(f.codes.gain, 5, 0.1);
    EXPECT_NEAR(f.codes.read, std::sqrt(2.4 * 2.4 + 1 / 12.0), 0.05);
    EXPECT_DOUBLE_EQ(f.unit.gain, f.codes.gain * 65535);
    EXPECT_DOUBLE_EQ(f.unit.read, f.codes.read / 65535);
  }
}

TEST(Characterize, IntervalsCover) {
  const Sensor sensor;
  constexpr int sensors = 120;
  const std::vector<Truth> truth = truths(sensor);
  std::vector<int> covered(truth.size());
  int above = 0;
  for (int k = 0; k < sensors; ++k) {
    const SensorFigures f = Made(sensor, 1000 + k).figures(lit_times(), dark_times);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const SensorFigure* found = f.planes[0].find(truth[i].name);
      ASSERT_NE(found, nullptr) << truth[i].name;
      covered[i] += found->lower <= truth[i].value && truth[i].value <= found->upper;
    }
    above += f.planes[0].find("system gain")->value > sensor.gain;
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::string name = truth[i].name;
    EXPECT_GE(covered[i], 0.90 * sensors) << name;  // P(fewer | 0.95) = 0.7 %
    // The place of the full well is known to the exposures' distance alone, which is no random number.
    const bool by_place = name == "full well" || name == "SNR max" || name == "dynamic range";
    if (!by_place) {
      EXPECT_LE(covered[i], 0.99 * sensors) << name;
    }
  }
  EXPECT_NEAR(above, sensors / 2, 3 * std::sqrt(sensors / 4.0));  // no bias
}

// Mean deviation from the line of least relative squares, of exposures that a bent response makes.
double true_linearity_error(const Made& made, const std::vector<LevelFigures>& lit) {
  double s = 0, st = 0, stt = 0, sy = 0, sty = 0;
  std::vector<double> t, y;
  for (const LevelFigures& level : lit) {
    if (level.off_line == 0) continue;
    const double time = level.exposure_s, e = made.light(time);
    t.push_back(time), y.push_back(e);
    const double a = 1 / e, b = time / e;
    s += a * a, st += a * b, stt += b * b, sy += a, sty += b;
  }
  const double d = s * stt - st * st, a = (sy * stt - sty * st) / d, b = (s * sty - st * sy) / d;
  double sum = 0;
  for (std::size_t k = 0; k < t.size(); ++k) sum += std::abs(y[k] / (a + b * t[k]) - 1);
  return 100 * sum / static_cast<double>(t.size());
}

TEST(Characterize, ABentResponseIsSeen) {
  std::vector<double> times = lit_times();
  for (double& t : times) t *= 1.1;
  int covered = 0;
  for (int k = 0; k < 20; ++k) {
    const Sensor sensor{.side = 64, .bends = 0.08};
    Made made(sensor, 70 + k);
    const SensorFigures f = made.figures(times, dark_times);
    const SensorFigure* found = f.planes[0].find("linearity error");
    ASSERT_NE(found, nullptr);
    const double truth = true_linearity_error(made, f.planes[0].lit);
    EXPECT_GT(truth, 0.3);
    EXPECT_NEAR(found->value, truth, 0.05 * truth);
    covered += found->lower <= truth && truth <= found->upper;
  }
  EXPECT_GE(covered, 16);  // P(fewer | 0.95) = 0.3 %
  Made straight(Sensor{.side = 128}, 5);
  EXPECT_LT(straight.figures(lit_times(), dark_times).planes[0].find("linearity error")->value, 0.1);
}

TEST(Characterize, EveryColourOfAMosaicIsASensorOfItsOwn) {
  Sensor sensor{.side = 128, .mosaic = "GRBG"};
  const SensorFigures f = Made(sensor, 8).figures(lit_times(0.04), dark_times);
  ASSERT_EQ(f.planes.size(), 4u);
  EXPECT_EQ(f.planes[0].name, "G1");
  EXPECT_EQ(f.planes[1].name, "R");
  EXPECT_EQ(f.planes[2].name, "B");
  EXPECT_EQ(f.planes[3].name, "G2");
  for (const PlaneFigures& p : f.planes) {
    const SensorFigure* k = p.find("system gain");
    EXPECT_NEAR(k->value, sensor.gain, 4 * k->sigma);
  }
}

TEST(Characterize, WhatASeriesDoesNotTellIsLeftOutAndSaid) {
  using testing::Contains;
  using testing::HasSubstr;
  const std::vector<double> few{0.001, 0.003};
  const PlaneFigures short_series = Made({}, 4).figures(few, {0.001}).planes[0];
  for (const char* name : {"dark current", "full well", "SNR max", "dynamic range", "linearity error"}) {
    EXPECT_EQ(short_series.find(name), nullptr);
    EXPECT_THAT(short_series.left_out, Contains(HasSubstr(name)));
  }
  EXPECT_NE(short_series.find("system gain"), nullptr);
  const PlaneFigures quiet = Made({.read = 1, .dsnu = 0}, 4).figures(few, {0.001}).planes[0];
  EXPECT_THAT(quiet.left_out, Contains(HasSubstr("hidden by rounding")));
  const PlaneFigures cut = Made({.black = 2}, 4).figures(few, {0.001}).planes[0];
  EXPECT_THAT(cut.left_out, Contains(HasSubstr("raise black")));
  // No fixed pattern at all: the interval reaches down to none.
  const PlaneFigures even = Made({.prnu = 0, .dsnu = 0}, 6).figures(few, {0.001}).planes[0];
  EXPECT_EQ(even.find("PRNU")->lower, 0);
  EXPECT_LT(even.find("PRNU")->upper, 0.5);
}

// Converters that end below the full scale that is stated: full samples all say the same, and are no copies.
TEST(Characterize, FullSamplesNeedNoNoise) {
  const Sensor sensor{.side = 128, .ceiling = 3300};
  const PlaneFigures f = Made(sensor, 5).figures(lit_times(), dark_times).planes[0];
  ASSERT_NE(f.find("clipping level"), nullptr);
  EXPECT_NEAR(f.find("clipping level")->value, (sensor.ceiling - sensor.black) / sensor.gain, 0.02 * sensor.well);
  EXPECT_LT(f.find("full well")->value, f.find("clipping level")->value);
}

// A pattern of columns with a period of four samples stands out at a quarter of a period per sample.
TEST(Characterize, SpectrogramsShowPeriodicPatterns) {
  Sensor sensor{.side = 64};
  Made made(sensor, 9);
  SensorSeries series;
  for (const double t : {0.002, 0.005})
    for (int k = 0; k < 4; ++k) series.frames.push_back({"lit", false, t});
  for (int k = 0; k < 4; ++k) series.frames.push_back({"dark", true, 0.002});
  series.read = [&](std::size_t k) {
    RawFrame f = made.frame(series.frames[k].dark, series.frames[k].exposure_s);
    for (int i = 0; i < 64 * 64; ++i) f.codes[static_cast<std::size_t>(i)] += i % 4 == 0 ? 8 : 0;
    return f;
  };
  const PlaneFigures p = characterize(sum_series(series)).planes[0];
  ASSERT_EQ(p.dark_rows.size(), 32u);
  const double white = std::hypot(p.dark_white, sensor.dsnu);
  EXPECT_GT(p.dark_rows[15], 8 * white);
  EXPECT_NEAR(p.dark_rows[7], white, 0.2 * white);
  EXPECT_NEAR(p.dark_columns[15], p.dark_columns[7], 0.5 * p.dark_columns[7]);
}

}  // namespace
}  // namespace gonio::photograph
