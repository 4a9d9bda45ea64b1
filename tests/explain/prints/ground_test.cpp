// print.ground-noise: what a printer adds at random, between two maps and within one.
#include "explain/prints/ground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "explain/prints/sample.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/print.h"
#include "print/mechanisms/print_ground_noise.h"

namespace gonio::explain::tests {
namespace {

using namespace prints;
constexpr double um = 1e-6;

// White noise under a Gaussian of so many points, of a root mean square of 1 in the whole.
std::vector<double> rough(int wide, int high, double sigma, std::uint64_t seed) {
  Random random(seed, 9);
  std::vector<double> white, field;
  for (int k = 0; k < wide * high; ++k) white.push_back(random.normal());
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  for (const bool along : {true, false}) {
    field.assign(white.size(), 0.0);
    for (int y = 0; y < high; ++y)
      for (int x = 0; x < wide; ++x)
        for (int d = -reach; d <= reach; ++d) {
          const int i = along ? (x + d + wide) % wide : x, j = along ? y : (y + d + high) % high;
          field[y * wide + x] += std::exp(-0.5 * d * d / (sigma * sigma)) * white[j * wide + i];
        }
    white = field;
  }
  double squares = 0;
  for (const double v : field) squares += v * v;
  for (double& v : field) v /= std::sqrt(squares / field.size());
  return field;
}

// Two prints of the sample, each with a ground of its own, or a single one.
PrintsInput prints_of(const Sent& sent, double rms_m, double sigma_points, int maps, std::uint64_t seed) {
  PrintsInput input = measured(sent, stated(sent), 0.4e-6, seed);
  if (maps > 1) input.maps.push_back(measured(sent, stated(sent), 0.4e-6, seed + 100).maps[0]);
  for (std::size_t m = 0; m < input.maps.size(); ++m) {
    io::HeightMap& map = input.maps[m].map;
    const std::vector<double> ground = rough(map.width, map.height, sigma_points, seed + 1000 * (m + 1));
    for (std::size_t i = 0; i < map.z_m.size(); ++i) map.z_m[i] += rms_m * ground[i];
  }
  return input;
}

// Two points for each pixel: a kernel of three points makes a covariance that falls with sqrt(2) 1.5 pixels.
TEST(Ground, IsFoundBetweenTwoPrints) {
  const Sent sent = sample();
  const PrintsInput input = prints_of(sent, 0.8 * um, 3, 2, 3);
  const auto ground = ground_of(sent, readings_of(input), 0);
  ASSERT_TRUE(ground);
  EXPECT_TRUE(ground->between_maps);
  EXPECT_LT(ground->p, 1e-6);
  EXPECT_LT(std::abs(std::log(ground->rms_um / 0.8)), 3 * ground->log_rms_sigma);
  EXPECT_LT(std::abs(std::log(ground->length_px / (std::sqrt(2.0) * 1.5))), 3 * ground->log_length_sigma);
  EXPECT_LT(ground->log_rms_sigma, 0.2);
  EXPECT_NEAR(ground->noise_um, 0.2, 0.05);
}

// Of a single print, where a wide field is even.
TEST(Ground, IsFoundWithinEvenFields) {
  Sent sent = sample();
  for (std::vector<float>& layer : sent.layers) std::fill(layer.begin(), layer.end(), 1.0f);
  const auto ground = ground_of(sent, readings_of(prints_of(sent, 0.8 * um, 3, 1, 4)), 0);
  ASSERT_TRUE(ground);
  EXPECT_FALSE(ground->between_maps);
  EXPECT_LT(ground->p, 1e-6);
  EXPECT_LT(std::abs(std::log(ground->rms_um / 0.8)), 3 * ground->log_rms_sigma);
}

// Patterns leave a single map without a field to ask.
TEST(Ground, IsNotAskedOfPatternsAlone) {
  const Sent sent = sample();
  EXPECT_FALSE(ground_of(sent, readings_of(prints_of(sent, 0, 3, 1, 5)), 0));
}

// The instrument's noise alone: p is at least a chance's, so that more than three of sixteen below a twentieth come in
// less than one run of a hundred.
TEST(Ground, IsNotSeenInTheInstrumentsNoise) {
  const Sent sent = sample();
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed)
    alarms += ground_of(sent, readings_of(prints_of(sent, 0, 3, 2, 20 + seed)), 0)->p < 0.05;
  EXPECT_LE(alarms, 3);
}

TEST(Ground, IsNamedAndWritten) {
  const auto problem = prints_problem(prints_of(sample(), 0.8 * um, 3, 2, 6));
  const Explanation e = explain(*problem, {.negative_controls = 4});
  ASSERT_EQ(e.named.size(), 1U) << e.sentence;
  EXPECT_EQ(problem->candidates()[e.named[0]].id(), mechanism::print_ground_noise().id);
  manifest::Document document;
  document.prints["p"].layer_m = 20e-6;
  problem->apply(e, document);
  const manifest::MechanismUse& use = document.mechanisms.at(mechanism::print_ground_noise().id);
  EXPECT_NEAR(use.parameters.at("rms_m").value.at(0), 0.8 * um, 3 * use.sigma.at("rms_m").at(0));
  EXPECT_EQ(use.on, std::vector<std::string>{"p"});
}

}  // namespace
}  // namespace gonio::explain::tests
