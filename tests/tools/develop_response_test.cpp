// develop --find-response as people run it: exposures of one view in pictures of 8 bits in, the response of the images
// out; and recorded film scans against their published radiance map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/value.h"
#include "photograph/linear_picture.h"
#include "process.h"
#include "stats/intervals.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class DevelopResponse : public testing::Test {
 protected:
  static double light(int x, int y) {
    return 0.02 * std::exp(std::log(500.0) * x / 199) * (1 + 0.3 * std::sin(0.1 * y));
  }
  // By a camera that is sRGB's; each exposure with noise of a code.
  void write(const std::string& name, double exposure_s, int channels = 3, int width = 200) {
    std::normal_distribution<double> normal;
    io::Image picture(width, 120,
                      channels == 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"});
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < channels; ++c) {
          const auto linear = static_cast<float>(std::min(1.0, light(x, y) * exposure_s * (1 - 0.2 * c)));
          picture.at(x, y, c) =
              static_cast<float>(std::clamp(io::srgb_from_linear(linear) + normal(random_) / 255, 0.0, 1.0));
        }
    io::write_png(folder_ / name, picture, 8);
  }
  Ended find(std::vector<std::string> words) const {
    words.insert(words.begin(), {"develop", "--find-response", "--out", "r", "--force", "--log-level", "info"});
    return run(words, folder_.path());
  }
  static manifest::Value::Array images_of(const Ended& ended) {
    return manifest::parse_json(ended.out, "out").find("images")->as_array();
  }
  ScratchFolder folder_;
  std::mt19937_64 random_{5};
};

TEST_F(DevelopResponse, ExposuresBecomeTheImagesResponse) {
  for (const int channels : {3, 1}) {
    std::vector<std::string> words{"--shutter-error", "0"};
    for (const int ms : {25, 50, 100, 200, 400, 800, 1600}) {
      write(format("wall_%dms.png", ms), 1e-3 * ms, channels);
      words.push_back(format("wall_%dms.png", ms));
    }
    const Ended ended = find(words);
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("exponent uncertain by"));
    EXPECT_THAT(read_file(folder_ / "r/response.csv"), HasSubstr("channel,code,linear,sigma,seen\n"));
    EXPECT_THAT(read_file(folder_ / "r/response-times.csv"), HasSubstr("stated_s,found_s,sigma_s\n0.025,0.025,0\n"));
    const auto made = images_of(ended);
    ASSERT_EQ(made.size(), 7u);
    // Read by it, each channel is linear in the light: one factor over codes from a tenth to nine.
    for (const std::size_t i : {2u, 4u}) {
      EXPECT_EQ(made[i].find("group")->as_string(), "wall");
      const std::string name = format("wall_%gms.png", 1e3 * made[i].find("exposure_s")->as_number());
      const auto picture = photograph::read_linear(folder_ / name, *made[i].find("response"), "test");
      const io::Image codes = io::read_picture(folder_ / name);
      for (int c = 0; c < channels; ++c) {
        std::vector<double> dark, bright;
        for (int y = 0; y < 120; ++y)
          for (int x = 0; x < 200; ++x) {
            const double code = codes.at(x, y, c), ratio = picture.colour.at(x, y, c) / light(x, y);
            if (code > 0.2 && code < 0.4) dark.push_back(ratio);
            if (code > 0.7 && code < 0.9) bright.push_back(ratio);
          }
        EXPECT_NEAR(stats::mean(dark) / stats::mean(bright), 1, 0.005) << name << " " << c;
      }
    }
  }
}

