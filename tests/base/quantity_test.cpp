#include "base/quantity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace gonio {
namespace {

TEST(Quantity, UnitsBecomeSi) {
  const auto length = [](const char* text) { return parse_quantity(text, Dimension::length, "--pitch"); };
  EXPECT_DOUBLE_EQ(length("18um"), 18e-6);
  EXPECT_DOUBLE_EQ(length("18\u00b5m"), 18e-6);
  EXPECT_DOUBLE_EQ(length(" 25 mm "), 0.025);
  EXPECT_DOUBLE_EQ(length("1e2nm"), 1e-7);
  EXPECT_DOUBLE_EQ(length("+3cm"), 0.03);
  EXPECT_DOUBLE_EQ(length("-2m"), -2);
  EXPECT_DOUBLE_EQ(parse_quantity("180deg", Dimension::angle, "-"), 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(parse_quantity("7.5mrad", Dimension::angle, "-"), 0.0075);
  EXPECT_DOUBLE_EQ(parse_quantity("600ms", Dimension::time, "-"), 0.6);
  EXPECT_DOUBLE_EQ(parse_quantity("2min", Dimension::time, "-"), 120);
  EXPECT_DOUBLE_EQ(parse_quantity("1%", Dimension::ratio, "-"), 0.01);
  EXPECT_DOUBLE_EQ(parse_quantity("0.25", Dimension::ratio, "-"), 0.25);
  EXPECT_DOUBLE_EQ(parse_quantity("3px", Dimension::pixel, "-"), 3);
  EXPECT_DOUBLE_EQ(parse_quantity("-4e-3", Dimension::none, "-"), -4e-3);
}

TEST(Quantity, RefusesWhatIsNotOne) {
  for (const char* text : {"", "mm", "25", "25deg", "25 m m", "nanm", "infm", "1e999m", "0x10m", "2,5mm", "25mmx"}) {
    try {
      parse_quantity(text, Dimension::length, "--square");
      ADD_FAILURE() << "accepted '" << text << "'";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::usage);
      EXPECT_EQ(error.place(), "--square");
      EXPECT_THAT(error.remedy(), testing::HasSubstr("mm"));
    }
  }
}

TEST(Quantity, EveryDimensionHasANameAndAnSiUnitOfItsOwn) {
  EXPECT_EQ(si_unit(Dimension::length), "m");
  EXPECT_EQ(si_unit(Dimension::angle), "rad");
  EXPECT_EQ(si_unit(Dimension::time), "s");
  EXPECT_EQ(dimension_name(Dimension::angle), "angle");
}

TEST(Error, IsOneLineOfPlaceProblemRemedy) {
  const Error error(Exit::data, "rig.json#/poses/3", "rotation is not orthonormal", "re-export with 7 digits");
  EXPECT_STREQ(error.what(), "rig.json#/poses/3: rotation is not orthonormal; re-export with 7 digits");
  EXPECT_STREQ(Error(Exit::data, "a", "b").what(), "a: b");
  EXPECT_STREQ(Error(Exit::data, "a\nb", "key '\x1b[2J'").what(), "a b: key ' [2J'");
}

TEST(Error, TableNamesEveryExitOnceInOrder) {
  int before = -1;
  for (const auto& row : exit_table()) {
    EXPECT_GT(static_cast<int>(row.code), before);
    EXPECT_FALSE(row.meaning.empty());
    before = static_cast<int>(row.code);
  }
  EXPECT_EQ(exit_table().size(), 11u);
}

}  // namespace
}  // namespace gonio
