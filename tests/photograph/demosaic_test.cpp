// Mosaics: what is linear over the picture comes back, variances are those of repeated noise, samples that cannot be
// trusted are left out, and a recorded mosaic against its truth and a peer.
#include "photograph/demosaic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/picture.h"
#include "mosaic_world.h"

namespace gonio::photograph {
namespace {

using tests::Samples;

constexpr std::array grids{"BayerRG", "BayerGR", "BayerGB", "BayerBG"};

TEST(Demosaic, BringsBackWhatIsLinear) {
  for (const char* grid : grids)
    for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
      const Mosaic mosaic = Mosaic::named(grid, "test");
      Samples s(20, 16);
      // The gradient's correction takes colours to rise alike.
      const auto truth = [](int x, int y, int c) { return 10.0 * (c + 1) + 0.5 * x + 0.25 * y; };
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 20; ++x)
          s.value[static_cast<std::size_t>(20 * y + x)] = static_cast<float>(truth(x, y, mosaic.colour(x, y)));
      const Demosaiced d = s.demosaiced(mosaic, how);
      for (int y = 2; y < 14; ++y)
        for (int x = 2; x < 18; ++x)
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(d.colour.at(x, y, c), truth(x, y, c), 1e-4) << grid << x << " " << y;
    }
}

// Of white noise: the mean square over the picture is the stated variance's mean, within four standard errors.
TEST(Demosaic, StatesTheVarianceOfItsNoise) {
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    const Mosaic mosaic = Mosaic::named("BayerGR", "test");
    Samples s(300, 200);
    Random random(5);
    for (std::size_t i = 0; i < s.value.size(); ++i) {
      s.variance[i] = static_cast<float>(1 + (i % 3));
      s.value[i] = static_cast<float>(std::sqrt(s.variance[i]) * random.normal());
      s.trusted[i] = random.uniform() > 0.02;
    }
    const Demosaiced d = s.demosaiced(mosaic, how);
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < d.colour.data.size(); ++i) {
      if (d.trusted[i / 3] == 0) continue;
      squares += d.colour.data[i] * d.colour.data[i] / d.variance.data[i], ++count;
    }
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 * 4 / count));  // four pixels or so share each sample
  }
}

// A slanted edge, ten times as bright on one side: what interpolation misses there is in the variance that is stated,
// and away from it noise alone is.
TEST(Demosaic, StatesWhatItMissesAtEdges) {
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    const Mosaic mosaic = Mosaic::named("BayerRG", "test");
    Samples s(120, 90);
    Random random(3);
    constexpr double sigma = 0.01;
    const auto side = [](int x, int y) { return x + 0.31 * y - 70; };
    const auto truth = [&](int x, int y) { return 1 + 9 * std::clamp(side(x, y) + 0.5, 0.0, 1.0); };
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 120; ++x) {
        const std::size_t i = static_cast<std::size_t>(120 * y + x);
        s.value[i] = static_cast<float>(truth(x, y) + sigma * random.normal());
        s.variance[i] = sigma * sigma;
      }
    const Demosaiced d = s.demosaiced(mosaic, how);
    double near = 0, near_count = 0, far = 0, far_count = 0;
    for (int y = 3; y < 87; ++y)
      for (int x = 3; x < 117; ++x)
        for (int c = 0; c < 3; ++c) {
          if (mosaic.colour(x, y) == c) continue;
          const double off = d.colour.at(x, y, c) - truth(x, y), z = off * off / d.variance.at(x, y, c);
          if (std::abs(side(x, y)) < 1.5)
            near += z, ++near_count;
          else if (std::abs(side(x, y)) > 5)
            far += z, ++far_count;
        }
    EXPECT_GT(near / near_count, 0.3) << demosaicing_names[static_cast<std::size_t>(how)];
    EXPECT_LT(near / near_count, 2) << demosaicing_names[static_cast<std::size_t>(how)];
    EXPECT_NEAR(far / far_count, 1, 4 * std::sqrt(2 * 4 / far_count));
  }
}

