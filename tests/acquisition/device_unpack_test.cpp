// Bytes of cameras as samples, and their counts of frames.
#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/device/frame_count.h"
#include "acquisition/device/unpack.h"
#include "base/error.h"
#include "base/random.h"

using namespace gonio;
using namespace gonio::acquisition;

namespace {

using Bytes = std::vector<std::uint8_t>;
using Samples = std::vector<std::uint16_t>;

PixelFormat pixel_format(const std::string& name) {
  const auto format = parse_pixel_format(name);
  EXPECT_TRUE(format) << name;
  return format.value_or(PixelFormat{});
}

Samples unpacked(const char* name, const Bytes& bytes, int width, int height = 1, int padding = 0) {
  return unpack(bytes, width, height, padding, pixel_format(name), "here");
}

TEST(DeviceUnpack, LaysOutAsTheStandardsSay) {
  EXPECT_EQ(unpacked("Mono8", {1, 255}, 2), (Samples{1, 255}));
  EXPECT_EQ(unpacked("Mono16", {0x34, 0x12, 0xff, 0xff}, 2), (Samples{0x1234, 0xffff}));
  EXPECT_EQ(unpacked("BayerGB10", {0xff, 0x03, 0x01, 0x00}, 2), (Samples{0x3ff, 1}));
  // GigE Vision: high bits of the first, 2 + 2 low bits in a byte's lower halves, high bits of the second.
  EXPECT_EQ(unpacked("Mono10Packed", {0xa9, 0x21, 0x57}, 2), (Samples{0x2a5, 0x15e}));
  EXPECT_EQ(unpacked("Mono12Packed", {0xab, 0x3c, 0x12}, 2), (Samples{0xabc, 0x123}));
  // PFNC: lowest bits first.
  EXPECT_EQ(unpacked("Mono10p", {0xa5, 0x7a, 0xf5, 0x3f, 0x00}, 4), (Samples{0x2a5, 0x15e, 0x3ff, 0}));
  EXPECT_EQ(unpacked("BayerRG12p", {0xbc, 0x3a, 0x12}, 2), (Samples{0xabc, 0x123}));
  // The two share names up to one letter, and nothing else.
  EXPECT_NE(unpacked("Mono12p", {0xab, 0x3c, 0x12}, 2), unpacked("Mono12Packed", {0xab, 0x3c, 0x12}, 2));
}

// An independent packer: a list of bits, or the triples written out.
Bytes packed(const Samples& samples, const PixelFormat& format) {
  Bytes bytes;
  if (format.packing == PixelFormat::Packing::gige) {
    for (std::size_t i = 0; i < samples.size(); i += 2) {
      const int rest = format.bits - 8, mask = (1 << rest) - 1;
      const int a = samples[i], b = i + 1 < samples.size() ? samples[i + 1] : 0;
      for (const int byte : {a >> rest, (a & mask) + 16 * (b & mask), b >> rest})
        bytes.push_back(static_cast<std::uint8_t>(byte));
    }
    if (samples.size() % 2 == 1) bytes.pop_back();
    return bytes;
  }
  std::vector<bool> bits;
  for (const int sample : samples)
    for (int bit = 0; bit < format.bits_per_pixel(); ++bit) bits.push_back((sample >> bit) % 2 == 1);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (i % 8 == 0) bytes.push_back(0);
    if (bits[i]) bytes.back() = static_cast<std::uint8_t>(bytes.back() + (1 << (i % 8)));
  }
  return bytes;
}

TEST(DeviceUnpack, GivesBackWhatWasPacked) {
  Random random(7);
  for (const char* name : {"Mono8", "Mono10", "Mono12", "Mono14", "Mono16", "Mono10p", "Mono12p", "Mono14p",
                           "BayerBG10Packed", "PolarizeMono12Packed", "BayerRGPolarized12p", "Polarized8"}) {
    const PixelFormat format = pixel_format(name);
    for (int round = 0; round < 200; ++round) {
      const int width = 1 + static_cast<int>(random.below(9)), height = 1 + static_cast<int>(random.below(5));
      const int padding = static_cast<int>(random.below(4));
      Samples samples;
      for (int i = 0; i < width * height; ++i)
        samples.push_back(static_cast<std::uint16_t>(random.below(1U << static_cast<unsigned>(format.bits))));
      Bytes bytes;
      if (padding == 0) bytes = packed(samples, format);
      for (int y = 0; padding > 0 && y < height; ++y) {
        const auto row = packed({samples.begin() + y * width, samples.begin() + (y + 1) * width}, format);
        bytes.insert(bytes.end(), row.begin(), row.end());
        if (y + 1 < height) bytes.insert(bytes.end(), static_cast<std::size_t>(padding), 0xff);
      }
      ASSERT_EQ(unpack(bytes, width, height, padding, format, "here"), samples)
          << name << " " << width << "x" << height;
      bytes.pop_back();
      EXPECT_THROW(unpack(bytes, width, height, padding, format, "here"), Error) << name;
    }
  }
  EXPECT_TRUE(unpacked("Mono12p", {}, 0, 5).empty());
}

