// Pictures for the eye: what is bright, what is signed, what was not met.
#include "render/preview.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio::render {
namespace {

io::Image made(const std::vector<std::string>& channels, const std::vector<std::vector<float>>& pixels) {
  io::Image image(static_cast<int>(pixels.size()), 1, channels);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    std::ranges::copy(pixels[i], image.data.begin() + static_cast<std::ptrdiff_t>(i * channels.size()));
  return image;
}

TEST(LayerPreviews, OnlyThoseThatARenderingHolds) {
  EXPECT_TRUE(layer_previews(made({"R", "G", "B"}, {{1, 1, 1}})).empty());
  const auto depth = layer_previews(made({"R", "G", "B", "depth.Z"}, {{1, 1, 1, 2}, {1, 1, 1, 3}}));
  ASSERT_EQ(depth.size(), 1u);
  EXPECT_EQ(depth[0].layer, "depth");
}

TEST(LayerPreviews, DepthRunsFromDarkToBrightAndWhatIsNotMetIsBlack) {
  const io::Image picture = layer_previews(made({"depth.Z"}, {{2}, {4}, {0}, {NAN}, {INFINITY}}))[0].picture;
  const auto brightness = [&](int x) { return picture.at(x, 0, 0) + picture.at(x, 0, 1) + picture.at(x, 0, 2); };
  EXPECT_GT(brightness(0), 0);
  EXPECT_GT(brightness(1), brightness(0) + 0.5f);
  for (const int x : {2, 3, 4}) EXPECT_EQ(brightness(x), 0) << x;
}

TEST(LayerPreviews, NormalsAreHalfOfOnePlusThem) {
  const io::Image picture =
      layer_previews(made({"normal.X", "normal.Y", "normal.Z"}, {{1, 0, 0}, {0, -1, 0}, {0, 0, 0}}))[0].picture;
  EXPECT_EQ(picture.at(0, 0, 0), 1.0f);
  EXPECT_EQ(picture.at(0, 0, 1), 0.5f);
  EXPECT_EQ(picture.at(1, 0, 1), 0.0f);
  EXPECT_EQ(picture.at(2, 0, 0), 0.0f);  // nothing met
}

// Red is positive, blue negative, white zero, and the three share one scale: s2 is a tenth of s1 here, and pale.
TEST(LayerPreviews, StokesPlanesShareOneScale) {
  const auto previews =
      layer_previews(made({"s1.R", "s1.G", "s1.B", "s2.R", "s2.G", "s2.B", "s3.R", "s3.G", "s3.B"},
                          {{1, 1, 1, 0.1f, 0.1f, 0.1f, 0, 0, 0}, {-1, -1, -1, 0.1f, 0.1f, 0.1f, 0, 0, 0}}));
  ASSERT_EQ(previews.size(), 3u);
  const auto redness = [&](std::size_t k, int x) {
    return previews[k].picture.at(x, 0, 0) - previews[k].picture.at(x, 0, 2);
  };
  EXPECT_GT(redness(0, 0), 0.2f);
  EXPECT_LT(redness(0, 1), -0.2f);
  EXPECT_GT(redness(1, 0), 0);
  EXPECT_LT(redness(1, 0), 0.5f * redness(0, 0));
  EXPECT_EQ(redness(2, 0), 0);
}

}  // namespace
}  // namespace gonio::render
