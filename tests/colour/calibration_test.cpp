// Corrections from readings: what is found of light and offset, how honest the covariance is, and recorded patches.
#include "colour/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "geom/mat3_inverse.h"
#include "optics/spectrum.h"

namespace gonio::colour {
namespace {

constexpr Mat3 camera{{0.55, 0.4, 0.05, 0.15, 0.9, -0.05, 0.02, 0.1, 0.7}};

PatchReading reading(Rgb rgb, double sigma) {
  const double v = sigma * sigma;
  return {rgb, {{v, 0, 0, 0, v, 0, 0, 0, v}}, 100, {}};
}

std::vector<std::vector<double>> rows_of(const std::filesystem::path& path) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || (std::isdigit(static_cast<unsigned char>(line[0])) == 0)) continue;
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

// The patches that were read in a photograph of a ColorChecker Passport, black 2048; the peer's figures stand in its
// SOURCE.md.
std::vector<PatchReading> passport(double black) {
  std::vector<PatchReading> readings;
  for (const auto& r : rows_of(tests::data("colour/passport_canon550d/peer_patches.csv")))
    readings.push_back({{r[3] - black, r[4] - black, r[5] - black},
                        {{r[6] * r[6], 0, 0, 0, r[7] * r[7], 0, 0, 0, r[8] * r[8]}},
                        625,
                        {}});
  return readings;
}

TEST(Passport, HeldOutDifferencesAreNotAboveThePeers) {
  GONIO_NEEDS_DATA("colour/passport_canon550d/peer_patches.csv");
  const Chart chart = colorchecker_classic("before-2014", "test");
  const auto readings = passport(2048);
  CalibrationRequest request{Model::linear, Target::cie_rgb, true, Take::never, Take::never};
  const Calibration alike = calibrate(chart, readings, request, "test");  // the peer's own problem
  EXPECT_NEAR(alike.fitted.mean, 2.45, 0.01);
  EXPECT_EQ(alike.held_out.worst, 23u);
  request.model = Model::root_polynomial_2;
  const Calibration roots = calibrate(chart, readings, request, "test");
  EXPECT_NEAR(roots.fitted.mean, 1.79, 0.01);
  EXPECT_LT(roots.held_out.mean, 2.38);
  // The offset, which the peer knew of, is found and named; with it each model is better than the peer's.
  request = {Model::linear, Target::cie_rgb, true, Take::automatic, Take::automatic};
  const Calibration linear = calibrate(chart, readings, request, "test");
  EXPECT_LT(linear.found.offset_chance, 1e-6);
  EXPECT_NEAR(linear.found.offset.y, 17, 3 * linear.found.offset_sigma.y);
  EXPECT_GT(linear.found.gradient_chance, 1e-3);
  EXPECT_LT(linear.held_out.mean, 2.73);
  EXPECT_LT(linear.fitted.mean, 1.97);  // the thesis's
  request.model.reset();
  const Calibration best = calibrate(chart, readings, request, "test");
  EXPECT_LT(best.held_out.mean, 2.0);
  EXPECT_LT(best.exposure_de00, 1e-6);
  EXPECT_EQ(best.tried.size(), 6u);
}

// 72 codes of black that nobody took off: found, and the correction is as good as with the right black.
TEST(Passport, ABlackThatWasLeftIsFound) {
  GONIO_NEEDS_DATA("colour/passport_canon550d/peer_patches.csv");
  const Chart chart = colorchecker_classic("before-2014", "test");
  const CalibrationRequest request{Model::linear, Target::cie_rgb, true, Take::automatic, Take::automatic};
  const Calibration right = calibrate(chart, passport(2048), request, "test"),
                    left = calibrate(chart, passport(1976), request, "test");
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(left.found.offset[c] - right.found.offset[c], 72, 3 * left.found.offset_sigma[c]);
  EXPECT_NEAR(left.held_out.mean, right.held_out.mean, 0.1);
}

// What real sensors, which are no mixtures of the observer's functions, read of real reflectances.
struct Sensors {
  std::vector<std::array<Rgb, 24>> patches;  // of each camera
};
Sensors sensors() {
  Sensors all;
  const auto root = tests::data("colour");
  const auto reflectance = rows_of(root / "colorchecker-reference/data_babelcolor_average_reflectance.csv");
  const auto light = optics::illuminant("D50", "test");
  for (const auto& entry : std::filesystem::directory_iterator(root / "camera_sensitivities")) {
    if (entry.path().extension() != ".csv") continue;
    const auto curve = rows_of(entry.path());
    std::array<Rgb, 24> seen{};
    for (const auto& row : reflectance)
      for (const auto& s : curve) {
        if (s[0] != row[0]) continue;
        for (std::size_t p = 0; p < 24; ++p) seen[p] += Rgb{s[1], s[2], s[3]} * (row[1 + p] * light(row[0] * 1e-9));
      }
    all.patches.push_back(seen);
  }
  return all;
}
Chart lit_chart() {
  Chart chart = colorchecker_classic("before-2014", "test");
  const auto rows = rows_of(tests::data("colour/colorchecker-reference/data_babelcolor_average_reflectance.csv"));
  for (std::size_t p = 0; p < 24; ++p) {
    std::vector<double> wavelength_m, value;
    for (const auto& row : rows) wavelength_m.push_back(row[0] * 1e-9), value.push_back(row[1 + p]);
    const optics::Spectrum spectrum(wavelength_m, value, "test");
    chart.patches[p].xyz =
        optics::xyz_of([&](double w) { return spectrum.at(std::clamp(w, spectrum.first_m(), spectrum.last_m())); },
                       optics::illuminant("D50", "test"));
    chart.patches[p].lab = optics::lab_from_xyz(chart.patches[p].xyz, optics::white_d50);
  }
  return chart;
}

// Six real sensors: neither light nor offset is seen where there is none, both are found where they are, and their
// intervals cover. What a sensor is off by the observer is the only noise here.
TEST(Light, IsToldFromRealSensorsColours) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  const Chart chart = lit_chart();
  const Sensors all = sensors();
  ASSERT_GE(all.patches.size(), 6u);
  Random random(12);
  double squares = 0, count = 0;
  for (const auto& seen : all.patches)
    for (int k = 0; k < 20; ++k) {
      const bool uneven = k > 0;
      const Vec2 gradient = uneven ? Vec2{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)} : Vec2{};
      const Rgb white = seen[18] / 0.9;
      const Rgb offset = uneven ? white * random.uniform(0.005, 0.03) : Rgb{};
      std::vector<PatchReading> readings;
      for (std::size_t p = 0; p < 24; ++p)
        readings.push_back(reading(
            seen[p] * (1 + dot(gradient, chart.patches[p].centre - Vec2{0.5, 0.5})) * (1 + 0.005 * random.normal()) +
                offset,
            1e-3 * white.y));
      const ChartLight light = chart_light(chart, readings, white, {true, true});
      if (!uneven) {
        EXPECT_GT(light.gradient_chance, 1e-3);
        EXPECT_GT(light.offset_chance, 1e-3);
        EXPECT_GT(chart_light(chart, readings, white, {true, true, true}).curve_chance, 1e-3);
        continue;
      }
      squares += std::pow((light.gradient.x - gradient.x) / light.gradient_sigma.x, 2) +
                 std::pow((light.gradient.y - gradient.y) / light.gradient_sigma.y, 2);
      for (int c = 0; c < 3; ++c) squares += std::pow((light.offset[c] - offset[c]) / light.offset_sigma[c], 2);
      count += 5;
      EXPECT_TRUE(norm(gradient) < 0.25 || light.gradient_chance < 1e-3) << light.gradient_chance;
      EXPECT_LT(light.offset_chance, 1e-3);
    }
  // A sensor's own colours are the same in all of its twenty charts: z-scores are not independent.
  EXPECT_LT(std::sqrt(squares / count), 1.3);
  EXPECT_GT(std::sqrt(squares / count), 0.3);
}

