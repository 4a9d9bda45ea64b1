// develop --merge behind polarizers as people run it: brackets of a simulated polarization camera in, Stokes vectors
// with their variance out, of a camera that has no polarizers.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/value.h"
#include "photograph/polarizers.h"
#include "process.h"

namespace gonio::tests {
namespace {

constexpr int width = 128, height = 96;
constexpr double black = 64, gain = 4, read_noise = 2;  // codes, electrons per code

std::array<double, 3> light_at(int x, int y) {  // codes per second
  const double s0 = 40000 + 400.0 * x + 200.0 * y;
  return {s0, 0.3 * s0, -0.002 * s0 * y};
}

TEST(DevelopPolarizers, BracketsBecomeStokesVectorsWhoseNoiseIsTrue) {
  ScratchFolder folder;
  std::mt19937_64 random(3);
  std::string files, images;
  for (const int ms : {4, 16, 64}) {
    io::Image picture(width, height, {"Y"});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto [s0, s1, s2] = light_at(x, y);
        const double mean = 1e-3 * ms * photograph::behind_polarizer(s0, s1, s2, photograph::polarizer_angle(x, y)),
                     code = black + std::poisson_distribution<long>(mean * gain)(random) / gain +
                            std::normal_distribution<double>(0, read_noise)(random);
        picture.at(x, y, 0) = static_cast<float>(std::clamp(std::round(code), 0.0, 4095.0) / 65535);
      }
    io::write_png(folder / format("view_%dms.png", ms), picture, 16);
    files += format(R"(%s"f%d": {"path": "view_%dms.png"})", files.empty() ? "" : ", ", ms, ms);
    images += format(R"(%s{"id": "f%d", "file": "f%d", "camera": "c", "group": "view", "exposure_s": %g})",
                     images.empty() ? "" : ", ", ms, ms, 1e-3 * ms);
  }
  write_file(folder / "in.json", R"({"gonio": 1, "files": {)" + files +
                                     R"(}, "cameras": {"c": {"model": "pinhole", "width_px": 128, "height_px": 96,
      "fx_px": 100, "fy_px": 100, "cx_px": 64, "cy_px": 48, "mosaic": "polarizers"}}, "images": [)" +
                                     images + "]}");
  for (const char* how : {"bilinear", "gradient"}) {
    const Ended ended =
        run({"develop", "--merge", "--out", "d", "--force", "--black", "64", "--full-scale", "4095", "--noise-gain",
             "4", "--read-noise", "2.02", "--keep-exposures", "--demosaic", how, "in.json"},
            folder.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
    const manifest::Value made = manifest::parse_json(ended.out, "out");
    ASSERT_EQ(made.find("images")->as_array().size(), 1u);
    EXPECT_EQ(made.find("images")->as_array()[0].find("camera")->as_string(), "c-stokes");
    EXPECT_EQ(made.find("cameras")->find("c-stokes")->find("mosaic"), nullptr);
    EXPECT_EQ(made.find("cameras")->find("c")->find("mosaic")->as_string(), "polarizers");
    const io::Image picture = io::read_picture(folder / "d/view.exr"),
                    mask = io::read_picture(folder / "d/view-mask.png");
    int k = 0;
    for (const char* channel : {"Y", "s1.Y", "s2.Y"}) {
      const int at = picture.channel(channel), variance = picture.channel(std::string("variance.") + channel);
      ASSERT_TRUE(at >= 0 && variance >= 0) << channel;
      double sum = 0, squares = 0, count = 0;
      for (int y = 2; y < height - 2; ++y)
        for (int x = 2; x < width - 2; ++x) {
          if (mask.at(x, y, 0) < 0.5f) continue;
          const double z = (picture.at(x, y, at) - light_at(x, y)[static_cast<std::size_t>(k)]) /
                           std::sqrt(picture.at(x, y, variance));
          sum += z, squares += z * z, ++count;
        }
      EXPECT_GT(count, 0.95 * (width - 4) * (height - 4)) << channel;
      EXPECT_LT(std::abs(sum / count), 4 * std::sqrt(6 / count)) << how << channel;  // six pixels share each sample
      EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 * 6 / count)) << how << channel;
      ++k;
    }
  }
}

}  // namespace
}  // namespace gonio::tests
