// develop --merge as people run it: raw frames of a simulated camera in, radiance with its variance out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/dng_writer.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

constexpr int width = 96, height = 64;
constexpr double black = 256, gain = 4, read_noise = 3;

// Smooth light over two decades, another for each colour of RGGB; codes per second.
double rate_at(int x, int y, int colour) {
  return 2000 * std::pow(10.0, 2.0 * x / width) * (1 + 0.3 * colour) * (1 + 0.2 * y / height);
}
int colour_at(int x, int y) {
  return (x & 1) + (y & 1);
}

class DevelopMerge : public testing::Test {
 protected:
  Dng frame(double exposure_s, std::uint64_t seed, double dark_per_s = 0, bool lit = true) const {
    Dng dng;
    dng.width = width, dng.height = height;
    dng.exposure_us = static_cast<std::uint32_t>(std::lround(exposure_s * 1e6));
    std::mt19937_64 random(seed);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        // A hot sample, and dark current that grows to one side.
        const double dark = x == 40 && y == 30 ? 50 * dark_per_s : dark_per_s * x / width;
        const double mean = ((lit ? rate_at(x, y, colour_at(x, y)) : 0) + dark) * exposure_s;
        const double code = black + std::poisson_distribution<long>(mean * gain)(random) / gain +
                            std::normal_distribution<double>(0, read_noise)(random);
        dng.samples.push_back(static_cast<std::uint16_t>(std::clamp(std::round(code), 0.0, 4095.0)));
      }
    return dng;
  }
  void write(const std::string& name, const Dng& dng) const { write_file(folder_ / name, bytes_of(dng)); }
  void write_bracket() const {
    for (const int ms : {1, 4, 16, 64, 256})
      write(format("wall_%dms.dng", ms), frame(1e-3 * ms, static_cast<std::uint64_t>(ms)));
  }
  Ended merge(std::vector<std::string> words) const {
    words.insert(words.begin(),
                 {"develop", "--merge", "--out", "d", "--force", "--log-level", "info", "--black", "256"});
    return run(words, folder_.path());
  }
  manifest::Document document(const Ended& ended) const {
    return manifest::parse_document(ended.out, "out", folder_.path());
  }
  // Of samples as they were measured, which are independent: mean and mean square of (found - true) / sigma.
  std::array<double, 2> scores(const io::Image& picture, const io::Image& mask) const {
    double sum = 0, squares = 0, count = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int c = colour_at(x, y);
        if (mask.at(x, y, 0) < 0.5f) continue;
        const double z = (picture.at(x, y, c) - rate_at(x, y, c)) / std::sqrt(picture.at(x, y, 3 + c));
        sum += z, squares += z * z, ++count;
      }
    EXPECT_GT(count, 0.9 * width * height);
    return {sum / count * std::sqrt(count), (squares / count - 1) * std::sqrt(count / 2)};
  }
  ScratchFolder folder_;
};

TEST_F(DevelopMerge, ABracketBecomesRadianceWhoseNoiseIsTrue) {
  write_bracket();
  for (const bool stated : {true, false}) {
    std::vector<std::string> words = {"wall_1ms.dng", "wall_4ms.dng", "wall_16ms.dng", "wall_64ms.dng",
                                      "wall_256ms.dng"};
    if (stated) words.insert(words.begin(), {"--noise-gain", "4", "--read-noise", "3.01", "--keep-exposures"});
    const Ended ended = merge(words);
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("wall: 5 exposures"));
    ASSERT_EQ(document(ended).images.size(), 1u);
    EXPECT_EQ(document(ended).images[0].id, "wall");
    const io::Image read = io::read_picture(folder_ / "d/wall.exr");
    io::Image picture(read.width, read.height, {"R", "G", "B", "variance.R", "variance.G", "variance.B"});
    for (std::size_t c = 0; c < picture.channels.size(); ++c)
      for (std::size_t i = 0; i < picture.pixels(); ++i)
        picture.data[i * 6 + c] =
            read.data[i * read.channels.size() + static_cast<std::size_t>(read.channel(picture.channels[c]))];
    const auto [mean, square] = scores(picture, io::read_picture(folder_ / "d/wall-mask.png"));
    // Standard normal each; exposures that are refined share an error of some hundredths of a per cent.
    EXPECT_LT(std::abs(mean), stated ? 4 : 12);
    EXPECT_LT(std::abs(square), stated ? 4 : 6);
  }
}

