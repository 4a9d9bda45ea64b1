// Files of observations as people have them: the same numbers from columns between commas, blanks, tabs and semicolons,
// named in the first line or in a comment; .brdf with its bands; what is wrong is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "explain/tables/quick_table.h"
#include "explain/tables/read_table.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables::tests {
namespace {

using testing::HasSubstr;

class ColumnFiles : public testing::Test {
 protected:
  RawTable raw(const std::string& name, const std::string& text) {
    write_file(folder_ / name, text);
    return read_raw(folder_ / name, {}, "t");
  }
  std::string refusal(const std::string& name, const std::string& text) {
    try {
      raw(name, text);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "none";
  }
  gonio::tests::ScratchFolder folder_;
};

TEST_F(ColumnFiles, EverySeparatorMeansTheSame) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.csv", "lamp,theta [deg],f\nred,90,1.5\nblue,180,-2e-3\n"},
      {"b.txt", "lamp theta [deg] f\nred 90 1.5\nblue 180 -2e-3\n"},
      {"c.txt", "  lamp   theta [deg]\t f \r\n\r\n  red   90   1.5\r\n  blue  180 -2e-3  \r\n"},
      {"d.tsv", "lamp\ttheta [deg]\tf\nred\t90\t1.5\nblue\t180\t-2e-3\n"},
      {"e.csv", "lamp; theta [deg]; f\nred; 90; 1.5\nblue; 180; -2e-3\n"},
      {"f.dat", "# a scan\n# lamp theta [deg] f\nred 90 1.5\nblue 180 -2e-3\n# the end\n"}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const RawTable table = raw(name, text);
    ASSERT_EQ(table.columns, (std::vector<std::string>{"lamp", "theta", "f"}));
    EXPECT_EQ(table.labels[0], (std::vector<std::string>{"red", "blue"}));
    EXPECT_NEAR(table.values[1][1], 3.14159265, 1e-8);
    EXPECT_EQ(table.values[2], (std::vector<double>{1.5, -2e-3}));
  }
}

TEST_F(ColumnFiles, WhatIsWrongIsSaidAtItsLine) {
  EXPECT_THAT(refusal("a.txt", "1 2 3\n4 5 6\n"), HasSubstr("column 1 has no name"));
  EXPECT_THAT(refusal("a.txt", "a b c\n1 2 3\n4 5\n"), HasSubstr("a.txt:3: has 2 fields"));
  EXPECT_THAT(refusal("a.txt", "a b c\n1 2 3\n4 5 six\n"), HasSubstr("a.txt:3: c: \"six\" is no number"));
  EXPECT_THAT(refusal("a.txt", "a b a\n1 2 3\n"), HasSubstr("names column \"a\" twice"));
  EXPECT_THAT(refusal("a.txt", "a b c\n"), HasSubstr("has a header and no rows"));
  EXPECT_THAT(refusal("a.txt", ""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("a.txt", "\n\v\n\f\r\n"), HasSubstr("is empty"));
  EXPECT_THAT(refusal("a.txt", std::string("a b\n1 \0 2\n", 10)), HasSubstr("zero byte"));
}

// Two bands at four pairs of directions, one of them beyond the grazing limit, one value negative.
const char* const two_bands =
    "# a paint\n2\n450 650\n0.2 0 0.3 3.1415926 0.11 0.21\n0.4 0.5 0.3 1 0.12 0.22\n0.4 0 1.56 0 9 9\n"
    "0.6 0 0.1 0 -0.5 0.24\n";

TEST_F(ColumnFiles, BrdfFilesBecomeARowForEveryBand) {
  const RawTable table = raw("paint.brdf", two_bands);
  EXPECT_EQ(table.columns, (std::vector<std::string>{"theta_i", "phi_i", "theta_o", "phi_o", "wavelength_m", "f"}));
  EXPECT_THAT(table.values[4],
              testing::ElementsAre(testing::DoubleNear(450e-9, 1e-15), testing::DoubleNear(650e-9, 1e-15),
                                   testing::DoubleNear(450e-9, 1e-15), testing::DoubleNear(650e-9, 1e-15),
                                   testing::DoubleNear(650e-9, 1e-15)));
  EXPECT_THAT(table.values[5], testing::ElementsAre(0.11, 0.21, 0.12, 0.22, 0.24));
  EXPECT_NEAR(table.values[0][2], 0.4, 1e-12);
  EXPECT_NEAR(table.values[1][2], 0.5, 1e-12);
  EXPECT_NEAR(table.values[2][2], 0.3, 1e-12);
  EXPECT_NEAR(table.values[3][2], 1, 1e-12);
  EXPECT_THAT(refusal("cut.brdf", "2\n450 650\n0.2 0 0.3"), HasSubstr("cut.brdf:3: ends within its first row"));
  EXPECT_THAT(refusal("word.brdf", "2\n450 red\n"), HasSubstr("\"red\" is no number"));
  EXPECT_THAT(refusal("huge.brdf", "4000000000\n450\n"), HasSubstr("no number of wavelengths"));
}

TEST_F(ColumnFiles, ABrdfFileAloneIsHeldAgainstLambert) {
  write_file(folder_ / "paint.brdf", two_bands);
  const manifest::Document d = quick_document({.file = folder_ / "paint.brdf", .model = "surface", .observed = {"f"}});
  const manifest::Table& table = d.tables.at("paint");
  EXPECT_EQ(d.files.at(table.file).bytes, std::string(two_bands).size());
  EXPECT_EQ(table.observed, std::vector<std::string>{"f"});
  EXPECT_EQ(d.surfaces.at(table.surface).model, "diffuse");
  // What is written is read again, with the columns that it states.
  EXPECT_EQ(read_raw(folder_ / "paint.brdf", table, "t").values, raw("paint.brdf", two_bands).values);
}

}  // namespace
}  // namespace gonio::explain::tables::tests
