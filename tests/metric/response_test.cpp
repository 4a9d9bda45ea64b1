#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "io/picture.h"
#include "metric/linear_picture.h"

namespace gonio::metric {
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
  EXPECT_TRUE(picture.integer_codes);
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

}  // namespace
}  // namespace gonio::metric