TEST_F(DevelopMerge, DarkFramesTakeDarkCurrentOffAndFindHotSamples) {
  constexpr double dark = 400;
  for (const int ms : {16, 64, 256})
    write(format("wall_%dms.dng", ms), frame(1e-3 * ms, static_cast<std::uint64_t>(ms), dark));
  for (int k = 0; k < 8; ++k)
    for (const int ms : {64, 256})
      write(format("dark%d_%dms.dng", k, ms), frame(1e-3 * ms, static_cast<std::uint64_t>(100 * ms + k), dark, false));
  std::vector<std::string> words = {"--noise-gain", "4", "--read-noise", "3.01", "--keep-exposures"};
  for (int k = 0; k < 8; ++k)
    for (const int ms : {64, 256}) words.insert(words.end(), {"--dark", format("dark%d_%dms.dng", k, ms)});
  words.insert(words.end(), {"wall_16ms.dng", "wall_64ms.dng", "wall_256ms.dng"});
  ASSERT_EQ(merge(words).status, 0);
  const io::Image picture = io::read_picture(folder_ / "d/wall.exr"),
                  mask = io::read_picture(folder_ / "d/wall-mask.png");
  EXPECT_EQ(mask.at(40, 30, 0), 0);
  double off = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 60; x < 70; ++x) off += picture.at(x, y, colour_at(x, y)) / rate_at(x, y, colour_at(x, y)) - 1;
  EXPECT_LT(std::abs(off / (height * 10)), 2e-3);
}

