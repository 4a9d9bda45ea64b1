// develop --characterize as people run it: frames of a simulated sensor in, its figures and the noise of images out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

constexpr double black = 100, gain = 0.25, read_e = 10, dark_per_s = 30, rate = 1e6;  // codes, code/e, e, e/s, e/s

class DevelopCharacterize : public testing::Test {
 protected:
  // Codes of 12 bits, each `step` in the file.
  void write(const std::string& name, double t, bool lit, double brighter = 1, int side = 96, double step = 1) {
    io::Image picture(side, side, {"Y"});
    for (float& v : picture.data) {
      const double mean = ((lit ? rate * brighter : 0) + dark_per_s) * t,
                   e = static_cast<double>(std::poisson_distribution<long>(mean)(random_)) +
                       std::normal_distribution<double>(0, read_e)(random_);
      v = static_cast<float>(step * std::clamp(std::round(black + gain * e), 0.0, 4095.0) / 65535);
    }
    io::write_png(folder_ / name, picture, 16);
  }
  void write_series(double step = 1) {
    for (const int ms : {2, 4, 7, 10, 12})
      for (int k = 0; k < 2; ++k) write(format("flat_%dms_%d.png", ms, k), 1e-3 * ms, true, 1, 96, step);
    for (const int ms : {2, 2000})
      for (int k = 0; k < 4; ++k) write(format("dark_%dms_%d.png", ms, k), 1e-3 * ms, false, 1, 96, step);
  }
  static std::vector<std::string> lit() {
    std::vector<std::string> words;
    for (const int ms : {2, 4, 7, 10, 12})
      for (int k = 0; k < 2; ++k) words.push_back(format("flat_%dms_%d.png", ms, k));
    return words;
  }
  static std::vector<std::string> dark() {
    std::vector<std::string> words;
    for (const int ms : {2, 2000})
      for (int k = 0; k < 4; ++k) words.insert(words.end(), {"--dark", format("dark_%dms_%d.png", ms, k)});
    return words;
  }
  Ended characterize(std::vector<std::string> words, const std::vector<std::string>& more = {}) const {
    words.insert(words.begin(), {"develop", "--characterize", "--out", "d", "--force", "--log-level", "info"});
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder_.path());
  }
  static std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  // Value and sigma of a figure in the table.
  std::array<double, 2> figure(const std::string& plane, const std::string& name) const {
    std::istringstream csv(read_file(folder_ / "d/sensor.csv"));
    for (std::string line; std::getline(csv, line);)
      if (line.starts_with(plane + "," + name + ",")) {
        double value = 0, sigma = 0;
        const auto unit = line.find(',', plane.size() + name.size() + 2);
        EXPECT_EQ(std::sscanf(line.c_str() + unit, ",%lf,%lf", &value, &sigma), 2) << line;
        return {value, sigma};
      }
    ADD_FAILURE() << plane << " has no " << name;
    return {};
  }
  ScratchFolder folder_;
  std::mt19937_64 random_{17};
};