// A pixel's values are from the exposures of all samples that entered them: those are the ones whose change changes it.
TEST(Demosaic, SaysWhichExposuresAPixelIsFrom) {
  const Mosaic mosaic = Mosaic::named("BayerGB", "test");
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    Samples s(14, 12);
    const std::size_t bad = 14 * 3 + 4, changed = 14 * 5 + 6;
    s.trusted[bad] = 0;
    std::vector<std::uint8_t> first(s.value.size(), 4), last(s.value.size(), 4);
    first[changed] = 2, last[changed] = 9, first[bad] = 0, last[bad] = 11;
    const auto run = [&] { return demosaic({14, 12, s.value, s.variance, s.trusted, first, last}, mosaic, how); };
    const Demosaiced before = run();
    s.value[changed] = 1;
    const Demosaiced after = run();
    std::size_t reached = 0;
    for (std::size_t i = 0; i < s.value.size(); ++i) {
      bool moved = false;
      for (std::size_t c = 0; c < 3; ++c) moved |= before.colour.data[3 * i + c] != after.colour.data[3 * i + c];
      EXPECT_EQ(after.first[i], moved ? 2 : 4) << i;
      EXPECT_EQ(after.last[i], moved ? 9 : 4) << i;
      reached += moved;
    }
    EXPECT_GE(reached, 9u);
    EXPECT_TRUE(s.demosaiced(mosaic, how).first[0] > s.demosaiced(mosaic, how).last[0]);  // not known
  }
}

TEST(Demosaic, LeavesOutWhatCannotBeTrusted) {
  const Mosaic mosaic = Mosaic::named("BayerRG", "test");
  for (const Demosaicing how : {Demosaicing::bilinear, Demosaicing::gradient}) {
    Samples s(12, 12);
    std::ranges::fill(s.value, 7.0f);
    const std::size_t bad = 12 * 6 + 6;  // red
    s.value[bad] = 1e6f, s.trusted[bad] = 0;
    const Demosaiced d = s.demosaiced(mosaic, how);
    for (std::size_t i = 0; i < d.trusted.size(); ++i) {
      EXPECT_EQ(d.trusted[i] == 0, i == bad) << i;
      for (std::size_t c = 0; c < 3; ++c)
        if (d.trusted[i] != 0) {
          EXPECT_FLOAT_EQ(d.colour.data[3 * i + c], 7) << i;
        }
    }
  }
  EXPECT_EQ(Mosaic::named("GBRG", "test").colour(0, 1), 0);
  EXPECT_THROW(Mosaic::named("XTrans", "test"), Error);
}

// 21.58 and 21.44 dB by OpenCV's bilinear and its way along edges, 8 bit, on the same mosaic (SOURCE.md there).
TEST(Demosaic, ARecordedMosaicIsAsNearToItsTruthAsAPeers) {
  GONIO_NEEDS_DATA("raw/klimt_bayer");
  const auto folder = gonio::tests::data("raw/klimt_bayer");
  const io::Image truth = io::read_picture(folder / "Klimt_truth.png");
  // The files' names say the grid of the picture; what lies in them is its transpose.
  for (const auto& [corner, grid] : {std::pair{"RGGB", "BayerRG"}, {"GRBG", "BayerGB"}}) {
    const std::string bytes = read_file(folder / (std::string("Klimt_Bayer_560x558_") + corner + "_12bits.raw"));
    const int width = 560, height = 558;  // of the transposed picture
    ASSERT_EQ(bytes.size(), std::size_t{2} * width * height);
    Samples s(width, height);
    for (std::size_t i = 0; i < s.value.size(); ++i)
      s.value[i] = static_cast<float>(static_cast<unsigned char>(bytes[2 * i]) +
                                      256 * static_cast<unsigned char>(bytes[2 * i + 1])) /
                   4095;
    const Mosaic mosaic = Mosaic::named(grid, "test");
    const auto decibels = [&](Demosaicing how) {
      const Demosaiced d = s.demosaiced(mosaic, how);
      double squares = 0, count = 0;
      for (int y = 4; y < height - 4; ++y)
        for (int x = 4; x < width - 4; ++x)
          for (int c = 0; c < 3; ++c)
            squares += std::pow(std::clamp(d.colour.at(x, y, c), 0.0f, 1.0f) - truth.at(y, x, c), 2), ++count;
      return -10 * std::log10(squares / count);
    };
    const double plain = decibels(Demosaicing::bilinear), better = decibels(Demosaicing::gradient);
    EXPECT_NEAR(plain, 21.58, 0.1) << corner;
    EXPECT_GT(better, plain) << corner;
    RecordProperty(corner, std::to_string(better));
  }
}

}  // namespace
}  // namespace gonio::photograph
