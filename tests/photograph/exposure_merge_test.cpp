// Exposures merged: bias, variance and chi-square over six decades, shutters that are off, things that moved.
#include "photograph/exposure_merge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.h"
#include "photograph/exposure_times.h"
#include "photograph/noise_variance.h"

namespace gonio::photograph {
namespace {

// A 12-bit sensor: shot noise, read noise, whole codes, nothing beyond full scale.
struct Sensor {
  double gain = 4.5, read = 2.2, black = 64, full = 4095;
  manifest::Noise noise() const { return {gain, std::sqrt(read * read + 1 / 12.0)}; }
  float operator()(double rate, double t, std::mt19937_64& random) const {
    const double electrons = rate * t * gain;
    const double caught = electrons < 1e6
                              ? static_cast<double>(std::poisson_distribution<long>(std::max(1e-9, electrons))(random))
                              : electrons;
    const double code = black + caught / gain + std::normal_distribution<double>(0, read)(random);
    return static_cast<float>(std::clamp(std::round(code), 0.0, full) - black);
  }
};

struct Stack {
  std::vector<double> stated_s, true_s;
  std::vector<double> rate;
  MergeRequest request;
  std::vector<std::vector<float>> codes;
};

// Rates over six decades, evenly in their logarithm, and eleven exposures from 1 to 1024 ms. `off`: of each exposure.
Stack stack(std::uint64_t seed, int width, int height, const std::vector<double>& off = {}, double least = 1,
            double most = 1e6) {
  Stack s;
  const Sensor sensor;
  std::mt19937_64 random(seed);
  for (int i = 0; i < width * height; ++i)
    s.rate.push_back(least * std::pow(most / least, (i + 0.5) / (width * height)));
  for (std::size_t k = 0; k < 11; ++k) {
    s.stated_s.push_back(1e-3 * std::pow(2.0, k));
    s.true_s.push_back(s.stated_s.back() * (off.empty() ? 1 : 1 + off[k]));
    s.codes.emplace_back();
    for (const double rate : s.rate) s.codes.back().push_back(sensor(rate, s.true_s.back(), random));
  }
  s.request = {.width = width,
               .height = height,
               .exposures_s = s.stated_s,
               .read = {},
               .noise = sensor.noise(),
               .full_scale = sensor.full - sensor.black - 0.5,
               .blooming_px = 0,
               .period_px = 1,
               .refine_exposures = false};
  return s;
}
MergedPlane merged(Stack& s) {
  s.request.read = [&s](std::size_t k) { return RawPlane{s.codes[k], {}}; };
  return merge_exposures(s.request);
}

TEST(ExposureMerge, HasNoBiasAndAHonestVarianceOverSixDecades) {
  Stack s = stack(1, 600, 200);
  const MergedPlane m = merged(s);
  constexpr std::size_t decades = 6, parts = 24;
  std::vector<double> off(parts), spread(parts), squares(parts), count(parts);
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    ASSERT_EQ(m.trust[i], Trust::good) << s.rate[i];
    const std::size_t part = i * parts / s.rate.size();
    const double error = m.rate[i] / s.rate[i] - 1;
    off[part] += error, spread[part] += error * error;
    squares[part] += std::pow(m.rate[i] - s.rate[i], 2) / m.variance[i], ++count[part];
  }
  for (std::size_t part = 0; part < parts; ++part) {
    EXPECT_LT(std::abs(off[part]), 1e-3 * count[part] + 4 * std::sqrt(spread[part]))
        << "decade " << static_cast<double>(part * decades) / parts;
    EXPECT_NEAR(squares[part] / count[part], 1, 0.05 + 4 * std::sqrt(2 / count[part])) << part;
  }
  EXPECT_NEAR(m.chi_square_per_freedom, 1, 0.05);
}

// Rates about those at which one exposure after the other saturates, half a standard deviation wide: where a rule that
// drops what saturated is wrong.
TEST(ExposureMerge, IsRightWhereSamplesAreAboutToSaturate) {
  const Sensor sensor;
  const double full = sensor.full - sensor.black, spread = std::sqrt(noise_variance(sensor.noise(), full)) / full;
  for (const double at : {-1.5, -0.5, 0.0, 0.5, 1.5}) {
    const double rate = full / 0.256 * (1 + at * spread);
    Stack s = stack(7, 300, 100, {}, rate, rate * (1 + 1e-9));
    const MergedPlane m = merged(s);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < s.rate.size(); ++i) {
      sum += m.rate[i] / s.rate[i] - 1;
      squares += std::pow(m.rate[i] - s.rate[i], 2) / m.variance[i];
    }
    const double n = static_cast<double>(s.rate.size());
    EXPECT_LT(std::abs(sum / n), 1e-3) << at;
    EXPECT_NEAR(squares / n, 1, 0.1) << at;
  }
}

TEST(ExposureMerge, FindsAShutterThatIsOff) {
  std::size_t covered = 0, asked = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    std::vector<double> off(11, 0.0);
    off[4] = 0.01;
    Stack s = stack(20 + seed, 200, 150, off);
    s.request.refine_exposures = true;
    const MergedPlane m = merged(s);
    // In the unit of one exposure that nobody knows: ratios to the one beside it.
    EXPECT_NEAR(m.exposures_s[4] / m.exposures_s[5] / (s.stated_s[4] / s.stated_s[5]), 1.01, 5e-4);
    EXPECT_NEAR(m.chi_square_per_freedom, 1, 0.05);
    for (std::size_t k = 0; k < 11; ++k) {
      if (m.exposures_sigma[k] == 0) continue;
      covered += std::abs(m.exposures_s[k] - s.true_s[k]) < 1.96 * m.exposures_sigma[k], ++asked;
    }
  }
  EXPECT_GE(covered, asked * 88 / 100) << asked;
}