// Light that changes by a third over the chart costs nothing once it is found.
TEST(Light, UnevenLightIsDividedOut) {
  const Chart chart = colorchecker_classic("after-2014", "test");
  std::vector<PatchReading> readings;
  for (const Patch& p : chart.patches)
    readings.push_back(reading(camera * p.xyz * (1 + dot(Vec2{0.3, -0.15}, p.centre - Vec2{0.5, 0.5})), 1e-4));
  CalibrationRequest request{Model::linear, Target::cie_rgb, true, Take::automatic, Take::automatic};
  const Calibration found = calibrate(chart, readings, request, "test");
  EXPECT_LT(found.held_out.mean, 0.1);
  EXPECT_NEAR(found.taken.gradient.x, 0.3, 5e-3);
  request.gradient = Take::never;
  EXPECT_GT(calibrate(chart, readings, request, "test").held_out.mean, 1.5);
  for (std::size_t p = 0; p < 24; ++p)
    readings[p].rgb = readings[p].rgb * std::max(0.05, 1 - 1.7 * chart.patches[p].centre.x);
  request.gradient = Take::automatic;
  EXPECT_THROW(calibrate(chart, readings, request, "test"), Error);
}

// A lamp one and a half widths above the middle of the chart's left edge: the fourth power of the cosine.
TEST(Light, OfANearLampCurves) {
  const Chart chart = colorchecker_classic("after-2014", "test");
  Random random(21);
  std::vector<PatchReading> readings;
  for (const Patch& p : chart.patches) {
    const Vec2 off{p.centre.x, (p.centre.y - 0.5) * chart.height_over_width};
    const double light = std::pow(1 + dot(off, off) / 2.25, -2);
    readings.push_back(reading(camera * p.xyz * light * (1 + 0.003 * random.normal()), 1e-4));
  }
  const CalibrationRequest request{Model::linear, Target::cie_rgb, true, Take::automatic, Take::automatic};
  const Calibration found = calibrate(chart, readings, request, "test");
  EXPECT_LT(found.found.curve_chance, 1e-3);
  EXPECT_LT(found.held_out.mean, 1.0);
  EXPECT_GT(calibrate(chart, readings, {Model::linear, Target::cie_rgb, true, Take::never, Take::never}, "test")
                .held_out.mean,
            2 * found.held_out.mean);
}

