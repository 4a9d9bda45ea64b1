// Grey pictures of what cameras and renderings write.
#include "io/grey.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace gonio::io {
namespace {

// A raw frame of 12 bits in a file of 16 is as good to search as the same frame stretched over its file.
TEST(Grey, TwelveBitsInAFileOfSixteen) {
  Image raw(64, 48, {"Y"}), full(64, 48, {"Y"});
  Random random(3);
  for (std::size_t i = 0; i < raw.pixels(); ++i) {
    const auto code = static_cast<float>(random.below(4096));
    raw.data[i] = code / 65535.0F;
    full.data[i] = 16 * code / 65535.0F;
  }
  const GreyImage of_raw = grey_of(raw), of_full = grey_of(full);
  for (std::size_t i = 0; i < raw.pixels(); ++i) {
    EXPECT_NEAR(of_raw.values[i], of_full.values[i], 3) << i;
    EXPECT_GE(of_full.values[i], 0);
  }
  EXPECT_EQ(*std::max_element(of_raw.bytes.begin(), of_raw.bytes.end()), 255);
  const GreyImage black = grey_of(Image(8, 8, {"Y"}));
  for (const float v : black.values) EXPECT_EQ(v, 0);
}

}  // namespace
}  // namespace gonio::io
