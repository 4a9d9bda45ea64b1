#include "colour/chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/text.h"
#include "data.h"

namespace gonio::colour {
namespace {

using testing::HasSubstr;

const auto d50 = optics::illuminant("D50", "test");

std::string patches(int count, const std::string& value = R"("lab": [50, 0, 0])") {
  std::string text;
  for (int i = 0; i < count; ++i) text += format(R"(%s{"name": "p%d", %s})", i == 0 ? "" : ", ", i, value.c_str());
  return text;
}
std::string chart(const std::string& head, const std::string& list) {
  return R"({"name": "c", )" + head + R"("patches": [)" + list + "]}";
}
std::string refusal(const std::string& json) {
  try {
    parse_chart(json, "c.json", d50, "D50");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.what();
  }
  return "accepted";
}

TEST(ColorChecker, HasTheEditionsPublishedValues) {
  GONIO_NEEDS_DATA("colour/colorchecker-reference");
  for (const std::string edition : {"after", "before"}) {
    const Chart own = colorchecker_classic(edition + "-2014", "test");
    std::ifstream file(tests::data("colour/colorchecker-reference") /
                       ("data_colorchecker24_" + edition + "_nov2014_cie_lab.csv"));
    std::string line;
    std::getline(file, line);
    std::size_t rows = 0;
    for (; std::getline(file, line); ++rows) {
      std::istringstream cells(line.substr(line.find(',') + 1));
      optics::Lab lab;
      char comma = 0;
      cells >> lab.x >> comma >> lab.y >> comma >> lab.z;
      EXPECT_EQ(own.patches[rows].lab, lab) << own.patches[rows].name;
      EXPECT_TRUE(line.starts_with(own.patches[rows].name)) << line;
    }
    EXPECT_EQ(rows, 24u);
  }
  EXPECT_THROW(colorchecker_classic("1976", "--edition"), Error);
}

TEST(ColorChecker, LiesInItsFrameAndKnowsItsGreys) {
  const Chart own = colorchecker_classic("after-2014", "test");
  EXPECT_NEAR(own.patches[0].centre.x - own.patches[0].size.x / 2, 0, 1e-12);
  EXPECT_NEAR(own.patches[23].centre.y + own.patches[23].size.y / 2, 1, 1e-12);
  for (std::size_t p = 0; p < 24; ++p) EXPECT_EQ(own.patches[p].neutral, p >= 18) << own.patches[p].name;
  // Patches are squares.
  EXPECT_NEAR(own.patches[0].size.y * own.height_over_width, own.patches[0].size.x, 1e-12);
}

TEST(ChartFile, TakesLabXyzAndReflectances) {
  const Chart c = parse_chart(chart(R"("grid": [3, 2], "patch_share": 0.8, "wavelengths_nm": [380, 780], )",
                                    patches(5) + R"(, {"name": "g", "reflectance": [0.5, 0.5]})"),
                              "c.json", d50, "D50");
  EXPECT_EQ(c.columns, 3);
  EXPECT_LT(std::abs(c.patches[5].xyz.y - 0.5), 1e-9);
  EXPECT_LT(norm(c.patches[5].lab - optics::lab_from_xyz(optics::white_d50 * 0.5, optics::white_d50)), 1e-9);
  const Chart x = parse_chart(chart(R"("white": [1, 1, 1], "grid": [3, 2], )", patches(6, R"("xyz": [0.3, 0.3, 0.3])")),
                              "c.json", d50, "D50");
  EXPECT_LT(norm(x.patches[0].xyz - optics::white_d50 * 0.3), 1e-9);
}

// A light's own colour is not a patch's: greys stay grey under any, and chroma changes as reflectances say.
TEST(ChartFile, ReflectancesAreLitAsSaid) {
  const std::string json =
      chart(R"("grid": [3, 2], "wavelengths_nm": [380, 550, 780], )",
            patches(5, R"("reflectance": [0.2, 0.2, 0.2])") + R"(, {"name": "red", "reflectance": [0.05, 0.2, 0.8]})");
  const Chart day = parse_chart(json, "c.json", d50, "D50"),
              lamp = parse_chart(json, "c.json", optics::illuminant("A", "test"), "A");
  EXPECT_LT(norm(day.patches[0].lab - lamp.patches[0].lab), 1e-9);
  EXPECT_GT(optics::ciede2000(day.patches[5].lab, lamp.patches[5].lab), 1);
  EXPECT_EQ(lamp.light, "A");
}

TEST(ChartFile, RefusesWhatContradictsItself) {
  EXPECT_THAT(refusal("{"), HasSubstr("c.json"));
  EXPECT_THAT(refusal(chart(R"("grid": [3, 2], )", patches(5))), HasSubstr("are 5, and the grid has 6"));
  EXPECT_THAT(refusal(chart(R"("grid": [3], )", patches(6))), HasSubstr("/grid: has 1 numbers, needs 2"));
  EXPECT_THAT(refusal(chart(R"("grid": [1, 6], )", patches(6))), HasSubstr("/grid"));
  EXPECT_THAT(refusal(chart(R"("grid": [2, 2], )", patches(4))), HasSubstr("are 4, 6 or more are needed"));
  EXPECT_THAT(refusal(chart(R"("grid": [3, 2], )", patches(6, R"("lab": [50, 0])"))), HasSubstr("/patches/0/lab"));
  EXPECT_THAT(refusal(chart(R"("grid": [3, 2], )", patches(6, R"("lab": [50, 0, 0], "xyz": [1, 1, 1])"))),
              HasSubstr("needs exactly one of"));
  EXPECT_THAT(refusal(chart(R"("grid": [3, 2], )", patches(5) + ", " + patches(1))), HasSubstr("stands twice"));
  EXPECT_THAT(refusal(chart("", patches(6))), HasSubstr("without a grid give [u, v]"));
  EXPECT_THAT(refusal(chart(R"("grid": [3, 2], "wavelengths_nm": [380, 780], )",
                            patches(6, R"("reflectance": [0.1, 0.2, 0.3])"))),
              HasSubstr("/patches/0/reflectance: has 3 numbers, needs 2"));
  EXPECT_THAT(
      refusal(chart(R"("grid": [3, 2], "wavelengths_nm": [500, 600], )", patches(6, R"("reflectance": [0.1, 0.2])"))),
      HasSubstr("cover 500 to 600 nm"));
  EXPECT_THAT(refusal(chart(R"("gird": [3, 2], )", patches(6))), HasSubstr("/gird: is not a key"));
}

}  // namespace
}  // namespace gonio::colour
