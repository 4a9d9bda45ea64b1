// Sensofar's PLu files put together here byte by byte from the places of their fields, and damaged ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/error.h"
#include "io/height_map.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

struct Plu {
  std::string date = "Tue Mar  6 15:28:50 2007";
  std::uint32_t kind = 3, width = 4, height = 3;
  float step_x = 0.83f, step_y = 1.66f;
};

template <class T>
void put(std::string& file, std::size_t at, T value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

std::string plu(const Plu& p = {}, std::size_t points = 12) {
  std::string file(508 + 4 * points + 8, '\0');
  file.replace(0, p.date.size(), p.date);
  file.replace(132, 7, "comment");
  put(file, 388, p.height), put(file, 392, p.width);
  put(file, 404, p.step_x), put(file, 408, p.step_y);
  put(file, 428, p.kind);
  file[489] = 1, file[490] = '\xff';
  put(file, 500, p.height), put(file, 504, p.width);
  for (std::size_t i = 0; i < points; ++i) put(file, 508 + 4 * i, static_cast<float>(i) * 0.25f - 1);
  return file;
}

std::string plu_refusal(const std::string& bytes) {
  try {
    parse_height_map(bytes, "t.plu");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.problem();
  }
  return "none";
}

TEST(Plu, HeightsStepsAndHoles) {
  std::string file = plu();
  put(file, 508 + 4 * 6, 1000001.0f);
  put(file, 508 + 4 * 7, std::nanf(""));
  put(file, 508 + 4 * 8, INFINITY);
  EXPECT_TRUE(is_height_map(file.substr(0, height_map_beginning)));
  const HeightMap map = parse_height_map(file, "t.plu");
  ASSERT_EQ(map.width, 4u);
  ASSERT_EQ(map.height, 3u);
  EXPECT_NEAR(map.step_x_m, 0.83e-6, 1e-13);
  EXPECT_NEAR(map.step_y_m, 1.66e-6, 1e-13);
  EXPECT_NEAR(map.at(3, 0), -0.25e-6, 1e-15);
  EXPECT_NEAR(map.at(1, 2), 1.25e-6, 1e-15);
  for (const auto& [x, y] : {std::pair{2, 1}, {3, 1}, {0, 2}})
    EXPECT_TRUE(std::isnan(map.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y))));
}

TEST(Plu, DamagedAndOtherFilesAreRefused) {
  const std::string good = plu();
  for (std::size_t length = 0; length < good.size() - 8; length += 7)
    EXPECT_NE(plu_refusal(good.substr(0, length)), "none") << length;
  EXPECT_THAT(plu_refusal(plu({.kind = 1})), HasSubstr("holds a profile"));
  EXPECT_THAT(plu_refusal(plu({.kind = 77})), HasSubstr("kind 77"));
  EXPECT_THAT(plu_refusal(plu({.width = 0xffffffffu, .height = 0xffffffffu})), HasSubstr("4294967295 x 4294967295"));
  EXPECT_THAT(plu_refusal(plu({.width = 30000, .height = 30000})), HasSubstr("its head asks for 3600000508"));
  EXPECT_THAT(plu_refusal(plu({.width = 0})), HasSubstr("0 x 3 points"));
  EXPECT_THAT(plu_refusal(plu({.step_x = 0})), HasSubstr("no step between points along x"));
  EXPECT_THAT(plu_refusal(plu({.step_y = std::nanf("")})), HasSubstr("no step between points along y"));
  EXPECT_NEAR(parse_height_map(plu({.step_y = -2}), "t").step_y_m, 2e-6, 1e-13);
}

// Any text may begin with a date; what follows tells.
TEST(Plu, ADateAloneIsNone) {
  for (const char* text : {"Tue Mar  6 15:28:50 2007, 5.1, 3.2 and more of it",
                           "Tuesday, 6 March 2007 at 15:28 in Paris", "Xue Mar  6 15:28:50 2007", "Tue Mar 06 15:28"})
    EXPECT_FALSE(is_height_map(text)) << text;
}

}  // namespace
}  // namespace gonio::io