TEST_F(DevelopCharacterize, FramesBecomeFiguresAndTheNoiseOfImages) {
  write_series();
  const std::vector<std::string> stated{"--black", "100", "--full-scale", "4095", "--mosaic", "RGGB"};
  const Ended ended = characterize(joined(stated, joined(dark(), lit())));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("--noise-gain"));
  for (const char* plane : {"R", "G1", "G2", "B"})
    for (const auto& [name, truth] :
         {std::pair{"system gain", gain}, {"read noise", read_e}, {"dark current", dark_per_s}}) {
      const auto [value, sigma] = figure(plane, name);
      EXPECT_NEAR(value, truth, 4 * sigma) << plane << " " << name;
      EXPECT_LT(sigma, 0.05 * truth) << plane << " " << name;
    }
  const std::string page = read_file(folder_ / "d/sensor.html");
  for (const char* words :
       {"Photon transfer", "Linearity", "Pattern in light", "Samples G2", "full well: the variance grows"})
    EXPECT_THAT(page, HasSubstr(words));
  const manifest::Document d = manifest::parse_document(ended.out, "out", folder_.path());
  ASSERT_EQ(d.images.size(), 18u);
  for (const auto& image : d.images) {
    ASSERT_TRUE(image.noise.has_value()) << image.id;
    EXPECT_NEAR(image.noise->gain, 65535 / gain, 0.03 * 65535 / gain);
    EXPECT_NEAR(image.noise->read, std::hypot(read_e * gain, std::sqrt(1 / 12.0)) / 65535, 0.03 * 2.5 / 65535);
    EXPECT_NEAR(image.saturation.value(), 4094.5 / 65535, 1e-12);
    EXPECT_TRUE(image.response.is_array());  // black taken off
    EXPECT_EQ(image.dark == true, image.id.starts_with("dark"));
  }
  // One exposure alone does not tell its own noise: --merge takes what the images state.
  write_file(folder_ / "noise.json", ended.out);
  const Ended merged =
      run({"develop", "--merge", "--out", "m", "--black", "100", "--full-scale", "4095", "noise.json"}, folder_.path());
  ASSERT_EQ(merged.status, 0) << merged.err;
  const io::Image picture = io::read_picture(folder_ / "m/flat_10ms_0.exr");
  const double codes = gain * rate * 0.01;
  EXPECT_NEAR(picture.at(40, 40, picture.channel("variance.Y")) * 1e-4, codes * gain + 6.3, 0.2 * codes * gain);
}

