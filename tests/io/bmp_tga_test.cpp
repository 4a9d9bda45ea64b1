// BMP and TGA put together here byte by byte, each kind against the picture that it was made from; forged and cut ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/codes.h"
#include "io/grey.h"
#include "io/picture.h"
#include "io/raster.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

constexpr int width = 5, height = 3;

// Red, green, blue of a pixel: no two are alike, and all survive five bits.
std::array<int, 3> colour_of(int x, int y) {
  const auto of_five = [](int five) { return (five * 255 + 15) / 31; };
  return {of_five(3 * x + y), of_five(31 - 2 * x - y), of_five(7 * y + x)};
}
int grey_of(int x, int y) {
  return 40 * x + 13 * y;
}

std::string low(unsigned value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 255);
  return text;
}
std::string blue_first(std::array<int, 3> c) {
  return low(static_cast<unsigned>(c[2]), 1) + low(static_cast<unsigned>(c[1]), 1) +
         low(static_cast<unsigned>(c[0]), 1);
}

struct TgaKind {
  int type = 2, bits = 24;
  bool from_top = false, from_right = false;
  int map_first = 0;
};
std::string tga_pixel(const TgaKind& kind, int x, int y) {
  const auto c = colour_of(x, y);
  if ((kind.type & 7) == 3) return low(static_cast<unsigned>(grey_of(x, y)), 1) + (kind.bits == 16 ? "\x40" : "");
  if ((kind.type & 7) == 1) return low(static_cast<unsigned>(kind.map_first + y * width + x), kind.bits / 8);
  if (kind.bits == 16) {
    const auto five = [](int v) { return static_cast<unsigned>((v * 31 + 127) / 255); };
    return low(five(c[0]) << 10 | five(c[1]) << 5 | five(c[2]), 2);
  }
  return blue_first(c) + (kind.bits == 32 ? "\x80" : "");
}
std::string tga_head(const TgaKind& kind, unsigned w, unsigned h) {
  const bool mapped = (kind.type & 7) == 1;
  return low(4, 1) + low(mapped, 1) + low(static_cast<unsigned>(kind.type), 1) +
         low(static_cast<unsigned>(kind.map_first), 2) + low(mapped ? width * height : 0, 2) + low(mapped ? 24 : 0, 1) +
         low(0, 4) + low(w, 2) + low(h, 2) + low(static_cast<unsigned>(kind.bits), 1) +
         low((kind.from_top ? 0x20u : 0) | (kind.from_right ? 0x10u : 0) | (kind.bits == 32 ? 8u : 0), 1) + "text";
}
std::string tga(const TgaKind& kind) {
  std::string file = tga_head(kind, width, height);
  if ((kind.type & 7) == 1)
    for (int i = 0; i < width * height; ++i) file += blue_first(colour_of(i % width, i / width));
  std::vector<std::string> pixels;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      pixels.push_back(
          tga_pixel(kind, kind.from_right ? width - 1 - column : column, kind.from_top ? row : height - 1 - row));
  if (kind.type < 8) {
    for (const std::string& p : pixels) file += p;
    return file;
  }
  // Packets of 7 pixels as they are, across the end of a row, and of one that is repeated once.
  for (std::size_t i = 0; i < pixels.size();) {
    const std::size_t n = i == 0 ? 7 : 1;
    file += low(static_cast<unsigned>(n == 1 ? 0x80 : n - 1), 1);
    for (std::size_t k = 0; k < n; ++k) file += pixels[i + k];
    i += n;
  }
  return file;
}