TEST(DeviceUnpack, SamplesBeyondTheirFormatAreRefused) {
  EXPECT_THROW(unpacked("Mono12", {0x00, 0x10}, 1), Error);
  EXPECT_THROW(unpacked("Mono10", {0x00, 0x04}, 1), Error);
  EXPECT_EQ(unpacked("Mono12", {0xff, 0x0f}, 1), Samples{4095});
}

TEST(DeviceUnpack, NamesAreKnownOrRefused) {
  for (const char* name : {"RGB8", "Mono", "Mono9", "Mono8p", "Mono14Packed", "Mono12packed", "BayerXX8", "BayerRG",
                           "YUV422_8", "", "12", "Mono12Packedx", "Mono99999999999", "Bayer..8", "BayerRGP8"})
    EXPECT_FALSE(parse_pixel_format(name)) << name;
  EXPECT_EQ(unpacked_name("BayerRG12Packed"), "BayerRG12");
  EXPECT_EQ(unpacked_name("Mono10p"), "Mono10");
  EXPECT_EQ(unpacked_name("RGB8"), "RGB8");
  EXPECT_EQ(pixel_format("PolarizeBayerGR12p").mosaic, "PolarizeBayerGR");
}

// PFNC's numbers hold the bits of a pixel in their third byte: https://www.emva.org, PFNC 2.4, 3; here as aravis has
// them.
TEST(DeviceUnpack, BitsOfAPixelAreThoseOfTheConventionsNumbers) {
  const std::vector<std::pair<const char*, ArvPixelFormat>> numbers{
      {"Mono8", ARV_PIXEL_FORMAT_MONO_8},
      {"Mono10", ARV_PIXEL_FORMAT_MONO_10},
      {"Mono10Packed", ARV_PIXEL_FORMAT_MONO_10_PACKED},
      {"Mono12", ARV_PIXEL_FORMAT_MONO_12},
      {"Mono12Packed", ARV_PIXEL_FORMAT_MONO_12_PACKED},
      {"Mono14", ARV_PIXEL_FORMAT_MONO_14},
      {"Mono16", ARV_PIXEL_FORMAT_MONO_16},
      {"BayerRG8", ARV_PIXEL_FORMAT_BAYER_RG_8},
      {"BayerGR10", ARV_PIXEL_FORMAT_BAYER_GR_10},
      {"BayerBG10Packed", ARV_PIXEL_FORMAT_BAYER_BG_10_PACKED},
      {"BayerGB10p", ARV_PIXEL_FORMAT_BAYER_GB_10P},
      {"BayerRG12p", ARV_PIXEL_FORMAT_BAYER_RG_12P},
      {"BayerGB12", ARV_PIXEL_FORMAT_BAYER_GB_12},
      {"BayerGB12Packed", ARV_PIXEL_FORMAT_BAYER_GB_12_PACKED},
      {"BayerRG16", ARV_PIXEL_FORMAT_BAYER_RG_16}};
  for (const auto& [name, number] : numbers)
    EXPECT_EQ(pixel_format(name).bits_per_pixel(), static_cast<int>(ARV_PIXEL_FORMAT_BIT_PER_PIXEL(number))) << name;
}

TEST(DeviceFrameCount, NeverBeginsAgain) {
  FrameCount count;
  EXPECT_EQ(count.number_of(65534), 65534U);
  EXPECT_EQ(count.number_of(65535), 65535U);
  EXPECT_EQ(count.number_of(1), 65536U);
  EXPECT_EQ(count.number_of(4), 65539U);  // three were lost
  EXPECT_EQ(count.number_of(3), 65538U);  // late
  EXPECT_EQ(count.number_of(5), 65540U);
  count.restarted();
  EXPECT_EQ(count.number_of(1), 65541U);
  EXPECT_EQ(count.number_of(2), 65542U);
  count.restarted();  // of a camera that counts on
  EXPECT_EQ(count.number_of(4), 65544U);
}

TEST(DeviceFrameCount, ChunksAreInTheSameNumbers) {
  EXPECT_EQ(FrameCount::number_of_chunk(7, 7, 65542), 65542U);
  EXPECT_EQ(FrameCount::number_of_chunk(6, 7, 65542), 65541U);  // late by one
  EXPECT_EQ(FrameCount::number_of_chunk(65542, 7, 65542), 65542U);
  EXPECT_EQ(FrameCount::number_of_chunk(65535, 1, 65536), 65535U);
  EXPECT_EQ(FrameCount::number_of_chunk(1'000'000, 1'000'001, 1'000'001), 1'000'000U);
}

}  // namespace