TEST_F(DevelopResponse, WhatTellsNoResponseIsRefusedInOneLine) {
  for (const int ms : {50, 100, 200}) write(format("wall_%dms.png", ms), 1e-3 * ms);
  write("small_100ms.png", 0.1, 3, 100), write("wall_400ms.png", 0.4, 3, 100), write("grey_100ms.png", 0.1, 1);
  write("untimed.png", 0.1);
  io::write_picture(folder_ / "wall_20ms.exr", io::Image(8, 8, {"Y"}));
  write_file(folder_ / "cut_20ms.png", read_file(folder_ / "wall_50ms.png").substr(0, 900));
  write_file(folder_ / "lone.json", R"({"gonio": 1, "files": {"a": {"path": "wall_50ms.png"}},
    "images": [{"id": "a", "file": "a", "exposure_s": 0.05}]})");
  write_file(folder_ / "apertures.json",
             R"({"gonio": 1, "files": {"a": {"path": "wall_50ms.png"}, "b": {"path": "wall_100ms.png"}},
    "images": [{"id": "a", "file": "a", "group": "v", "exposure_s": 0.05, "f_number": 2.8},
               {"id": "b", "file": "b", "group": "v", "exposure_s": 0.1}]})");
  write_file(folder_ / "untimed.json", R"({"gonio": 1, "files": {"a": {"path": "wall_50ms.png"}},
    "images": [{"id": "a", "file": "a", "group": "v"}]})");
  struct Case {
    std::vector<std::string> words;
    int status;
    const char* says;
  };
  for (const Case& c :
       std::vector<Case>{{{"wall_50ms.png"}, 65, "are all of one time"},
                         {{"wall_50ms.png", "wall_400ms.png"}, 65, "has 100 x 120 pixels"},
                         {{"wall_50ms.png", "wall_100ms.png", "grey_100ms.png"}, 65, "has other channels"},
                         {{"untimed.png", "wall_50ms.png"}, 65, "untimed.png: does not say how long it was exposed"},
                         {{"wall_20ms.exr", "wall_50ms.png"}, 65, "linear already"},
                         {{"cut_20ms.png", "wall_50ms.png"}, 65, "cut_20ms.png"},
                         {{"nowhere_20ms.png", "wall_50ms.png"}, 66, "nowhere_20ms.png"},
                         {{"lone.json"}, 66, "has no exposures of one view"},
                         {{"apertures.json"}, 65, "/images/1/f_number: is missing, and that of its view's first image"},
                         {{"untimed.json"}, 65, "does not say how long it was exposed"},
                         {{"--shutter-error", "2", "wall_50ms.png"}, 64, "--shutter-error"},
                         {{"--merge", "wall_50ms.png", "wall_100ms.png"}, 64, "--merge"},
                         {{}, 66, "has no photographs"}}) {
    const Ended ended = find(c.words);
    EXPECT_EQ(ended.status, c.status) << c.says << ": " << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(c.says));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "r/response.csv")) << c.says;
  }
}

// A JPEG as a camera writes it: exposure time, aperture and sensitivity in front of the picture.
void write_jpeg(const std::filesystem::path& path, std::uint32_t exposure_us, std::uint32_t f_tenths,
                std::uint16_t iso) {
  const std::string picture = [&] {
    std::vector<unsigned char> bytes;
    cv::Mat grey(120, 200, CV_8UC3);
    for (int y = 0; y < grey.rows; ++y)
      for (int x = 0; x < grey.cols; ++x) {
        const double light = 0.02 * std::exp(std::log(500.0) * x / 199) * (1 + 0.3 * std::sin(0.1 * y));
        const double code = 255 * io::srgb_from_linear(static_cast<float>(std::min(1.0, light * 1e-6 * exposure_us)));
        grey.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<unsigned char>(code));
      }
    cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, 100});
    return std::string(bytes.begin(), bytes.end());
  }();
  std::string exif("Exif\0\0II*\0\x08\0\0\0", 14);
  const auto put = [&exif](std::uint64_t value, int bytes) {
    for (int k = 0; k < bytes; ++k) exif += static_cast<char>(value >> (8 * k) & 255);
  };
  const auto entry = [&put](std::uint32_t tag, std::uint32_t format, std::uint32_t value) {
    put(tag, 2), put(format, 2), put(1, 4), put(value, 4);
  };
  put(1, 2), entry(0x8769, 4, 26), put(0, 4);  // a directory that says where the camera's own is, 26 bytes behind "II"
  put(3, 2), entry(0x829A, 5, 68), entry(0x829D, 5, 76), entry(0x8827, 3, iso), put(0, 4);
  put(exposure_us, 4), put(1000000, 4), put(f_tenths, 4), put(10, 4);
  const std::size_t length = exif.size() + 2;
  write_file(path, picture.substr(0, 2) + "\xFF\xE1" + static_cast<char>(length >> 8) +
                       static_cast<char>(length & 255) + exif + picture.substr(2));
}

TEST_F(DevelopResponse, ExposuresStandInTheCamerasFiles) {
  std::vector<std::string> words;
  for (const std::uint32_t ms : {25, 100, 400, 1600}) {
    words.push_back(format("IMG_%u.jpg", 1000 + ms));
    write_jpeg(folder_ / words.back(), 1000 * ms, 56, 200);
  }
  const Ended ended = find(words);
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto made = images_of(ended);
  ASSERT_EQ(made.size(), 4u);
  EXPECT_EQ(made[2].find("exposure_s")->as_number(), 0.4);
  EXPECT_EQ(made[2].find("group")->as_string(), made[0].find("group")->as_string());
  write_file(folder_ / "in.json", R"({"gonio": 1, "files": {"a": {"path": "IMG_1025.jpg"}, "b": {"path":
    "IMG_1100.jpg"}, "c": {"path": "IMG_1400.jpg"}}, "images": [{"id": "a", "file": "a", "group": "v"},
    {"id": "b", "file": "b", "group": "v"}, {"id": "c", "file": "c", "group": "v"}]})");
  const Ended listed = find({"in.json"});
  ASSERT_EQ(listed.status, 0) << listed.err;
  EXPECT_EQ(images_of(listed)[1].find("exposure_s")->as_number(), 0.1);

  write_jpeg(folder_ / words[1], 100000, 80, 200);
  EXPECT_THAT(find(words).err, HasSubstr("IMG_1100.jpg: was taken at f/8, and others of its view at 5.6"));
  write_jpeg(folder_ / words[1], 100000, 56, 800);
  EXPECT_THAT(find(words).err, HasSubstr("IMG_1100.jpg: was taken at ISO 800, and others of its view at 200"));
  write_jpeg(folder_ / words[1], 0, 56, 200);
  EXPECT_THAT(find(words).err, HasSubstr("IMG_1100.jpg: does not say how long it was exposed"));
}

