#include "base/text.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace gonio {
namespace {

TEST(Text, ShortestDigitsReadBack) {
  EXPECT_EQ(shortest_text(0.1), "0.1");
  EXPECT_EQ(shortest_text(-3), "-3");
  EXPECT_EQ(shortest_text(-0.0), "0");
  for (const double v : {1.0 / 3, 1e-300, 532.8049999999999, 6.02e23})
    EXPECT_EQ(std::strtod(shortest_text(v).c_str(), nullptr), v);
}

TEST(Text, FileStems) {
  EXPECT_EQ(file_stem("view-0_a.b"), "view-0_a.b");
  EXPECT_EQ(file_stem("../a b/\xc3\xa4"), ".._a_b___");
}

TEST(Text, EditDistances) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("treads", "threads"), 1u);
}

TEST(Text, FormatsAnyLength) {
  const std::string name(1000, 'x');
  EXPECT_EQ(format("camera %s: %.2f px, %d corners", name.c_str(), 0.126, 7),
            "camera " + name + ": 0.13 px, 7 corners");
  EXPECT_EQ(format("%s", ""), "");
}

}  // namespace
}  // namespace gonio