// From a start that is wrong by two and by three.
TEST(ExposureMerge, TheStackTellsItsOwnNoise) {
  std::size_t covered = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Stack s = stack(60 + seed, 200, 100, {}, 10, 1e6);
    const manifest::Noise truth = s.request.noise;
    ExposureSamples samples{s.stated_s, s.codes, {2 * truth.gain, 3 * truth.read}, s.request.full_scale};
    for (auto& codes : samples.codes)
      for (float& v : codes)
        if (v >= samples.full_scale) v = std::nanf("");
    const auto found = noise_of_stack(samples);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->noise.gain / truth.gain, 1, 0.02);
    EXPECT_NEAR(found->noise.read / truth.read, 1, 0.02);
    covered += std::abs(found->noise.gain - truth.gain) < 1.96 * found->gain_sigma;
    covered += std::abs(found->noise.read - truth.read) < 1.96 * found->read_sigma;
  }
  EXPECT_GE(covered, 12u) << "of 16";  // fewer than that one time in a hundred, at 95 %
}

TEST(ExposureMerge, MarksWhatMoved) {
  Stack s = stack(3, 300, 200, {}, 100, 5e4);
  const Sensor sensor;
  std::mt19937_64 random(4);
  std::vector<char> moved(s.rate.size());
  for (std::size_t k = 6; k < 11; ++k)  // something dark came in while the longer ones were taken
    for (int y = 60; y < 120; ++y)
      for (int x = 100; x < 160; ++x) {
        const auto i = static_cast<std::size_t>(y * 300 + x);
        s.codes[k][i] = sensor(0.5 * s.rate[i], s.true_s[k], random), moved[i] = 1;
      }
  const MergedPlane m = merged(s);
  double found = 0, wrong = 0, all = 0;
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    all += moved[i];
    if (m.trust[i] == Trust::moved) (moved[i] ? found : wrong) += 1;
  }
  EXPECT_GE(found, 0.95 * all);
  EXPECT_LE(wrong, 0.01 * (static_cast<double>(s.rate.size()) - all));
  // There the value is of one of the two scenes, not of a mixture.
  double mixed = 0;
  for (std::size_t i = 0; i < s.rate.size(); ++i) {
    if (m.trust[i] != Trust::moved || !moved[i]) continue;
    const double sigma = std::sqrt(m.variance[i]);
    mixed += std::abs(m.rate[i] - s.rate[i]) > 5 * sigma && std::abs(m.rate[i] - 0.5 * s.rate[i]) > 5 * sigma;
  }
  EXPECT_LE(mixed, 0.001 * found);
}

// Against the rule sample by sample.
TEST(ExposureMerge, LightSpillsIntoNeighboursOfFullSamples) {
  constexpr int width = 37, height = 23;
  std::mt19937_64 random(9);
  for (const double share : {0.001, 0.05, 0.6}) {
    RawPlane plane{std::vector<float>(width * height), std::vector<std::uint8_t>(width * height)};
    for (std::size_t i = 0; i < plane.codes.size(); ++i) {
      plane.codes[i] = std::bernoulli_distribution(share)(random) ? 100.0f : 50.0f;
      plane.unusable[i] = std::bernoulli_distribution(0.05)(random);
    }
    for (const int reach : {0, 1, 3, 40}) {
      const std::vector<SampleKind> kinds = kinds_of(plane, width, height, 100, reach);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          bool near = false;
          for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
            for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u)
              near |= plane.codes[static_cast<std::size_t>(v * width + u)] >= 100;
          const auto i = static_cast<std::size_t>(y * width + x);
          const SampleKind wanted = plane.codes[i] >= 100            ? SampleKind::full
                                    : near || plane.unusable[i] != 0 ? SampleKind::unusable
                                                                     : SampleKind::read;
          ASSERT_EQ(kinds[i], wanted) << share << " " << reach << " " << x << " " << y;
        }
    }
  }
}

TEST(ExposureMerge, SaturatedSamplesAndTheirNeighboursAreNotUsed) {
  MergeRequest r{.width = 5,
                 .height = 1,
                 .exposures_s = {1, 2},
                 .read = {},
                 .noise = {10, 1},
                 .full_scale = 1000,
                 .blooming_px = 1,
                 .period_px = 1,
                 .refine_exposures = false};
  const std::vector<std::vector<float>> codes{{100, 300, 600, 300, 100}, {200, 700, 1000, 700, 200}};
  r.read = [&](std::size_t k) { return RawPlane{codes[k], {}}; };
  const MergedPlane m = merge_exposures(r);
  EXPECT_NEAR(m.rate[0], 100, 1e-3);
  EXPECT_NEAR(m.rate[1], 300, 1e-3);  // the longer one says 350: light spilled over
  EXPECT_NEAR(m.rate[2], 600, 0.1);
  EXPECT_EQ(m.last[0], 1);
  EXPECT_EQ(m.last[1], 0);
  EXPECT_EQ(m.last[2], 0);
  r.read = [&](std::size_t) { return RawPlane{{1000, 1000, 1000, 1000, 1000}, {}}; };
  EXPECT_EQ(merge_exposures(r).trust[2], Trust::too_bright);
  r.read = [&](std::size_t) { return RawPlane{codes[0], {1, 0, 0, 0, 0}}; };
  EXPECT_EQ(merge_exposures(r).trust[0], Trust::no_sample);
  r.read = [&](std::size_t k) { return RawPlane{std::vector<float>(5 - k), {}}; };
  EXPECT_THROW(merge_exposures(r), Error);
  r.exposures_s = {1, 0};
  EXPECT_THROW(merge_exposures(r), Error);
}

}  // namespace
}  // namespace gonio::photograph
