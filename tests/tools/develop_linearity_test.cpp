// A sensor that is not linear, as people deal with it: --characterize writes its table, --merge --linearity takes it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

constexpr double black = 100, gain = 0.25, read_e = 8, full = 3900;  // codes, code/e, e, codes above black

class DevelopLinearity : public testing::Test {
 protected:
  // Codes of 12 bits; `linear`: codes that a linear sensor would read at x.
  template <class Of>
  void write(const std::string& name, int width, double bend, const Of& linear) {
    std::normal_distribution<double> normal;
    io::Image picture(width, 96, {"Y"});
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < width; ++x) {
        const double mean = linear(x) / gain,
                     l = gain * (mean + std::sqrt(mean) * normal(random_) + read_e * normal(random_)),
                     code = black + l * (1 - bend * l / full);
        // Beyond full scale the parabola would turn back.
        picture.at(x, y, 0) =
            static_cast<float>((l > 1.2 * full ? 4095 : std::clamp(std::round(code), 0.0, 4095.0)) / 65535);
      }
    io::write_png(folder_ / name, picture, 16);
  }
  std::vector<std::string> write_series(double bend) {
    std::vector<std::string> words{"develop", "--characterize", "--out", "s",
                                   "--force", "--log-level",    "info",  "--black",
                                   "100",     "--full-scale",   "4095"};
    for (int k = 0; k < 4; ++k) {
      write(format("dark_1ms_%d.png", k), 96, bend, [](int) { return 0.0; });
      words.insert(words.end(), {"--dark", format("dark_1ms_%d.png", k)});
    }
    for (const int ms : {4, 10, 20, 35, 50, 65, 80, 95, 105})
      for (int k = 0; k < 2; ++k) {
        write(format("flat_%dms_%d.png", ms, k), 96, bend, [&](int x) { return 0.01 * ms * full * (1 - 0.002 * x); });
        words.push_back(format("flat_%dms_%d.png", ms, k));
      }
    return words;
  }
  // Largest relative departure of blocks of 24 columns from one factor on the light, which rises to 60 times.
  double off_line(const std::vector<std::string>& more) {
    std::vector<std::string> words{
        "develop",      "--merge", "--out",        "m", "--force",      "--black", "100",
        "--full-scale", "4095",    "--noise-gain", "4", "--read-noise", "2.02",    "--keep-exposures"};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"view_10ms.png", "view_40ms.png"});
    const Ended ended = run(words, folder_.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    const io::Image picture = io::read_picture(folder_ / "m/view.exr"),
                    mask = io::read_picture(folder_ / "m/view-mask.png");
    std::vector<double> ratios;
    for (int block = 0; block < 8; ++block) {
      double sum = 0, truth = 0;
      for (int y = 0; y < 96; ++y)
        for (int x = 24 * block; x < 24 * block + 24; ++x)
          if (mask.at(x, y, 0) > 0.5f) sum += picture.at(x, y, picture.channel("Y")), truth += light(x);
      ratios.push_back(sum / truth);
    }
    const auto [least, most] = std::ranges::minmax(ratios);
    return (most - least) / (most + least);
  }
  static double light(int x) { return 5000 * std::exp(std::log(60.0) * x / 191); }  // linear codes per second
  ScratchFolder folder_;
  std::mt19937_64 random_{11};
};

TEST_F(DevelopLinearity, TheTableOfASeriesMakesTheMergeLinear) {
  constexpr double bend = 0.08;
  const Ended ended = run(write_series(bend), folder_.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("not linear by up to"));
  for (const int ms : {10, 40})
    write(format("view_%dms.png", ms), 192, bend, [&](int x) { return 1e-3 * ms * light(x); });
  EXPECT_GT(off_line({}), 0.02);
  EXPECT_LT(off_line({"--linearity", "s/linearity.csv"}), 0.001);
  // Tables that cannot be, and one that ends too soon.
  for (const auto& [text, says] : {std::pair{"code,linear\n0,0\n100,100\n90,110\n", "bad.csv: has code 90 behind"},
                                   {"code,linear\n0,0\n100,100\n", "bad.csv: ends at code 100"}}) {
    write_file(folder_ / "bad.csv", text);
    const Ended refused = run({"develop", "--merge", "--out", "r", "--linearity", "bad.csv", "--noise-gain", "4",
                               "--black", "100", "--full-scale", "4095", "view_10ms.png"},
                              folder_.path());
    EXPECT_EQ(refused.status, 65);
    EXPECT_THAT(refused.err, HasSubstr(says));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "r/view.exr"));
  }
}

TEST_F(DevelopLinearity, ALinearSensorGetsNoTable) {
  const Ended ended = run(write_series(0), folder_.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("linear as far as can be told"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s/linearity.csv"));
}

}  // namespace
}  // namespace gonio::tests