void expect_colours(const std::string& name, const Image& image, const GreyImage& grey) {
  SCOPED_TRACE(name);
  ASSERT_EQ(image.width, width);
  ASSERT_EQ(image.height, height);
  ASSERT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
  ASSERT_EQ(grey.bytes.size(), std::size_t{width * height});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto c = colour_of(x, y);
      for (int k = 0; k < 3; ++k)
        EXPECT_FLOAT_EQ(image.at(x, y, k), static_cast<float>(c[static_cast<std::size_t>(k)]) / 255)
            << x << " " << y << " " << k;
      EXPECT_NEAR(grey.bytes[static_cast<std::size_t>(y * width + x)], 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2],
                  0.51);
    }
}
void expect_colours(const std::string& name, const std::string& bytes) {
  expect_colours(name, decode_raster(bytes, name), decode_grey(bytes, name));
}
void expect_greys(const std::string& name, const std::string& bytes) {
  SCOPED_TRACE(name);
  const Image image = decode_raster(bytes, name);
  ASSERT_EQ(image.channels, (std::vector<std::string>{"Y"}));
  const GreyImage grey = decode_grey(bytes, name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      EXPECT_FLOAT_EQ(image.at(x, y, 0), static_cast<float>(grey_of(x, y)) / 255);
      EXPECT_EQ(grey.bytes[static_cast<std::size_t>(y * width + x)], grey_of(x, y));
    }
}
std::string refusal(const std::string& name, const std::string& bytes) {
  std::string problem = "none";
  for (const bool grey : {false, true}) {
    try {
      if (grey)
        decode_grey(bytes, name);
      else
        decode_raster(bytes, name);
      return "none";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      EXPECT_EQ(error.place(), name);
      problem = error.problem();
    }
  }
  return problem;
}
void expect_cuts_refused(const std::string& name, const std::string& bytes) {
  EXPECT_EQ(refusal(name, bytes), "none");
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_NE(refusal(name, bytes.substr(0, length)), "none") << name << " of " << length;
}

std::string bmp_row_end(std::size_t bytes) {
  return std::string((4 - bytes % 4) % 4, '\0');
}
struct BmpKind {
  int bits = 24;
  bool from_top = false;
  unsigned coding = 0;
  std::array<unsigned, 3> masks{0xff0000, 0xff00, 0xff};
};
std::string bmp(const BmpKind& kind) {
  std::string colours, pixels;
  if (kind.bits == 8)  // a map in an order of its own
    for (unsigned i = 0; i < 256; ++i) colours += low(i, 1) + low(i, 1) + low(i, 1) + low(0, 1);
  if (kind.coding == 3)
    for (const unsigned mask : kind.masks) colours += low(mask, 4);
  for (int row = 0; row < height; ++row) {
    const int y = kind.from_top ? row : height - 1 - row;
    std::string line;
    for (int x = 0; x < width; ++x)
      line += kind.bits == 8 ? low(static_cast<unsigned>(grey_of(x, y)), 1)
                             : blue_first(colour_of(x, y)) + (kind.bits == 32 ? "\xff" : "");
    pixels += line + bmp_row_end(line.size());
  }
  const unsigned first = 54 + static_cast<unsigned>(colours.size());
  return "BM" + low(first + static_cast<unsigned>(pixels.size()), 4) + low(0, 4) + low(first, 4) + low(40, 4) +
         low(width, 4) + low(static_cast<unsigned>(kind.from_top ? -height : height), 4) + low(1, 2) +
         low(static_cast<unsigned>(kind.bits), 2) + low(kind.coding, 4) + low(static_cast<unsigned>(pixels.size()), 4) +
         low(2835, 4) + low(2835, 4) + low(kind.bits == 8 ? 256 : 0, 4) + low(0, 4) + colours + pixels;
}

TEST(BmpTga, EveryKindOfTgaFromEveryCorner) {
  for (const bool top : {false, true})
    for (const bool right : {false, true})
      for (const int packed : {0, 8}) {
        const std::string name = "t" + std::to_string(packed) + (top ? "-top" : "") + (right ? "-right" : "") + ".tga";
        for (const int bits : {16, 24, 32})
          expect_colours(std::to_string(bits) + name, tga({2 + packed, bits, top, right}));
        expect_colours("mapped" + name, tga({1 + packed, 8, top, right}));
        expect_colours("offset-map" + name, tga({1 + packed, 16, top, right, 300}));
        expect_greys("grey" + name, tga({3 + packed, 8, top, right}));
        expect_greys("grey-alpha" + name, tga({3 + packed, 16, top, right}));
      }
}

