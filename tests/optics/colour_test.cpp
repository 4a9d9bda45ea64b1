#include "optics/colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "data.h"

namespace gonio::optics {
namespace {

void expect_near(Rgb a, Rgb b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Bands three(double a_m, double b_m, double c_m) {
  return {false, {a_m, b_m, c_m}};
}

// The published CIE RGB table, five digits.
TEST(MatchingFunctions, AreThoseOfTheCie) {
  expect_near(matching_functions(450e-9), {-0.01213, 0.00678, 0.31670}, 5e-5);
  expect_near(matching_functions(500e-9), {-0.07173, 0.08536, 0.04776}, 5e-5);
  expect_near(matching_functions(520e-9), {-0.09264, 0.17468, 0.01221}, 5e-5);
  expect_near(matching_functions(600e-9), {0.34429, 0.06246, -0.00049}, 5e-5);
  expect_near(matching_functions(700e-9), {0.00410, 0, 0}, 5e-5);
  // At a primary the other two functions vanish; 435.8 and 546.1 nm lie between the table's rows.
  EXPECT_NEAR(matching_functions(435.8e-9).x, 0, 5e-4);
  EXPECT_NEAR(matching_functions(435.8e-9).y, 0, 5e-4);
  EXPECT_NEAR(matching_functions(546.1e-9).x, 0, 5e-4);
  EXPECT_NEAR(matching_functions(546.1e-9).z, 0, 5e-4);
  expect_near(matching_functions(379e-9), {}, 0);
  expect_near(matching_functions(781e-9), {}, 0);
}

TEST(MatchingFunctions, EqualEnergyIsWhite) {
  Rgb sum;
  for (int i = 0; i < 4000; ++i) sum += matching_functions(380e-9 + (i + 0.5) * 1e-10) * 0.1;  // over nanometres
  EXPECT_NEAR(sum.x / sum.y, 1, 3e-5);
  EXPECT_NEAR(sum.z / sum.y, 1, 1.5e-4);
  EXPECT_NEAR(sum.y, 18.91, 0.01);
  expect_near(rgb_of([](double) { return 1.5; }), {1.5, 1.5, 1.5}, 1e-12);
}

// The lobe of r below zero, as the header states it.
TEST(MatchingFunctions, LobeOfRed) {
  double lobe = 0, first = 1, last = 0;
  for (int i = 0; i < 4000; ++i) {
    const double w = 380e-9 + (i + 0.5) * 1e-10, r = normalised_matching_functions(w).x * 1e-10;
    if (r >= 0 || w > 600e-9) continue;
    lobe += r;
    first = std::min(first, w), last = std::max(last, w);
  }
  EXPECT_NEAR(lobe, -0.29, 0.005);
  EXPECT_NEAR(first, 437e-9, 2e-9);
  EXPECT_NEAR(last, 547e-9, 2e-9);
}

TEST(BandValues, LinearDispersionIsExactAtTheCentres) {
  const auto line = [](double wavelength_m) { return 1.6 - 2e5 * wavelength_m; };
  const Rgb centres = rgb_centres_m(), rgb = band_values(line, {380e-9, 780e-9}, Bands{}, "line");
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], line(centres[c]), 1e-12);
  EXPECT_NEAR(centres.x, 637e-9, 2e-9);
  EXPECT_NEAR(centres.y, 550e-9, 10e-9);
  EXPECT_NEAR(centres.z, 450e-9, 10e-9);
}

TEST(BandValues, StayWithinTheSpectrum) {
  // High where red's lobe is: a plain signed sum is -0.29 in red.
  const auto lobe = [](double w) { return w > 437e-9 && w < 547e-9 ? 1.0 : 0.0; };
  const Rgb rgb = band_values(lobe, {380e-9, 780e-9}, Bands{}, "lobe");
  EXPECT_EQ(rgb.x, 0);
  EXPECT_LE(rgb.y, 1);
  EXPECT_LT(rgb_of(lobe).x, -0.25);
}

TEST(BandValues, WavelengthsAreReadWhereTheyLie) {
  const Spectrum spectrum({400e-9, 500e-9, 700e-9}, {1, 2, 4}, "here");
  expect_near(band_values(spectrum, three(400e-9, 450e-9, 600e-9)), {1, 1.5, 3}, 1e-12);
  EXPECT_THROW(band_values(spectrum, three(399e-9, 450e-9, 600e-9)), Error);
}

TEST(BandValues, RefusesWhatCoversTooLittle) {
  EXPECT_THROW(band_values(Spectrum({500e-9, 780e-9}, {1, 1}, "green on"), Bands{}), Error);
  EXPECT_NO_THROW(band_values(Spectrum({436.8e-9, 700e-9}, {1, 1}, "as of polymers"), Bands{}));
}

TEST(BandValues, MeasuredIndices) {
  GONIO_NEEDS_DATA("optical/refractiveindex");
  const auto root = tests::data("optical/refractiveindex");
  const RefractiveIndex glass = read_refractive_index(root / "specs_schott_optical_N-BK7.yml");
  const Rgb n = band_values([&](double w) { return glass.n(w); }, {300e-9, 2.5e-6}, Bands{}, "glass");
  const Rgb centres = rgb_centres_m();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(n[c], glass.n(centres[c]), 1e-3);
  EXPECT_LT(n.x, n.y);  // normal dispersion
  EXPECT_LT(n.y, n.z);
  const RefractiveIndex gold = read_refractive_index(root / "main_Au_nk_Johnson.yml");
  const auto covered = Range{380e-9, 756e-9};
  const Rgb gold_n = band_values([&](double w) { return gold.n(w); }, covered, Bands{}, "gold");
  const Rgb gold_k = band_values([&](double w) { return gold.k(w); }, covered, Bands{}, "gold");
  // Reflectance at normal incidence: gold is yellow.
  const auto f0 = [&](int c) {
    return (std::pow(gold_n[c] - 1, 2) + gold_k[c] * gold_k[c]) / (std::pow(gold_n[c] + 1, 2) + gold_k[c] * gold_k[c]);
  };
  EXPECT_GT(f0(0), 0.9);
  EXPECT_GT(f0(1), 0.65);
  EXPECT_LT(f0(2), 0.5);
}

TEST(Upsampling, ReturnsTheNumbersItCameFrom) {
  for (const Rgb value : {Rgb{1, 0, 0}, Rgb{0, 1, 0}, Rgb{0, 0, 1}, Rgb{0.3, 0.5, 0.1}, Rgb{7, 7, 7}})
    expect_near(rgb_of([&](double w) { return upsampled(value, w); }), value, 1e-12);
}

TEST(Upsampling, GreyIsGreyEverywhere) {
  for (int nm = 360; nm < 830; nm += 7) EXPECT_NEAR(upsampled({0.4, 0.4, 0.4}, nm * 1e-9), 0.4, 1e-12);
}

TEST(Upsampling, LeavesTheUnitIntervalByNoMoreThanStated) {
  for (int corner = 0; corner < 8; ++corner)
    for (int nm = 380; nm <= 780; ++nm) {
      const Rgb value{corner & 1 ? 1.0 : 0.0, corner & 2 ? 1.0 : 0.0, corner & 4 ? 1.0 : 0.0};
      EXPECT_GE(upsampled(value, nm * 1e-9), -0.2);
      EXPECT_LE(upsampled(value, nm * 1e-9), 1.2);
    }
  EXPECT_EQ(upsampled(Rgb{1, 2, 3}, Bands{}), (Rgb{1, 2, 3}));
}

// N bins, as a spectral rendering has them: what comes back of a smooth RGB.
TEST(RgbWeights, BinsOfASpectralRendering) {
  const Rgb value{0.6, 0.4, 0.2};
  for (const int bins : {12, 24, 48}) {
    std::vector<double> centres;
    for (int i = 0; i < bins; ++i) centres.push_back(380e-9 + (i + 0.5) * 400e-9 / bins);
    const auto weights = rgb_weights(centres, "bins");
    Rgb sum, all;
    for (int i = 0; i < bins; ++i) {
      const auto k = static_cast<std::size_t>(i);
      sum += weights[k] * upsampled(value, centres[k]);
      all += weights[k];
    }
    expect_near(all, {1, 1, 1}, 1e-12);
    expect_near(sum, value, bins == 12 ? 0.02 : 0.005);
  }
  const std::vector<double> red{700e-9, 720e-9};
  EXPECT_THROW(rgb_weights(red, "red only"), Error);
}

TEST(SpectrumFile, TwoColumns) {
  const Spectrum s = parse_spectrum("wavelength_nm,value\n# lamp\n400, 1\n500,3e0\r\n", "s.csv");
  EXPECT_NEAR(s.at(450e-9), 2, 1e-12);
  EXPECT_NEAR(s.at(500e-9), 3, 1e-12);
  EXPECT_THROW(s.at(501e-9), Error);
}

TEST(SpectrumFile, SaysWhatIsWrong) {
  const auto said = [](const char* text) {
    try {
      parse_spectrum(text, "s.csv");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(said("w,v\n400,x\n").find("s.csv:2"), std::string::npos);
  EXPECT_NE(said("w,v\n400\n").find("s.csv:2"), std::string::npos);
  EXPECT_NE(said("500,1\n400,1\n").find("do not grow"), std::string::npos);
  EXPECT_NE(said("w,v\n").find("without samples"), std::string::npos);
  EXPECT_NE(said("-5,1\n").find("positive wavelength"), std::string::npos);
}

}  // namespace
}  // namespace gonio::optics
