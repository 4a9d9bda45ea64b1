#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/response.h"
#include "photograph/saturation.h"

namespace gonio::photograph {
namespace {

manifest::Value table() {
  return manifest::parse_json("[[0, 0.1], [0.5, 0.2], [1, 1]]", "table");
}

TEST(Response, TablesAreInterpolatedAndEndAtTheirEnds) {
  const Response response(table(), "here");
  EXPECT_FLOAT_EQ(response(0.25f), 0.15f);
  EXPECT_FLOAT_EQ(response(0.75f), 0.6f);
  EXPECT_FLOAT_EQ(response(-1), 0.1f);
  EXPECT_FLOAT_EQ(response(2), 1);
}

TEST(Response, OnlyTheKnownOnes) {
  EXPECT_THROW(Response("gamma", "here"), Error);
  EXPECT_THROW(Response(manifest::parse_json("[[0.5, 1], [0.5, 2]]", "table"), "here"), Error);
  EXPECT_THROW(Response(manifest::parse_json("[[0.5], [0.6]]", "table"), "here"), Error);
  EXPECT_FLOAT_EQ(Response("srgb", "here")(0.5f), io::linear_from_srgb(0.5f));
  EXPECT_FLOAT_EQ(Response("linear", "here")(0.5f), 0.5f);
}

TEST(LinearPicture, OfCodesNeedsAStatedResponse) {
  const tests::ScratchFolder folder;
  io::Image image(2, 1, {"R", "G", "B"});
  image.data = {1, 0.5f, 0.25f, 0.75f, 0.5f, 0};
  io::write_picture(folder / "a.png", image);
  EXPECT_THROW(read_linear(folder / "a.png", {}, "here"), Error);
  const LinearPicture picture = read_linear(folder / "a.png", "srgb", "here");
  EXPECT_TRUE(picture.integer_codes());
  EXPECT_EQ(picture.clipped[0], 1);
  EXPECT_EQ(picture.clipped[1], 0);
  EXPECT_NEAR(picture.colour.at(1, 0, 0), io::linear_from_srgb(191 / 255.0f), 1e-6);
}

TEST(LinearPicture, OfAnExrIsLinearAndKnowsItsVariance) {
  const tests::ScratchFolder folder;
  io::Image image(1, 1, {"R", "G", "B", "variance.R", "variance.G", "variance.B"});
  image.data = {2, 3, 4, 0.2f, 0.3f, 0.4f};
  io::write_picture(folder / "a.exr", image);
  const LinearPicture picture = read_linear(folder / "a.exr", {}, "here");
  EXPECT_EQ(picture.colour.data, (std::vector<float>{2, 3, 4}));
  EXPECT_EQ(picture.variance.data, (std::vector<float>{0.2f, 0.3f, 0.4f}));
}

// Its highest code says "at least", the one below it is a reading like any other.
TEST(LinearPicture, OnlyTheHighestCodeIsSaturatedWhateverTheBits) {
  const tests::ScratchFolder folder;
  for (const int bits : {8, 16}) {
    const float top = bits == 8 ? 255.0f : 65535.0f;
    io::Image image(4, 1, {"Y"});
    image.data = {1, (top - 1) / top, 1 / top, 0};
    io::write_png(folder / "a.png", image, bits);
    const LinearPicture picture = read_linear(folder / "a.png", "linear", "here");
    EXPECT_EQ(picture.code_bits, bits);
    EXPECT_EQ(picture.clipped, (std::vector<std::uint8_t>{1, 0, 0, 0})) << bits;
    EXPECT_EQ(picture.dark, (std::vector<std::uint8_t>{0, 0, 0, 1})) << bits;
  }
}

// A sensor of 12 bits in a file of 16: its codes end at 4095.
TEST(LinearPicture, ASensorsCodesMayEndBelowTheFiles) {
  const tests::ScratchFolder folder;
  io::Image image(3, 1, {"Y"});
  image.data = {4095 / 65535.0f, 4094 / 65535.0f, 0.5f};
  io::write_png(folder / "a.png", image, 16);
  const LinearPicture picture = read_linear(folder / "a.png", "linear", "here", 4094.5 / 65535);
  EXPECT_EQ(picture.clipped, (std::vector<std::uint8_t>{1, 0, 1}));
}

TEST(LinearPicture, FloatsHaveNoHighestCode) {
  const tests::ScratchFolder folder;
  io::Image image(2, 1, {"Y"});
  image.data = {1, 5};
  io::write_picture(folder / "a.exr", image);
  EXPECT_EQ(read_linear(folder / "a.exr", {}, "here").clipped, (std::vector<std::uint8_t>{0, 0}));
  EXPECT_FALSE(1e30 >= saturated_from(0));
  EXPECT_FALSE(-1e30 < dark_below(0));
}

// A float that was cut off at 0.7 lies below the number 0.7.
TEST(Saturation, AFloatOfTheStatedLimitIsAtIt) {
  ASSERT_LT(double{0.7f}, 0.7);
  for (const double full_scale : {0.7, 0.8, 0.3, 1000.1})
    EXPECT_TRUE(at_full_scale(static_cast<float>(full_scale), full_scale)) << full_scale;
  EXPECT_FALSE(at_full_scale(0.799, 0.8));
  EXPECT_FALSE(at_full_scale(5, 0));
}

TEST(Mask, CountsAboveOneHalfAndHasThePicturesSize) {
  const tests::ScratchFolder folder;
  io::Image mask(2, 2, {"Y"});
  mask.data = {0, 1, 0.51f, 0.49f};
  io::write_picture(folder / "m.exr", mask);
  EXPECT_EQ(read_mask_of(io::Image(2, 2, {"R", "G", "B"}), folder / "m.exr", "here"),
            (std::vector<std::uint8_t>{0, 1, 1, 0}));
  EXPECT_THROW(read_mask_of(io::Image(2, 1, {"Y"}), folder / "m.exr", "here"), Error);
}

}  // namespace
}  // namespace gonio::photograph
