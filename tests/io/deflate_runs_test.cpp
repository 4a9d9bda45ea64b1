#include "io/deflate_runs.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <vector>

#include "base/random.h"
#include "io/png_grey.h"
#include "io/raster.h"

namespace gonio::io {
namespace {

std::string unpacked(const std::string& stream, std::size_t size) {
  std::string bytes(size + 1, '\0');
  auto length = static_cast<uLongf>(bytes.size());
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length, reinterpret_cast<const Bytef*>(stream.data()),
                       static_cast<uLong>(stream.size())),
            Z_OK);
  bytes.resize(length);
  return bytes;
}

// Runs of all lengths of all bytes, read back by zlib, which also checks Adler's sum.
TEST(RunDeflate, ZlibReadsWhatWasPut) {
  Random random(11, 4);
  for (int trial = 0; trial < 200; ++trial) {
    RunDeflate out;
    std::string expected;
    const int runs = 1 + static_cast<int>(random.below(60));
    for (int k = 0; k < runs; ++k) {
      const auto byte = static_cast<std::uint8_t>(random.below(256));
      const std::size_t count = trial % 3 == 0   ? random.below(6)
                                : trial % 3 == 1 ? random.below(1200)
                                                 : random.below(200000);
      out.put(byte, count);
      expected.append(count, static_cast<char>(byte));
    }
    ASSERT_EQ(unpacked(out.finish(), expected.size()), expected);
  }
}

TEST(RunDeflate, EveryByteAndEveryLength) {
  RunDeflate out;
  std::string expected;
  for (int byte = 0; byte < 256; ++byte)
    for (std::size_t count = 1; count <= 520; count += byte == 7 ? 1 : 37) {
      out.put(static_cast<std::uint8_t>(byte), count), out.put(static_cast<std::uint8_t>(byte + 1), 1);
      expected.append(count, static_cast<char>(byte)), expected += static_cast<char>(byte + 1);
    }
  EXPECT_EQ(unpacked(out.finish(), expected.size()), expected);
}

TEST(RunDeflate, NothingIsAStreamToo) {
  RunDeflate out;
  EXPECT_EQ(unpacked(out.finish(), 0), "");
}

// Pictures of layers and pictures of noise come back, by whichever way they were packed.
TEST(RunDeflate, PicturesComeBack) {
  Random random(3, 3);
  for (int trial = 0; trial < 60; ++trial) {
    const int width = 1 + static_cast<int>(random.below(300)), height = 1 + static_cast<int>(random.below(90));
    std::vector<std::uint8_t> rows(static_cast<std::size_t>(width * height));
    const int middle = width / 2;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int edge = std::abs(x - middle) - (height - std::abs(2 * y - height)) / 3;
        rows[static_cast<std::size_t>(y * width + x)] = static_cast<std::uint8_t>(trial % 4 == 3 ? random.below(256)
                                                                                  : edge < 0     ? 255
                                                                                  : edge == 0    ? random.below(256)
                                                                                                 : 0);
      }
    const GreyImage back = decode_grey(encode_png_of_grey_bytes(rows, static_cast<std::size_t>(width)), "picture");
    ASSERT_EQ(back.bytes, rows);
  }
}

}  // namespace
}  // namespace gonio::io
