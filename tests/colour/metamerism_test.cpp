#include "colour/metamerism.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "colour/correction_fit.h"
#include "data.h"
#include "linear/qr.h"
#include "optics/colorimetry.h"
#include "optics/colour.h"

namespace gonio::colour {
namespace {

const auto d50 = optics::illuminant("D50", "test");

// Three bells: no mixtures of the observer's functions.
Rgb bells(double w) {
  const auto bell = [w](double centre, double width) { return std::exp(-std::pow((w - centre) / width, 2) / 2); };
  return {bell(600e-9, 35e-9), bell(535e-9, 35e-9), bell(460e-9, 30e-9)};
}

TEST(Metamerism, MixturesOfTheObserversFunctionsHaveNone) {
  const Mat3 mix{{1, 0.4, 0.1, 0.3, 1, 0.2, 0, 0.1, 0.8}};
  EXPECT_LT(metamerism_de00([&](double w) { return mix * optics::matching_functions(w); }, d50, "test"), 1e-3);
  EXPECT_GT(metamerism_de00(bells, d50, "test"), 0.5);
}

// The best linear estimate of XYZ, found on 20000 random reflectances, leaves what the bound says.
TEST(Metamerism, IsWhatTheBestEstimateLeaves) {
  constexpr int count = 20000, modes = 60;
  // Smooth random functions as sums of cosines whose frequencies have the spectrum of the covariance.
  Random random(3);
  Eigen::MatrixXd read(count, 4), wanted(count, 3);
  for (int k = 0; k < count; ++k) {
    std::array<double, modes> frequency{}, phase{};
    for (int m = 0; m < modes; ++m) frequency[m] = random.normal() / 66e-9, phase[m] = random.uniform(0, 2 * pi);
    const double level = 0.226 * 0.5 * random.normal(), size = 0.226 * std::sqrt(0.75 * 2 / modes);
    std::array<double, 81> reflectance{};
    Rgb seen;
    for (int i = 0; i < 81; ++i) {
      const double w = 380e-9 + 5e-9 * i;
      double r = mean_reflectance + level;
      for (int m = 0; m < modes; ++m) r += size * std::cos(frequency[m] * w + phase[m]);
      reflectance[i] = r, seen += bells(w) * (r * d50(w) * 1e-3);
    }
    const optics::Xyz xyz =
        optics::xyz_of([&](double w) { return reflectance[std::lround((w - 380e-9) / 5e-9)]; }, d50);
    read.row(k) << 1, seen.x, seen.y, seen.z;
    wanted.row(k) << xyz.x, xyz.y, xyz.z;
  }
  const Eigen::MatrixXd left = wanted - read * linear::PivotedQr(read).solve(wanted);
  const optics::Xyz white = optics::xyz_of([](double) { return 1.0; }, d50), grey = white * mean_reflectance;
  const Mat3 whiten = difference_root(optics::lab_from_xyz(grey, white)) * optics::lab_slopes(grey, white);
  double squares = 0;
  for (int k = 0; k < count; ++k) {
    const Vec3 d = whiten * Vec3{left(k, 0), left(k, 1), left(k, 2)};
    squares += dot(d, d);
  }
  // Known to one per cent or so.
  EXPECT_NEAR(std::sqrt(squares / count) / metamerism_de00(bells, d50, "test"), 1, 0.04);
}

// Five cameras for people, of which one is nearly an observer, and an industrial one whose red hardly sees green.
TEST(Metamerism, TellsSensorsApart) {
  GONIO_NEEDS_DATA("colour/camera_sensitivities");
  int cameras = 0;
  for (const auto& entry : std::filesystem::directory_iterator(tests::data("colour/camera_sensitivities"))) {
    if (entry.path().extension() != ".csv") continue;
    const double bound = metamerism_de00(read_sensitivities(entry.path()), d50, "test");
    const std::string name = entry.path().filename();
    const bool near = name.starts_with("Sony"), far = name.starts_with("Point");
    EXPECT_GT(bound, near ? 0.5 : far ? 8 : 1.5) << name;
    EXPECT_LT(bound, near ? 1 : far ? 20 : 3) << name;
    ++cameras;
  }
  EXPECT_GE(cameras, 6);
}

TEST(Metamerism, RefusesFilesThatSayNothing) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      metamerism_de00(parse_sensitivities(text, "s.csv"), d50, "s.csv");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("nm,R,G,B\n400,1,2\n"), testing::HasSubstr("s.csv:2: has 3 columns, needs 4"));
  EXPECT_THAT(refusal("400,1,2,x\n500,1,2,3\n"), testing::HasSubstr("s.csv"));
  EXPECT_THAT(refusal("500,1,2,3\n400,1,2,3\n"), testing::HasSubstr("s.csv"));
  EXPECT_THAT(refusal("400,1,1,1\n700,1,1,1\n"), testing::HasSubstr("channels that see the same"));
}

}  // namespace
}  // namespace gonio::colour