TEST_F(DevelopCharacterize, AManifestSaysWhatIsDarkAndItsImagesGetTheNoise) {
  write_series();
  std::string files, images;
  for (const std::string& name : joined(lit(), {"dark_2ms_0.png", "dark_2ms_1.png"})) {
    const bool is_dark = name.starts_with("dark");
    files += (files.empty() ? "" : ", ") + format(R"("%s": {"path": "%s"})", name.c_str(), name.c_str());
    const double ms = std::stod(name.substr(5));
    images += (images.empty() ? "" : ", ") + format(R"({"id": "%s", "file": "%s", "exposure_s": %g%s})", name.c_str(),
                                                    name.c_str(), 1e-3 * ms, is_dark ? R"(, "dark": true)" : "");
  }
  write_file(folder_ / "in.json", R"({"gonio": 1, "files": {)" + files + R"(}, "images": [)" + images + "]}");
  const Ended ended = characterize({"--black", "100", "--full-scale", "4095", "in.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = manifest::parse_document(ended.out, "out", folder_.path());
  ASSERT_EQ(d.images.size(), 12u);
  for (const auto& image : d.images) ASSERT_TRUE(image.noise.has_value());
  const auto [value, sigma] = figure("Y", "system gain");
  EXPECT_NEAR(value, gain, 4 * sigma);
  EXPECT_THAT(read_file(folder_ / "d/sensor.html"), HasSubstr("dark current: dark frames of one exposure time"));
}

// Twelve bits in the upper ones of sixteen: steps of 16 codes, and rounding of 256 / 12.
TEST_F(DevelopCharacterize, ShiftedCodesAreRoundedToTheirOwnStep) {
  write_series(16);
  const Ended ended = characterize(joined({"--black", "1600", "--full-scale", "65520"}, joined(dark(), lit())));
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto [value, sigma] = figure("Y", "read noise");
  EXPECT_NEAR(value, read_e, 4 * sigma);
  EXPECT_NEAR(figure("Y", "system gain")[0], 16 * gain, 0.03 * 16 * gain);
  EXPECT_THAT(read_file(folder_ / "d/sensor.html"), HasSubstr("rounding to codes is 21.33"));
}

TEST_F(DevelopCharacterize, WhatDoesNotTellASensorIsRefusedInOneLine) {
  write_series();
  write("small_4ms_0.png", 0.004, true, 1, 94), write("small_4ms_1.png", 0.004, true, 1, 94);
  write("tiny_4ms_0.png", 0.004, true, 1, 24), write("tiny_4ms_1.png", 0.004, true, 1, 24);
  write("drift_5ms_0.png", 0.005, true), write("drift_5ms_1.png", 0.005, true, 1.05);
  write("alone_5ms.png", 0.005, true), write("untimed.png", 0.005, true), write("unlit_6ms_0.png", 0.006, false, 1);
  write("unlit_6ms_1.png", 0.006, false, 1);
  for (const char* name : {"full_80ms_0.png", "full_80ms_1.png", "full_90ms_0.png", "full_90ms_1.png"})
    write(name, 0.09, true);
  write("same_5ms_0.png", 0.005, true);
  std::filesystem::copy_file(folder_ / "same_5ms_0.png", folder_ / "same_5ms_1.png");
  io::Image colours(96, 96, {"R", "G", "B"}), grey(96, 96, {"Y"});
  io::write_png(folder_ / "colours_4ms.png", colours, 16), io::write_png(folder_ / "eight_4ms_0.png", grey, 8);
  write_file(folder_ / "cut_4ms.png", read_file(folder_ / "flat_4ms_0.png").substr(0, 2000));
  const std::vector<std::string> stated{"--black", "100", "--full-scale", "4095"}, good = joined(dark(), lit());
  struct Case {
    std::vector<std::string> words;
    int status;
    const char* says;
  };
  for (const Case& c : std::vector<Case>{
           {joined(stated, lit()), 64, "--dark"},
           {joined(joined(stated, good), {"alone_5ms.png"}), 65, "is the only lit frame of 0.005 s"},
           {joined(stated, joined({"--dark", "dark_2ms_0.png"}, lit())), 65, "is the only dark frame of 0.002 s"},
           {joined(joined(stated, good), {"small_4ms_0.png", "small_4ms_1.png"}), 65, "has 94 x 94 samples"},
           {joined(joined(stated, dark()), {"tiny_4ms_0.png", "tiny_4ms_1.png"}), 65, "40 each way are the least"},
           {joined(joined(stated, good), {"drift_5ms_0.png", "drift_5ms_1.png"}), 65, "differ in brightness by"},
           {joined(joined(stated, good), {"untimed.png"}), 65, "does not say how long it was exposed"},
           {joined(joined(stated, good), {"unlit_6ms_0.png", "unlit_6ms_1.png"}), 65,
            "is no brighter than dark frames"},
           {joined(joined(stated, dark()),
                   {"full_80ms_0.png", "full_80ms_1.png", "full_90ms_0.png", "full_90ms_1.png"}),
            65, "0 exposures up to 70 % of saturation"},
           {joined(joined(stated, good), {"same_5ms_0.png", "same_5ms_1.png"}), 65, "have no noise"},
           {joined(joined(stated, good), {"colours_4ms.png"}), 65, "has 3 channels"},
           {joined(joined(stated, good), {"eight_4ms_0.png"}), 65, "said to be full at 4095"},
           {joined({"--black", "100", "--full-scale", "1023"}, good), 65, "beyond full scale"},
           {joined({"--black", "100", "--full-scale", "70000"}, good), 65, "said to be full at 70000"},
           {joined({"--black", "100", "--full-scale", "90"}, good), 65, "is full at code 90, and black is 100"},
           {joined(joined(stated, good), {"cut_4ms.png"}), 65, "cut_4ms.png"},
           {joined(joined(stated, good), {"nowhere_4ms.png"}), 66, "nowhere_4ms.png"},
           {joined({"--merge"}, good), 64, "--merge"},
           {{"--black", "100"}, 66, "has no frames of even light"}}) {
    const Ended ended = characterize(c.words);
    EXPECT_EQ(ended.status, c.status) << c.says << ": " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(c.says));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "d/sensor.html")) << c.says;
  }
  const std::vector<std::string> words = joined(joined({"develop", "--characterize"}, stated), good);
  EXPECT_EQ(run(words, folder_.path()).status, 64);  // no --out
}

}  // namespace
}  // namespace gonio::tests