// Three JPEGs of a camera with exposures of 1/10, 1/40 and 1/160 s in them: their codes say the same times to 2 %.
TEST_F(DevelopResponse, RecordedBracketIsReadByItsExif) {
  GONIO_NEEDS_DATA("light-probe/a6400_ball");
  const Ended ended = find({data("light-probe/a6400_ball/raw1.jpg"), data("light-probe/a6400_ball/raw2.jpg"),
                            data("light-probe/a6400_ball/raw3.jpg")});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto made = images_of(ended);
  ASSERT_EQ(made.size(), 3u);
  for (const auto& [k, stated] : {std::pair{0, 0.1}, {1, 0.025}, {2, 0.00625}})
    EXPECT_EQ(made[static_cast<std::size_t>(k)].find("exposure_s")->as_number(), stated);
}

// Median departure from the published map, after a factor for each channel, of means over exposures whose codes lie
// from a tenth to nine: 1.9, 3.1 and 6.7 % (R, G, B) were measured, and 4.2, 6.1 and 7.3 % of OpenCV's calibrateDebevec
// with mergeDebevec.
TEST_F(DevelopResponse, RecordedFilmScansGiveTheirPublishedMap) {
  GONIO_NEEDS_DATA("hdr/memorial");
  const auto folder = data("hdr/memorial");
  std::string files, images;
  std::vector<std::string> names;
  std::vector<double> times;
  std::ifstream list(folder / "list.txt");
  std::string file;
  for (double seconds = 0; list >> file >> seconds;) {
    files += (files.empty() ? "" : ", ") + format(R"("%s": {"path": "%s"})", file.c_str(), (folder / file).c_str());
    images +=
        (images.empty() ? "" : ", ") + format(R"({"id": "%s", "file": "%s", "group": "church", "exposure_s": %g})",
                                              file.c_str(), file.c_str(), seconds);
    names.push_back(file), times.push_back(seconds);
  }
  write_file(folder_ / "in.json", R"({"gonio": 1, "files": {)" + files + R"(}, "images": [)" + images + "]}");
  const Ended ended = find({"--allow-outside", "in.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto made = images_of(ended);
  ASSERT_EQ(made.size(), names.size());
  const cv::Mat published = cv::imread((folder / "memorial.hdr").string(), cv::IMREAD_ANYDEPTH | cv::IMREAD_COLOR);
  std::vector<double> sum(static_cast<std::size_t>(published.rows * published.cols * 3)), weight(sum.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const io::Image codes = io::read_picture(folder / names[k]);
    const auto linear = photograph::read_linear(folder / names[k], *made[k].find("response"), "test");
    for (std::size_t i = 0; i < sum.size(); ++i) {
      if (codes.data[i] < 0.1f || codes.data[i] > 0.9f) continue;
      const double w = std::min<double>(codes.data[i], 1 - codes.data[i]);
      sum[i] += w * linear.colour.data[i] / times[k], weight[i] += w;
    }
  }
  constexpr std::array limits{0.025, 0.04, 0.075};
  for (int c = 0; c < 3; ++c) {
    std::vector<double> off;
    for (int y = 30; y < published.rows - 30; ++y)
      for (int x = 30; x < published.cols - 30; ++x) {
        const auto i = static_cast<std::size_t>(3 * (y * published.cols + x) + c);
        const double theirs = published.at<cv::Vec3f>(y, x)[2 - c];
        if (weight[i] > 0 && theirs > 0) off.push_back(std::log(sum[i] / weight[i] / theirs));
      }
    const double middle = stats::median(off);
    for (double& v : off) v = std::abs(v - middle);
    EXPECT_GT(off.size(), 300000u);
    RecordProperty(format("median_%d", c), format("%.4f", stats::median(off)));
    EXPECT_LT(stats::median(off), limits[static_cast<std::size_t>(c)]) << c;
    EXPECT_LT(stats::quantile(off, 0.9), 0.35) << c;
  }
}

}  // namespace
}  // namespace gonio::tests
