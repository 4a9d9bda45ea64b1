// Raw files: written by hand, and one of a camera with the figures that somebody else read from it.
#include "io/camera_raw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/assignment.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/dng_writer.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;
using tests::Dng;

Dng noise(std::uint64_t seed, int left = 0, int top = 0) {
  Dng dng;
  dng.left = left, dng.top = top;
  dng.width += left, dng.height += top;
  Random random(seed);
  for (int i = 0; i < dng.width * dng.height; ++i)
    dng.samples.push_back(static_cast<std::uint16_t>(random.below(4096)));
  return dng;
}

TEST(CameraRaw, SamplesAreTheSensorsOwn) {
  Dng dng = noise(4);
  for (const auto& [filters, mosaic] : {std::pair{std::string("\0\1\1\2", 4), "BayerRG"},
                                        {std::string("\1\0\2\1", 4), "BayerGR"},
                                        {std::string("\1\2\0\1", 4), "BayerGB"},
                                        {std::string("\2\1\1\0", 4), "BayerBG"}}) {
    dng.filters = filters;
    const CameraRaw raw = decode_camera_raw(bytes_of(dng), "here");
    EXPECT_EQ(raw.width, 64);
    EXPECT_EQ(raw.height, 48);
    EXPECT_EQ(raw.bits, 12);
    EXPECT_EQ(raw.mosaic, mosaic);
    EXPECT_EQ(raw.samples, dng.samples);
    EXPECT_NEAR(raw.exposure_s.value_or(0), 0.004, 1e-9);
    EXPECT_EQ(raw.iso, 200);
    EXPECT_THAT(raw.camera, HasSubstr("Written By Hand"));
  }
}

// A DNG's filters count from the corner of what sees light (its specification, CFAPattern). LibRaw begins at the next
// even row and column of the sensor: behind an odd border at the neighbour's filter.
TEST(CameraRaw, TheMaskedBorderIsLeftOut) {
  for (const auto& [left, mosaic] : {std::pair{4, "BayerRG"}, {3, "BayerGR"}}) {
    const Dng dng = noise(5, left, 2);
    const CameraRaw raw = decode_camera_raw(bytes_of(dng), "here");
    EXPECT_EQ(raw.mosaic, mosaic);
    ASSERT_EQ(raw.width, 60 + left);
    ASSERT_EQ(raw.height, 48);
    for (int y = 0; y < raw.height; ++y)
      for (int x = 0; x < raw.width; ++x)
        ASSERT_EQ(raw.samples[static_cast<std::size_t>(raw.width * y + x)],
                  dng.samples[static_cast<std::size_t>(dng.width * (y + 2) + x + 4)]);
  }
}

TEST(CameraRaw, WhatIsNoneIsRefused) {
  const auto refusal = [](const std::string& bytes) -> std::string {
    try {
      decode_camera_raw(bytes, "a.dng");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "taken";
  };
  const std::string whole = bytes_of(noise(6));
  EXPECT_THAT(refusal(""), HasSubstr("a.dng: is no raw file"));
  EXPECT_THAT(refusal("a picture"), HasSubstr("is no raw file"));
  EXPECT_NE(refusal(whole.substr(0, 4000)), "taken");
  Dng dark = noise(6);
  std::ranges::fill(dark.samples, std::uint16_t{0});
  EXPECT_THAT(refusal(bytes_of(dark)), HasSubstr("holds 0 in every pixel"));
  EXPECT_TRUE(is_camera_raw("x/IMG_1.CR2") && is_camera_raw("a.nef") && !is_camera_raw("a.jpg") &&
              !is_camera_raw("dng"));
}

// A Canon's DNG; medians of 25 x 25 pixels of one colour in 24 patches, as somebody else found them (SOURCE.md there).
TEST(CameraRaw, AChartsPatchesAreAsAPeerReadThem) {
  GONIO_NEEDS_DATA("colour/passport_canon550d");
  const auto folder = tests::data("colour/passport_canon550d");
  const CameraRaw raw = decode_camera_raw(read_file(folder / "colorchart.dng"), "colorchart.dng");
  ASSERT_EQ(raw.mosaic, "BayerRG");
  ASSERT_EQ(raw.width, 1734);
  ASSERT_EQ(raw.height, 1156);
  EXPECT_EQ(raw.bits, 14);
  for (const double black : raw.black) EXPECT_EQ(black, 2056);
  EXPECT_EQ(raw.white, 15000);
  EXPECT_EQ(raw.neutral[1], 1);
  EXPECT_NEAR(raw.neutral[0], 1000.0 / 2477, 0.2);
  const auto median = [&](int x, int y, int right, int down) {
    std::vector<std::uint16_t> codes;
    for (int v = y - 12; v <= y + 12; ++v)
      for (int u = x - 12; u <= x + 12; ++u)
        codes.push_back(raw.samples[static_cast<std::size_t>((2 * v + down) * raw.width + 2 * u + right)]);
    std::ranges::nth_element(codes, codes.begin() + 312);
    return codes[312];
  };
  std::ifstream table(folder / "peer_patches.csv");
  std::string line;
  std::getline(table, line);
  int patches = 0;
  for (; std::getline(table, line); ++patches) {
    const auto cells = pieces(line, ',');
    const int x = std::stoi(cells.at(1)), y = std::stoi(cells.at(2));
    EXPECT_EQ(median(x, y, 0, 0), std::stod(cells.at(3))) << line;
    EXPECT_EQ(median(x, y, 1, 1), std::stod(cells.at(5))) << line;
  }
  EXPECT_EQ(patches, 24);
}

// Six files of which only the heads are left: nothing of them is a picture.
TEST(CameraRaw, HeadsWithoutPixelsAreRefused) {
  GONIO_NEEDS_DATA("raw/raw_metadata");
  for (const char* name : {"CanonRaw.cr2", "CanonRaw.cr3", "DNG.dng", "FujiFilm.raf", "Nikon.nef"})
    EXPECT_THROW(decode_camera_raw(read_file(tests::data("raw/raw_metadata") / name), name), Error) << name;
}

}  // namespace
}  // namespace gonio::io