TEST(Patches, ThatAreLeftOutDoNotCount) {
  const Chart chart = colorchecker_classic("after-2014", "test");
  std::vector<PatchReading> readings;
  for (const Patch& p : chart.patches) readings.push_back(reading(camera * p.xyz, 1e-4));
  readings[18].rgb = {0.5, 0.5, 0.5}, readings[18].left_out = "clipped";
  const CalibrationRequest request{Model::linear, Target::cie_rgb, true, Take::automatic, Take::automatic};
  const Calibration found = calibrate(chart, readings, request, "test");
  EXPECT_LT(found.held_out.mean, 0.05);
  EXPECT_FALSE(found.patches[18].fitted.has_value());
  for (PatchReading& r : readings) r.left_out = "clipped";
  EXPECT_THROW(calibrate(chart, readings, request, "test"), Error);
}

// Intervals of coefficients by the jackknife cover the truth where patches are not quite what the edition says (one
// dE00 or so) and readings are noisy; the camera is a mixture. Simulated charts of nine coefficients each.
TEST(Coefficients, HaveHonestIntervals) {
  const Chart chart = colorchecker_classic("after-2014", "test");
  const Rgb white = camera * optics::white_d50;
  const Mat3 truth =
      from_xyz_d50(Target::cie_rgb) * inverse(camera) * Mat3{{white.x, 0, 0, 0, white.y, 0, 0, 0, white.z}};
  for (const bool refine : {false, true}) {
    double covered = 0, count = 0, squares = 0;
    for (std::uint64_t seed = 1; seed <= (refine ? 100u : 200u); ++seed) {
      Random random(seed);
      const auto three = [&random] { return Vec3{random.normal(), random.normal(), random.normal()}; };
      std::vector<PatchReading> readings;
      for (const Patch& p : chart.patches) {
        const optics::Xyz own = optics::xyz_from_lab(p.lab + three() * 0.7, optics::white_d50);
        readings.push_back(reading(camera * own * (Rgb{1, 1, 1} + three() * 0.002), 1e-6));
      }
      const CalibrationRequest request{Model::linear, Target::cie_rgb, refine, Take::never, Take::never};
      const Calibration found = calibrate(chart, readings, request, "test");
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          // The matrix takes pixels over the white that was found.
          const int r = static_cast<int>(i), c = static_cast<int>(j);
          const double wanted = truth(r, c) * found.white[c] / white[c];
          const double z =
              (found.correction.matrix()[i][j] - wanted) / std::sqrt(found.covariance[3 * i + j][3 * i + j]);
          covered += std::abs(z) < 1.96, squares += z * z, ++count;
        }
    }
    EXPECT_GT(covered / count, 0.92) << refine;
    EXPECT_LT(covered / count, 0.99) << refine;
    EXPECT_NEAR(std::sqrt(squares / count), 1, 0.25) << refine;
  }
}

TEST(Quality, PolynomialsMoveWithExposureAndIdentityPassesNoiseOn) {
  const std::vector<std::vector<double>> one{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Rgb> pixels{{0.5, 0.3, 0.2}, {0.1, 0.4, 0.9}};
  const Correction identity(Model::linear, one, {1, 1, 1}, Target::srgb, "test");
  EXPECT_NEAR(noise_gain(identity, pixels), 1, 1e-12);
  EXPECT_NEAR(exposure_change(identity, pixels), 0, 1e-9);
  std::vector<std::vector<double>> squares(3, std::vector<double>(9));
  for (std::size_t i = 0; i < 3; ++i) squares[i][i] = 1, squares[i][3] = 0.3;
  EXPECT_GT(exposure_change(Correction(Model::polynomial_2, squares, {1, 1, 1}, Target::srgb, "test"), pixels), 1);
}

}  // namespace
}  // namespace gonio::colour