// Images of one group are exposures of one view; those without light are dark frames. What comes out takes their place.
TEST_F(DevelopMerge, AManifestSaysWhatBelongsTogether) {
  write_bracket();
  write("dark.dng", frame(0.064, 77, 0, false));
  write_file(folder_ / "in.json",
             R"({"gonio": 1, "files": {"a": {"path": "wall_4ms.dng"}, "b": {"path": "wall_64ms.dng"},
    "d": {"path": "dark.dng"}}, "cameras": {"c": {"model": "pinhole", "width_px": 96, "height_px": 64, "fx_px": 100,
    "fy_px": 100, "cx_px": 48, "cy_px": 32, "mosaic": "RGGB"}}, "lights": {"lamp": {"model": "directional",
    "towards": [0, 0, 1], "watt_per_m2": 1}}, "images": [
    {"id": "a", "file": "a", "camera": "c", "group": "view", "exposure_s": 0.004, "light": "lamp"},
    {"id": "b", "file": "b", "camera": "c", "group": "view", "exposure_s": 0.064, "light": "lamp"},
    {"id": "d", "file": "d", "camera": "c", "dark": true, "exposure_s": 0.064}]})");
  const Ended ended = merge({"in.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = document(ended);
  ASSERT_EQ(d.images.size(), 1u);
  EXPECT_EQ(d.images[0].id, "view");
  EXPECT_EQ(d.images[0].camera, "c");
  EXPECT_EQ(d.images[0].light, std::vector<std::string>{"lamp"});
  EXPECT_FALSE(d.images[0].exposure_s.has_value());
}

// Each pixel says which exposures it is from: behind filters all that its colours are from, and none where all were
// full.
TEST_F(DevelopMerge, EachPixelSaysWhichExposuresItIsFrom) {
  write_bracket();
  const std::vector<int> ms{1, 4, 16, 64, 256};
  for (const bool mono : {true, false}) {
    std::vector<std::string> words = {"--noise-gain",     "4",        "--read-noise",        "3.01",
                                      "--keep-exposures", "--mosaic", mono ? "Mono" : "RGGB"};
    for (const int k : ms) words.push_back(format("wall_%dms.dng", k));
    ASSERT_EQ(merge(words).status, 0);
    const io::Image picture = io::read_picture(folder_ / "d/wall.exr");
    const int shortest = picture.channel("exposure.shortest"), longest = picture.channel("exposure.longest");
    const auto is_full = [&](const Dng& f, int x, int y) {
      return f.samples[static_cast<std::size_t>(y * width + x)] >= 4095;
    };
    std::vector<Dng> frames;
    for (const int k : ms) frames.push_back(frame(1e-3 * k, static_cast<std::uint64_t>(k)));
    for (int y = 2; y < height - 2; ++y)
      for (int x = 2; x < width - 2; ++x) {
        ASSERT_FLOAT_EQ(picture.at(x, y, shortest), 0.001f);
        double longest_own = 0;  // with no full sample beside
        for (std::size_t k = 0; k < ms.size(); ++k) {
          bool near = false;
          for (int v = y - 1; v <= y + 1; ++v)
            for (int u = x - 1; u <= x + 1; ++u) near |= is_full(frames[k], u, v);
          if (!near) longest_own = 1e-3 * ms[k];
        }
        if (mono)
          ASSERT_FLOAT_EQ(picture.at(x, y, longest), static_cast<float>(longest_own)) << x << " " << y;
        else
          ASSERT_GE(picture.at(x, y, longest), static_cast<float>(longest_own) * (1 - 1e-6f)) << x << " " << y;
      }
  }
  Dng full = frame(0.001, 1);
  std::ranges::fill(full.samples, std::uint16_t{4095});
  full.samples[0] = 300;  // no file of one code alone
  write("full_1ms.dng", full);
  const Ended ended = merge({"--noise-gain", "4", "full_1ms.dng"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const io::Image picture = io::read_picture(folder_ / "d/full.exr");
  for (const char* channel : {"exposure.shortest", "exposure.longest"})
    EXPECT_EQ(picture.at(9, 9, picture.channel(channel)), 0);
}

// The manifest says what was done, and what must not be done twice is refused.
TEST_F(DevelopMerge, WhatWasDoneStandsInTheManifest) {
  write_bracket();
  write("dark_64ms.dng", frame(0.064, 77, 0, false)), write("flat_1ms.dng", frame(0.001, 78));
  const auto words_of = [&](const Ended& ended) {
    EXPECT_EQ(ended.status, 0) << ended.err;
    std::vector<std::string> words;
    const manifest::Document made = document(ended);
    for (const manifest::DevelopedStep& s : made.images.at(0).developed)
      words.push_back(s.step + (s.by.empty() ? "" : ":" + s.by) + (s.frames ? format("*%d", int(*s.frames)) : ""));
    return words;
  };
  const std::vector<std::string> noise = {"--noise-gain", "4", "--read-noise", "3.01"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), noise.begin(), noise.end());
    return merge(words);
  };
  const Ended all = with({"--dark", "dark_64ms.dng", "--flat", "flat_1ms.dng", "--flat", "wall_1ms.dng", "--demosaic",
                          "bilinear", "wall_4ms.dng", "wall_16ms.dng", "wall_64ms.dng"});
  EXPECT_EQ(words_of(all), (std::vector<std::string>{"black", "dark*1", "defects", "exposure-times", "merge*3",
                                                     "flat*2", "demosaic:bilinear"}));
  const manifest::DevelopedStep merged = document(all).images[0].developed[4];
  ASSERT_EQ(merged.exposures_s.size(), 3u);
  EXPECT_NEAR(merged.exposures_s[0], 0.004, 1e-4);
  ASSERT_EQ(merged.sigma.at("exposures_s").size(), 3u);
  EXPECT_EQ(std::ranges::count(merged.sigma.at("exposures_s"), 0.0), 1);  // the unit
  const Ended plain = with({"--keep-exposures", "--mosaic", "Mono", "wall_16ms.dng"});
  EXPECT_EQ(words_of(plain), (std::vector<std::string>{"black", "merge*1"}));
  EXPECT_EQ(document(plain).images[0].developed[1].exposures_s, std::vector<double>{0.016});
  // A picture of one channel would pass for a frame.
  write_file(folder_ / "done.json", plain.out);
  const Ended again = with({"done.json"});
  EXPECT_EQ(again.status, 65);
  EXPECT_THAT(again.err, HasSubstr("is no raw frame any more (developed: black, merge)"));
}

TEST_F(DevelopMerge, BracketsInSequenceEndWhereAnExposureComesAgain) {
  for (int k = 0; k < 4; ++k)
    write(format("IMG_%d.dng", k), frame(k % 2 == 0 ? 0.004 : 0.016, static_cast<std::uint64_t>(k)));
  const Ended ended = merge({"IMG_0.dng", "IMG_1.dng", "IMG_2.dng", "IMG_3.dng"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = document(ended);
  ASSERT_EQ(d.images.size(), 2u);
  EXPECT_EQ(d.images[0].id, "IMG_0");
  EXPECT_EQ(d.images[1].id, "IMG_2");
}

TEST_F(DevelopMerge, WhatCannotBeMergedIsRefusedInOneLine) {
  write_bracket();
  Dng small = frame(0.004, 1);
  small.height -= 2,
      small.samples.resize(static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height));
  write("small_4ms.dng", small), write("wall_9ms.dng", small), write("cut_4ms.dng", frame(0.004, 1));
  write_file(folder_ / "cut_4ms.dng", bytes_of(small).substr(0, 3000));
  io::Image colours(8, 8, {"R", "G", "B"}), grey(8, 8, {"Y"});
  io::write_png(folder_ / "colours_4ms.png", colours, 16);
  io::write_png(folder_ / "grey.png", grey, 16);
  write_file(folder_ / "apertures.json",
             R"({"gonio": 1, "files": {"a": {"path": "wall_4ms.dng"}, "b": {"path": "wall_64ms.dng"}}, "images": [
    {"id": "a", "file": "a", "group": "view", "exposure_s": 0.004, "f_number": 2.8},
    {"id": "b", "file": "b", "group": "view", "exposure_s": 0.064, "f_number": 4}]})");
  struct Case {
    std::vector<std::string> words;
    int status;
    const char* says;
  };
  for (const Case& c : std::vector<Case>{
           {{"wall_1ms.dng", "wall_9ms.dng"}, 65, "the view's first frame 96 x 64"},
           {{"apertures.json"}, 65, "/images/1/f_number: is 4, and that of its view's first image, a, is 2.8"},
           {{"cut_4ms.dng"}, 65, "cut_4ms.dng"},
           {{"nowhere_4ms.dng"}, 66, "nowhere_4ms.dng"},
           {{"colours_4ms.png"}, 65, "has 3 channels: it is no sensor's picture"},
           {{"grey.png", "wall_1ms.dng"}, 65, "does not say how long it was exposed"},
           {{"--views", "names", "grey.png"}, 65, "has no exposure in its name"},
           {{"wall_4ms.dng"}, 65, "does not tell its own noise"},
           {{"--full-scale", "200", "wall_4ms.dng", "wall_16ms.dng"}, 65, "is full at code 200, and black is 256"},
           {{"--mosaic", "RGBG", "wall_4ms.dng"}, 64, "choose one of Mono, RGGB, GRBG, GBRG, BGGR"},
           {{"--dark", "small_4ms.dng", "wall_4ms.dng", "wall_16ms.dng"}, 65, "is of another size than the dark"},
           {{"--flat", "wall_256ms.dng", "wall_4ms.dng", "wall_16ms.dng"}, 65, "expose flat frames to half"},
           {{"--read-noise", "3", "wall_4ms.dng", "wall_16ms.dng"}, 64, "--noise-gain"}}) {
    const Ended ended = merge(c.words);
    EXPECT_EQ(ended.status, c.status) << c.words[0] << ": " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(c.says));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "d/wall.exr"));
  }
  EXPECT_EQ(run({"develop", "--merge", "wall_4ms.dng"}, folder_.path()).status, 64);  // no --out
}

}  // namespace
}  // namespace gonio::tests
