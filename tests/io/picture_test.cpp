// Round trips, determinism and damaged files of every picture format.
#include "io/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/exr.h"

namespace gonio::io {
namespace {

Image random_image(int width, int height, std::vector<std::string> channels, std::uint64_t seed) {
  Random random(seed);
  Image image(width, height, std::move(channels));
  for (auto& v : image.data) v = static_cast<float>(std::exp(4 * random.normal()) - 0.1);
  return image;
}

void expect_data_error(const std::filesystem::path& path, const std::string& what) {
  try {
    read_picture(path);
    ADD_FAILURE() << what << " was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data) << what << ": " << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_THAT(error.place(), testing::EndsWith(path.filename().string()));
  }
}

// The first 10 %, 20 %, ... of a file, and all but its last byte: each must be refused in one line.
void expect_truncations_refused(const std::filesystem::path& whole) {
  const std::string bytes = read_file(whole);
  const auto cut = whole.parent_path() / ("cut" + whole.extension().string());
  for (int tenth = 0; tenth < 10; ++tenth) {
    write_file(cut, bytes.substr(0, bytes.size() * static_cast<std::size_t>(tenth) / 10));
    expect_data_error(cut, whole.extension().string() + " cut at " + std::to_string(tenth) + "0 %");
  }
  write_file(cut, bytes.substr(0, bytes.size() - 1));
  expect_data_error(cut, whole.extension().string() + " without its last byte");
}

TEST(Exr, RoundTripIsExactAndNamesArePreserved) {
  const tests::ScratchFolder folder;
  for (const auto& [width, height] : {std::pair{1, 1}, {17, 5}, {200, 131}}) {
    Image image = random_image(width, height, {"R", "G", "B", "normal.x", "variance.R"}, 3);
    image.data[0] = std::numeric_limits<float>::infinity();
    write_picture(folder / "a.exr", image);
    const Image back = read_picture(folder / "a.exr");
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_EQ(back.channels, image.channels);
    EXPECT_EQ(back.data, image.data);
  }
}

TEST(Exr, ChannelsComeAlphabeticallyBehindRgb) {
  const tests::ScratchFolder folder;
  const Image image = random_image(3, 2, {"Z", "B", "A", "G", "R"}, 3);
  write_picture(folder / "a.exr", image);
  const Image back = read_picture(folder / "a.exr");
  EXPECT_THAT(back.channels, testing::ElementsAre("R", "G", "B", "A", "Z"));
  EXPECT_EQ(back.at(2, 1, 4), image.at(2, 1, 0));
}

TEST(Exr, SamePixelsGiveTheSameBytes) {
  const tests::ScratchFolder folder;
  const Image image = random_image(64, 64, {"R", "G", "B"}, 4);
  write_picture(folder / "a.exr", image);
  write_picture(folder / "b.exr", image);
  EXPECT_EQ(read_file(folder / "a.exr"), read_file(folder / "b.exr"));
}

TEST(Exr, TruncationIsRefused) {
  const tests::ScratchFolder folder;
  write_picture(folder / "a.exr", random_image(90, 70, {"R", "G", "B"}, 5));
  expect_truncations_refused(folder / "a.exr");
}

TEST(Exr, AnySingleDamagedByteIsHandled) {
  const std::string bytes = encode_exr(random_image(20, 20, {"R", "G", "B"}, 6));
  Random random(7);
  for (int k = 0; k < 500; ++k) {
    std::string damaged = bytes;
    damaged[random.below(static_cast<std::uint32_t>(std::min<std::size_t>(bytes.size(), 600)))] =
        static_cast<char>(random.below(256));
    try {
      decode_exr(damaged, "damaged.exr");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
    }
  }
}

TEST(Exr, AHugeEntryOfTheHeadIsRefusedBeforeAnythingIsAllocated) {
  const tests::ScratchFolder folder;
  write_picture(folder / "a.exr", random_image(16, 16, {"R", "G", "B"}, 8));
  for (const std::int32_t length : {2147483647, -1, 100000}) {
    std::string bytes = read_file(folder / "a.exr");
    std::memcpy(bytes.data() + bytes.find("compression", bytes.find("compression") + 1) + 12, &length, 4);
    try {
      decode_exr(bytes, "b.exr");
      ADD_FAILURE() << length;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_THAT(error.problem(), testing::HasSubstr("claims " + std::to_string(length) + " bytes"));
    }
  }
}

TEST(Exr, AHugeWindowIsRefusedBeforeAnythingIsAllocated) {
  const tests::ScratchFolder folder;
  write_picture(folder / "a.exr", random_image(16, 16, {"R", "G", "B"}, 8));
  const std::string bytes = read_file(folder / "a.exr");
  for (const std::int32_t last : {99999, 2000000, 2147483646}) {
    std::string damaged = bytes;
    for (const char* name : {"dataWindow", "displayWindow"}) {
      const auto at = damaged.find("box2i", damaged.find(name)) + 6 + 4 + 8;  // type and NUL, size, xMin yMin
      std::memcpy(damaged.data() + at, &last, 4);
      std::memcpy(damaged.data() + at + 4, &last, 4);
    }
    write_file(folder / "b.exr", damaged);
    expect_data_error(folder / "b.exr", "a side of " + std::to_string(last) + " pixels");
  }
}

TEST(Picture, RefusalsAreTold) {
  const tests::ScratchFolder folder;
  write_file(folder / "a.exr", "not an EXR file");
  write_file(folder / "a.png", "not a PNG file");
  write_file(folder / "a.jpg", "");
  write_file(folder / "a.gif", "GIF89a");
  for (const char* name : {"a.exr", "a.png", "a.jpg", "a.gif"}) expect_data_error(folder / name, name);
  EXPECT_THROW(write_picture(folder / "a.gif", Image(1, 1, {"Y"})), Error);
  try {
    read_picture(folder / "none.exr");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::no_input);
  }
}

TEST(Raster, CodesOverFullScaleInBothDepths) {
  const tests::ScratchFolder folder;
  cv::Mat shallow(2, 3, CV_8UC3), deep(2, 3, CV_16UC3), grey(2, 3, CV_16U);
  for (int i = 0; i < 6; ++i) {
    shallow.at<cv::Vec3b>(i) = {10, 20, static_cast<std::uint8_t>(40 * i)};
    deep.at<cv::Vec3w>(i) = {1, 2000, static_cast<std::uint16_t>(13107 * i)};
    grey.at<std::uint16_t>(i) = static_cast<std::uint16_t>(65535 - i);
  }
  for (const std::string extension : {".png", ".tif"}) {
    cv::imwrite((folder / ("a" + extension)).string(), shallow);
    cv::imwrite((folder / ("b" + extension)).string(), deep);
    cv::imwrite((folder / ("c" + extension)).string(), grey);
    const Image a = read_picture(folder / ("a" + extension)), b = read_picture(folder / ("b" + extension)),
                c = read_picture(folder / ("c" + extension));
    EXPECT_THAT(a.channels, testing::ElementsAre("R", "G", "B"));
    EXPECT_THAT(c.channels, testing::ElementsAre("Y"));
    EXPECT_FLOAT_EQ(a.at(2, 1, 0), 200 / 255.f);
    EXPECT_FLOAT_EQ(a.at(2, 1, 2), 10 / 255.f);
    EXPECT_FLOAT_EQ(b.at(2, 1, 0), 1.f);
    EXPECT_FLOAT_EQ(b.at(0, 0, 1), 2000 / 65535.f);
    EXPECT_FLOAT_EQ(c.at(1, 0, 0), 65534 / 65535.f);
  }
}

TEST(Raster, PngRoundTripWithinHalfACode) {
  const tests::ScratchFolder folder;
  Random random(9);
  Image image(31, 17, {"R", "G", "B"});
  for (auto& v : image.data) v = static_cast<float>(random.uniform());
  image.at(0, 0, 0) = -3;
  image.at(1, 0, 0) = 7;
  image.at(2, 0, 0) = std::nanf("");
  write_picture(folder / "a.png", image);
  EXPECT_EQ(read_file(folder / "a.png"), encode_png(image));
  const Image back = read_picture(folder / "a.png");
  EXPECT_EQ(back.at(0, 0, 0), 0);
  EXPECT_EQ(back.at(1, 0, 0), 1);
  EXPECT_EQ(back.at(2, 0, 0), 0);
  for (std::size_t i = 9; i < image.data.size(); ++i) EXPECT_NEAR(back.data[i], image.data[i], 0.5001 / 255);
}

TEST(Raster, TruncationIsRefused) {
  const tests::ScratchFolder folder;
  cv::Mat picture(80, 100, CV_8UC3);
  cv::RNG(3).fill(picture, cv::RNG::UNIFORM, 0, 256);
  for (const char* name : {"a.png", "a.jpg", "a.tif"}) {
    cv::imwrite((folder / name).string(), picture);
    EXPECT_EQ(read_picture(folder / name).width, 100);
  }
  expect_truncations_refused(folder / "a.png");
  expect_truncations_refused(folder / "a.jpg");
  expect_truncations_refused(folder / "a.tif");
}

TEST(Raster, AHugeJpegHeaderIsRefused) {
  const tests::ScratchFolder folder;
  cv::imwrite((folder / "a.jpg").string(), cv::Mat(8, 8, CV_8UC3, cv::Scalar(1, 2, 3)));
  std::string bytes = read_file(folder / "a.jpg");
  const auto frame = bytes.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  bytes.replace(frame + 5, 4, "\xff\xf0\xff\xf0");
  write_file(folder / "b.jpg", bytes);
  expect_data_error(folder / "b.jpg", "a JPEG of 65520 x 65520 pixels");
}

TEST(Picture, SrgbCurveRoundTripsAndIsOdd) {
  for (float v = -2; v <= 2; v += 0.01f) {
    EXPECT_NEAR(linear_from_srgb(srgb_from_linear(v)), v, 2e-6 * (1 + std::abs(v)));
    EXPECT_EQ(srgb_from_linear(-v), -srgb_from_linear(v));
  }
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.46135613f, 1e-6);
  EXPECT_NEAR(srgb_from_linear(1), 1, 1e-6);
}

TEST(Picture, RecordedPicturesAreRead) {
  GONIO_NEEDS_DATA("recordings/practice-1");
  GONIO_NEEDS_DATA("hdr/grace/grace_latlong.exr");
  const Image recording = read_picture(tests::data("recordings/practice-1/image_00_00.exr"));
  EXPECT_THAT(recording.channels, testing::Contains("R"));
  const Image grace = read_picture(tests::data("hdr/grace/grace_latlong.exr"));
  EXPECT_EQ(grace.width, 1024);
  EXPECT_EQ(grace.height, 512);
  const Image photograph = read_picture(tests::data("calibration/opencv_stereo_checkerboard/left01.jpg"));
  EXPECT_EQ(photograph.width, 640);
  EXPECT_EQ(photograph.height, 480);
}

}  // namespace
}  // namespace gonio::io
