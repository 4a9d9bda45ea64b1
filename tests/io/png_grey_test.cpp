// PNG of grey bytes: every filter, written here as ISO 15948 defines it and packed by zlib.
#include "io/png_grey.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <random>
#include <string>

#include "base/error.h"
#include "io/raster.h"

namespace gonio::tests {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string big(std::uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8), static_cast<char>(v)};
}
std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big(static_cast<std::uint32_t>(data.size())) + body + big(static_cast<std::uint32_t>(crc));
}

std::uint8_t predicted(int filter, int left, int above, int beyond) {
  if (filter == 1) return static_cast<std::uint8_t>(left);
  if (filter == 2) return static_cast<std::uint8_t>(above);
  if (filter == 3) return static_cast<std::uint8_t>((left + above) / 2);
  if (filter != 4) return 0;
  const int p = left + above - beyond, a = std::abs(p - left), b = std::abs(p - above), c = std::abs(p - beyond);
  return static_cast<std::uint8_t>(a <= b && a <= c ? left : b <= c ? above : beyond);
}

// Row y is filtered by kind (y + first) % 5; the packed rows are cut into `chunks`.
std::string png_of(const Bytes& pixels, int width, int first, std::size_t chunks) {
  const int height = static_cast<int>(pixels.size()) / width;
  const auto at = [&](int x, int y) {
    return x < 0 || y < 0 ? 0 : int{pixels[static_cast<std::size_t>(y * width + x)]};
  };
  std::string rows;
  for (int y = 0; y < height; ++y) {
    const int filter = (y + first) % 5;
    rows += static_cast<char>(filter);
    for (int x = 0; x < width; ++x)
      rows += static_cast<char>(at(x, y) - predicted(filter, at(x - 1, y), at(x, y - 1), at(x - 1, y - 1)));
  }
  uLongf size = ::compressBound(rows.size());
  std::string packed(size, '\0');
  ::compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  packed.resize(size);
  std::string file = std::string("\x89PNG\r\n\x1a\n", 8) +
                     chunk("IHDR", big(static_cast<std::uint32_t>(width)) + big(static_cast<std::uint32_t>(height)) +
                                       std::string("\x08\0\0\0\0", 5));
  const std::size_t each = packed.size() / chunks + 1;
  for (std::size_t from = 0; from < packed.size(); from += each) file += chunk("IDAT", packed.substr(from, each));
  return file + chunk("IEND", "");
}

TEST(PngOfGreyBytes, UndoesEveryFilterInWhateverChunks) {
  std::mt19937 random(5);
  for (const int width : {1, 7, 64})
    for (int first = 0; first < 5; ++first)
      for (const std::size_t chunks : {1U, 3U}) {
        Bytes pixels(static_cast<std::size_t>(width) * 11);
        for (std::size_t i = 0; i < pixels.size(); ++i)
          pixels[i] = static_cast<std::uint8_t>(i % 3 == 0 ? random() : i);
        const std::string file = png_of(pixels, width, first, chunks);
        const io::GreyImage grey = io::decode_grey(file, "grey.png");
        EXPECT_EQ(grey.bytes, pixels) << width << ", first filter " << first;
        // This room's own decoder did it, and not the one for all the others.
        const auto own = io::decode_png_of_grey_bytes(file, io::read_raster_header(file, "grey.png"));
        ASSERT_TRUE(own);
        EXPECT_EQ(*own, pixels);
      }
}

TEST(PngOfGreyBytes, ThatDoNotUnpackAreLeftToOthersWhichRefuseThem) {
  const Bytes pixels(64 * 11, 9);
  const std::string whole = png_of(pixels, 64, 0, 1);
  std::string damaged = png_of(Bytes(64 * 5, 9), 64, 0, 1);  // five rows where eleven are claimed
  damaged.replace(0, 33, whole, 0, 33);                      // signature and IHDR
  EXPECT_FALSE(io::decode_png_of_grey_bytes(damaged, io::read_raster_header(damaged, "damaged.png")));
}

}  // namespace
}  // namespace gonio::tests
