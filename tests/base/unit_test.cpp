#include "base/unit.h"

#include <gtest/gtest.h>

namespace gonio {
namespace {

TEST(Units, ProductsAndPowersAreRead) {
  EXPECT_EQ(Unit("W/m^2").text(), "W m^-2");
  EXPECT_EQ(Unit("W/(m^2 sr)").text(), "W m^-2");
  EXPECT_EQ(Unit("px m^-0.5").text(), "px m^-0.5");
  EXPECT_EQ(Unit("m/m").text(), "1");
  EXPECT_EQ(Unit("m * s / K").text(), "m s K^-1");
}

TEST(Units, AnglesAndRatiosAreNumbers) {
  for (const char* text : {"rad", "1", "", "%", "sr", "1/sr", "half diagonal", "half board"})
    EXPECT_TRUE(Unit(text).is_number()) << text;
  EXPECT_FALSE(Unit("counts").is_number());
  EXPECT_FALSE(Unit("half m").is_number());
}

TEST(Units, TheCoefficientOfATermMakesItAResidual) {
  const Unit coefficient = Unit("px") / (Unit("m").power(2) * Unit("s").power(-0.5));
  EXPECT_EQ(coefficient.text(), "px m^-2 s^0.5");
  EXPECT_EQ(coefficient * Unit("m").power(2) / Unit("s").power(0.5), Unit("px"));
  EXPECT_FALSE(Unit("m") == Unit("s"));
}

}  // namespace
}  // namespace gonio