TEST(BmpTga, EveryKindOfBmp) {
  for (const bool top : {false, true}) {
    expect_colours("24.bmp", bmp({24, top}));
    expect_colours("32.BMP", bmp({32, top}));
    expect_colours("masks.bmp", bmp({32, top, 3}));
    expect_greys("8.bmp", bmp({8, top}));
  }
}

// As files: the name says that it is a picture, the beginning which codec reads it.
TEST(BmpTga, FilesOfTheseNamesAndOfOthers) {
  const tests::ScratchFolder folder;
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.tga", tga({})}, {"b.BMP", bmp({})}, {"really-tga.png", tga({10})}, {"really-bmp.tga", bmp({32})}};
  for (const auto& [name, bytes] : files) {
    write_file(folder / name, bytes);
    expect_colours(name, read_picture(folder / name), read_grey(folder / name));
    EXPECT_EQ(code_bits(folder / name), 8);
  }
}

TEST(BmpTga, CutFilesAreRefusedInALine) {
  for (const int type : {1, 2, 3, 9, 10, 11}) expect_cuts_refused("cut.tga", tga({type, type % 8 == 2 ? 24 : 8}));
  expect_cuts_refused("cut.bmp", bmp({}));
  expect_cuts_refused("cut.bmp", bmp({8}));
}

TEST(BmpTga, ForgedHeadsAreRefusedBeforeAnythingIsAllocated) {
  EXPECT_THAT(refusal("a.tga", tga_head({2, 24}, 65535, 65535) + "abc"),
              HasSubstr("65535 x 65535 pixels take at least"));
  EXPECT_THAT(refusal("a.tga", tga_head({10, 24}, 65535, 65535) + "abc"), HasSubstr("65535 x 65535 pixels"));
  EXPECT_THAT(refusal("a.tga", tga_head({2, 24}, 0, 7) + "abc"), HasSubstr("empty"));
  EXPECT_THAT(refusal("a.tga", tga_head({2, 12}, 5, 3) + std::string(45, 'a')), HasSubstr("TGA"));
  std::string beyond = tga({1, 8});
  beyond.back() = static_cast<char>(200);
  EXPECT_THAT(refusal("a.tga", beyond), HasSubstr("names colour 200, its map has 15 from 0"));
  const auto changed = [](std::size_t at, const std::string& by) {
    std::string file = bmp({});
    file.replace(at, by.size(), by);
    return file;
  };
  EXPECT_THAT(refusal("a.bmp", changed(18, low(0x7fffffff, 4) + low(0x7fffffff, 4))), HasSubstr("2147483647"));
  EXPECT_THAT(refusal("a.bmp", changed(22, low(0x80000000u, 4))), HasSubstr("2147483648"));
  EXPECT_THAT(refusal("a.bmp", changed(18, low(0, 4))), HasSubstr("empty"));
  EXPECT_THAT(refusal("a.bmp", changed(18, low(static_cast<unsigned>(-5), 4))), HasSubstr("negative width"));
  EXPECT_THAT(refusal("a.bmp", changed(28, low(7, 2))), HasSubstr("pixels of 7 bits"));
  EXPECT_THAT(refusal("a.bmp", changed(30, low(5, 4))), HasSubstr("coding 5"));
  EXPECT_THAT(refusal("a.bmp", changed(10, low(0xfffffff0u, 4))), HasSubstr("cut off"));
  EXPECT_THAT(refusal("a.bmp", bmp({32, false, 3, {0xff, 0xff00, 0xff0000}})), HasSubstr("unusual bits"));
}

TEST(BmpTga, OtherFormatsAreToldWhatIsRead) {
  EXPECT_THAT(refusal("a.png", "GIF89a and more"), HasSubstr("neither PNG, JPEG, TIFF, BMP nor TGA"));
  const tests::ScratchFolder folder;
  write_file(folder / "a.webp", "RIFF");
  try {
    read_picture(folder / "a.webp");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.remedy(), HasSubstr(".bmp or .tga"));
  }
}

}  // namespace
}  // namespace gonio::io
