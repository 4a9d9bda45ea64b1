#include "optics/colorimetry.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/csv.h"
#include "optics/colour.h"
#include "optics/spectrum.h"

namespace gonio::optics {
namespace {

struct Pair {
  Lab a, b;
  double difference;
};
// Sharma, Wu & Dalal 2005, table 1: pairs at which implementations go wrong.
constexpr std::array<Pair, 34> pairs{{
    {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
    {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
    {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
    {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
    {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
    {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
    {{50, 0, 0}, {50, -1, 2}, 2.3669},
    {{50, -1, 2}, {50, 0, 0}, 2.3669},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0010}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0012}, 7.2195},
    {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0010, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
    {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
    {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
    {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
    {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
    {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
    {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
    {{50, 2.5, 0}, {50, 3.2972, 0}, 1.0000},
    {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1.0000},
    {{50, 2.5, 0}, {50, 3.2592, 0.3350}, 1.0000},
    {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
    {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
    {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
    {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
    {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
    {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
    {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
    {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
    {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
    {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
}};

TEST(Ciede2000, IsThatOfSharmasPairs) {
  for (const Pair& p : pairs) {
    EXPECT_NEAR(ciede2000(p.a, p.b), p.difference, 5e-5);
    EXPECT_NEAR(ciede2000(p.b, p.a), p.difference, 5e-5);
  }
  EXPECT_EQ(ciede2000({50, 10, 10}, {50, 10, 10}), 0);
}

TEST(Ciede2000, SlopesAreThoseOfDifferences) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Lab a{random.uniform(5, 95), random.uniform(-60, 60), random.uniform(-60, 60)};
    const Lab b = a + Vec3{random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)};
    const SlopedDifference d = ciede2000_sloped(a, b);
    EXPECT_DOUBLE_EQ(d.value, ciede2000(a, b));
    constexpr double h = 1e-5;
    EXPECT_NEAR(d.slope.x, (ciede2000(a, b + Vec3{h, 0, 0}) - ciede2000(a, b - Vec3{h, 0, 0})) / (2 * h), 1e-5);
    EXPECT_NEAR(d.slope.y, (ciede2000(a, b + Vec3{0, h, 0}) - ciede2000(a, b - Vec3{0, h, 0})) / (2 * h), 1e-5);
    EXPECT_NEAR(d.slope.z, (ciede2000(a, b + Vec3{0, 0, h}) - ciede2000(a, b - Vec3{0, 0, h})) / (2 * h), 1e-5);
  }
}

TEST(LabColours, GoThereAndBack) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Xyz xyz{std::pow(random.uniform(), 4), std::pow(random.uniform(), 4), std::pow(random.uniform(), 4)};
    const Xyz again = xyz_from_lab(lab_from_xyz(xyz, white_d50), white_d50);
    EXPECT_LT(norm(again - xyz), 1e-14);
    const Mat3 slopes = lab_slopes(xyz, white_d50);
    for (int c = 0; c < 3; ++c) {
      constexpr double h = 1e-8;
      const Vec3 step{c == 0 ? h : 0, c == 1 ? h : 0, c == 2 ? h : 0};
      const Vec3 slope = (lab_from_xyz(xyz + step, white_d50) - lab_from_xyz(xyz - step, white_d50)) / (2 * h);
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(slopes(r, c), slope[r], 1e-4 * (1 + std::abs(slope[r])));
    }
  }
  EXPECT_EQ(lab_from_xyz(white_d50, white_d50), (Lab{100, 0, 0}));
}

TEST(Adaptation, IsBradfords) {
  // Lindbloom's published matrix, D50 to D65.
  const Mat3 published{
      {0.9555766, -0.0230393, 0.0631636, -0.0282895, 1.0099416, 0.0210077, 0.0122982, -0.0204830, 1.3299098}};
  const Mat3 own = bradford(white_d50, white_d65);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(own.m[k], published.m[k], 1e-6);
  EXPECT_LT(norm(own * white_d50 - white_d65), 1e-12);
}

TEST(LinearColours, KeepWhite) {
  EXPECT_LT(norm(cie_rgb_from_xyz() * white_equal_energy - Vec3{1, 1, 1}), 1e-12);
  EXPECT_LT(norm(srgb_from_xyz() * white_d65 - Vec3{1, 1, 1}), 1e-4);
}

// Two ways from a spectrum to CIE RGB: by the normalised functions, and by XYZ under equal energy.
TEST(LinearColours, CieRgbIsThatOfTheNormalisedFunctions) {
  const auto spectrum = [](double w) { return 0.4 + 0.3 * std::sin(w * 2e7) + 0.1 * std::cos(w * 5e7); };
  const Rgb direct = rgb_of(spectrum), by_xyz = cie_rgb_from_xyz() * xyz_of(spectrum, illuminant("E", "test"));
  EXPECT_LT(norm(direct - by_xyz), 2e-3);
}

std::vector<std::vector<double>> numbers(const std::filesystem::path& path) {
  const io::Csv csv = io::read_csv(path);
  std::vector<std::vector<double>> rows;
  for (std::size_t k = 0; k < csv.rows.size(); ++k) {
    rows.emplace_back();
    for (const std::string& cell : csv.rows[k]) rows.back().push_back(io::csv_number(cell, csv.place(k)));
  }
  return rows;
}

TEST(Illuminants, AreThoseOfTheCie) {
  GONIO_NEEDS_DATA("colour/colorchecker-reference");
  for (const std::string name : {"A", "D50", "D65"}) {
    const auto own = illuminant(name, "test");
    const auto rows = numbers(tests::data("colour/colorchecker-reference") / ("illuminant_" + name + ".csv"));
    ASSERT_GT(rows.size(), 60u);
    for (const auto& row : rows)
      if (row[0] >= 380 && row[0] <= 780) {
        EXPECT_NEAR(own(row[0] * 1e-9) / own(560e-9), row[1] / 100, 3e-3) << row[0];
      }
  }
  const auto perfect = [](double) { return 1.0; };
  EXPECT_LT(norm(xyz_of(perfect, illuminant("D50", "test")) - white_d50), 1e-3);
  EXPECT_LT(norm(xyz_of(perfect, illuminant("D65", "test")) - white_d65), 1e-3);
  EXPECT_THROW(illuminant("D5", "--light"), Error);
  EXPECT_THROW(illuminant("F11", "--light"), Error);
}

// Reflectances by Ohta under D65; XYZ as worked out elsewhere, 100 for the perfect diffuser.
TEST(Reflectances, GiveTheChartsXyz) {
  GONIO_NEEDS_DATA("colour/colorchecker-reference");
  const auto rows = numbers(tests::data("colour/colorchecker-reference/data_colorchecker_n_ohta_reflectance.csv"));
  const auto xyz = [&](std::size_t patch) {
    std::vector<double> wavelength_m, value;
    for (const auto& row : rows) wavelength_m.push_back(row[0] * 1e-9), value.push_back(row[1 + patch]);
    const Spectrum spectrum(wavelength_m, value, "ohta");
    return xyz_of([&](double w) { return spectrum.at(w); }, illuminant("D65", "test")) * 100;
  };
  EXPECT_LT(norm(xyz(0) - Vec3{10.971, 9.703, 6.055}), 0.01);
  EXPECT_LT(norm(xyz(18) - Vec3{84.138, 88.724, 95.434}), 0.05);
}

}  // namespace
}  // namespace gonio::optics
