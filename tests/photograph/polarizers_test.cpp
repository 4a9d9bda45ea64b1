// Polarizers over samples: light that is linear over the picture comes back, variances are those of repeated noise, an
// edge without polarization shows little, samples that cannot be trusted are left out, and recorded mosaics have the
// degree of polarization that a peer finds in them.
#include "photograph/polarizers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "data.h"
#include "geom/angle.h"
#include "io/picture.h"
#include "mosaic_world.h"
#include "photograph/raw_view.h"

namespace gonio::photograph {
namespace {

const Mosaic grid = Mosaic::named("polarizers", "test");

struct Light {
  double s0, s1, s2;
};

struct Samples : tests::Samples {
  using tests::Samples::Samples;
  template <class Of>
  void show(const Of& light) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Light s = light(x, y);
        value[static_cast<std::size_t>(width * y + x)] =
            static_cast<float>(behind_polarizer(s.s0, s.s1, s.s2, polarizer_angle(x, y)));
      }
  }
  Demosaiced stokes(Demosaicing how) const { return demosaiced(grid, how); }
};

TEST(Polarizers, BringBackLightThatIsLinearOverThePicture) {
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    Samples s(20, 16);
    const auto light = [](int x, int y) {
      return Light{100 + 2.0 * x + y, 20 - 0.5 * x + 0.25 * y, -10 + 0.5 * x - y};
    };
    s.show(light);
    const Demosaiced d = s.stokes(how);
    EXPECT_EQ(d.colour.channels, (std::vector<std::string>{"Y", "s1.Y", "s2.Y"}));
    for (int y = 2; y < 14; ++y)
      for (int x = 2; x < 18; ++x) {
        const Light truth = light(x, y);
        EXPECT_NEAR(d.colour.at(x, y, 0), truth.s0, 1e-4) << x << " " << y;
        EXPECT_NEAR(d.colour.at(x, y, 1), truth.s1, 1e-4) << x << " " << y;
        EXPECT_NEAR(d.colour.at(x, y, 2), truth.s2, 1e-4) << x << " " << y;
      }
  }
}

// Even light comes back at the border as well, where there are fewer neighbours.
TEST(Polarizers, EvenLightIsEvenAtTheBorderAndBesideDefects) {
  Samples s(12, 10);
  s.show([](int, int) { return Light{50, 10, -20}; });
  for (const std::size_t i : {53u, 54u, 79u}) s.value[i] = 1e6f, s.trusted[i] = 0;
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    const Demosaiced d = s.stokes(how);
    std::size_t untrusted = 0;
    for (std::size_t i = 0; i < d.trusted.size(); ++i) {
      untrusted += d.trusted[i] == 0;
      if (s.trusted[i] == 0) {
        EXPECT_EQ(d.trusted[i], 0);
      }
      if (d.trusted[i] == 0) continue;
      EXPECT_NEAR(d.colour.data[3 * i], 50, 1e-4) << i;
      EXPECT_NEAR(d.colour.data[3 * i + 1], 10, 1e-4) << i;
      EXPECT_NEAR(d.colour.data[3 * i + 2], -20, 1e-4) << i;
    }
    EXPECT_EQ(untrusted, 3u);
  }
}

// Of white noise, another at each sample: the mean square of each of the three is the stated variance's, within four
// standard errors with a freedom for every six values, which share samples.
TEST(Polarizers, StateTheVarianceOfTheirNoise) {
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    Samples s(300, 200);
    Random random(5);
    for (std::size_t i = 0; i < s.value.size(); ++i) {
      s.variance[i] = static_cast<float>(1 + (i % 5));
      s.value[i] = static_cast<float>(std::sqrt(s.variance[i]) * random.normal());
      s.trusted[i] = random.uniform() > 0.02;
    }
    const Demosaiced d = s.stokes(how);
    for (std::size_t k = 0; k < 3; ++k) {
      double squares = 0, count = 0;
      for (std::size_t i = 0; i < d.trusted.size(); ++i) {
        if (d.trusted[i] == 0) continue;
        squares += std::pow(d.colour.data[3 * i + k], 2) / d.variance.data[3 * i + k], ++count;
      }
      EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 * 6 / count)) << k;
    }
  }
}

// Mean degree of polarization that a soft round edge without any seems to have, of s0's range: as super-pixels (nothing
// is interpolated), by the nearest samples, and corrected.
TEST(Polarizers, AnEdgeWithoutPolarizationShowsLittle) {
  Samples s(128, 128);
  s.show([](int x, int y) { return Light{100 + 80 * std::tanh((std::hypot(x - 63.3, y - 64.1) - 40) / 2), 0, 0}; });
  const auto shown = [&](const Demosaiced& d) {
    double sum = 0;
    for (int y = 4; y < 124; ++y)
      for (int x = 4; x < 124; ++x) sum += std::hypot(d.colour.at(x, y, 1), d.colour.at(x, y, 2));
    return sum / (120 * 120);
  };
  double blocks = 0;
  for (int y = 4; y < 124; y += 2)
    for (int x = 4; x < 124; x += 2) {
      const float* top = &s.value[static_cast<std::size_t>(128 * y + x)];
      blocks += std::hypot(top[129] - top[0], top[1] - top[128]) / (60 * 60);
    }
  const double bilinear = shown(s.stokes(Demosaicing::bilinear)), gradient = shown(s.stokes(Demosaicing::gradient));
  EXPECT_LT(bilinear, 0.5 * blocks) << blocks;
  EXPECT_LT(gradient, 0.3 * bilinear) << bilinear;
}

struct Degrees {
  double median = 0, high = 0;  // 95th percentile
};
Degrees degrees_of(const char* name) {
  RawRecipe recipe;
  recipe.stated.mosaic = "polarizers";
  recipe.noise = manifest::Noise{100, 0.5};
  recipe.demosaicing = Demosaicing::bilinear;
  recipe.blooming_px = 0;
  const DevelopedView view = develop_view({name, {gonio::tests::data("polarization/imx250mzr") / name}, {1.0}}, recipe);
  std::vector<double> degrees;
  const int y = view.picture.channel("Y"), s1 = view.picture.channel("s1.Y"), s2 = view.picture.channel("s2.Y");
  for (std::size_t i = 0; i < view.picture.pixels(); ++i) {
    const float* p = &view.picture.data[i * view.picture.channels.size()];
    if (view.trusted[i] != 0 && p[y] > 0) degrees.push_back(std::hypot(p[s1], p[s2]) / p[y]);
  }
  std::ranges::sort(degrees);
  return {degrees[degrees.size() / 2], degrees[degrees.size() * 95 / 100]};
}

// Median and 95th percentile that the set's README states, which does not say how its peer interpolates: the same
// recordings as super-pixels have 0.080, 0.258, 0.034 and 0.545, a filter of OpenCV's on each lattice 0.080, 0.252,
// 0.026 and 0.532.
TEST(Polarizers, RecordedMosaicsHaveAPeersDegreeOfPolarization) {
  GONIO_NEEDS_DATA("polarization/imx250mzr");
  const Degrees fruits = degrees_of("fruits_IMX250MZR.png"), camera = degrees_of("camera_IMX250MZR.png");
  EXPECT_NEAR(fruits.median, 0.080, 0.001);
  EXPECT_NEAR(fruits.high, 0.256, 0.004);
  EXPECT_NEAR(camera.median, 0.031, 0.006);
  EXPECT_NEAR(camera.high, 0.555, 0.022);
}

}  // namespace
}  // namespace gonio::photograph
