// Published indices from the database's files, and each of the nine formulas against numbers worked out by hand.
#include "optics/refractive_index.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "base/error.h"
#include "data.h"

namespace gonio::optics {
namespace {

constexpr double d_line_m = 587.5618e-9;

RefractiveIndex database(const char* name) {
  return read_refractive_index(tests::data("optical/refractiveindex") / name);
}
RefractiveIndex formula(int number, const std::string& coefficients) {
  return parse_refractive_index("DATA:\n  - type: formula " + std::to_string(number) +
                                    "\n    wavelength_range: 0.2 2.0\n    coefficients: " + coefficients + "\n",
                                "inline.yml");
}
std::string message(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(RefractiveIndex, PublishedValues) {
  GONIO_NEEDS_DATA("optical/refractiveindex");
  EXPECT_NEAR(database("specs_schott_optical_N-BK7.yml").n(d_line_m), 1.51680, 5e-6);  // Schott's data sheet
  EXPECT_NEAR(database("specs_schott_optical_N-K5.yml").n(d_line_m), 1.52249, 5e-6);   // the same
  EXPECT_NEAR(database("specs_hikari_optical_K5.yml").n(d_line_m), 1.522490, 5e-6);    // nd in the file itself
  EXPECT_NEAR(database("main_SiO2_nk_Malitson.yml").n(d_line_m), 1.45846, 5e-6);       // Malitson 1965, table I
  EXPECT_NEAR(database("main_SiO2_nk_Malitson.yml").n(1.5295e-6), 1.44427, 5e-6);      // the same
  EXPECT_NEAR(database("main_CaCO3_nk_Ghosh-o.yml").n(589.3e-9), 1.6584, 5e-4);        // calcite, sodium D
  EXPECT_NEAR(database("main_CaCO3_nk_Ghosh-e.yml").n(589.3e-9), 1.4864, 5e-4);
  EXPECT_NEAR(database("glass_misc_soda-lime_nk_Rubin-clear.yml").n(550e-9),
              1.513 - 0.003169 * 0.3025 + 0.003962 / 0.3025, 1e-12);
  EXPECT_NEAR(database("organic_C5H8O2_n_-_poly_methyl_methacrylate_nk_Sultanova.yml").n(d_line_m), 1.491, 1e-3);
}

TEST(RefractiveIndex, TablesAreLinearBetweenTheirRows) {
  GONIO_NEEDS_DATA("optical/refractiveindex");
  const RefractiveIndex gold = database("main_Au_nk_Johnson.yml");
  EXPECT_DOUBLE_EQ(gold.n(0.5821e-6), 0.29);
  EXPECT_DOUBLE_EQ(gold.k(0.5821e-6), 2.863);
  const double half = (0.5821e-6 + 0.6168e-6) / 2;
  EXPECT_NEAR(gold.n(half), (0.29 + 0.21) / 2, 1e-12);
  EXPECT_NEAR(gold.k(half), (2.863 + 3.272) / 2, 1e-12);
  const RefractiveIndex aluminium = database("main_Al_nk_Rakic.yml");
  EXPECT_NEAR(aluminium.n(0.5e-6), 0.81, 0.05);  // about 0.8 + 6i in green
  EXPECT_NEAR(aluminium.k(0.5e-6), 6.05, 0.05);
}

TEST(RefractiveIndex, EveryFileOfTheSetIsRead) {
  GONIO_NEEDS_DATA("optical/refractiveindex");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(tests::data("optical/refractiveindex"))) {
    if (entry.path().extension() != ".yml") continue;
    ++files;
    const RefractiveIndex index = read_refractive_index(entry.path());
    for (const double wavelength_m : {450e-9, 550e-9, 650e-9}) {
      EXPECT_GT(index.n(wavelength_m), 0.01) << entry.path();
      EXPECT_LT(index.n(wavelength_m), 5) << entry.path();
      if (index.states_k()) {
        EXPECT_GE(index.k(wavelength_m), 0) << entry.path();
      }
    }
  }
  EXPECT_EQ(files, 19);
}

// All at 0.5 um: w^2 = 0.25, w^-2 = 4.
TEST(RefractiveIndex, NineFormulas) {
  constexpr double at = 0.5e-6;
  EXPECT_NEAR(formula(1, "0.1 0.5 0.1 0.2 0.3").n(at), std::sqrt(1.1 + 0.5 * 0.25 / 0.24 + 0.2 * 0.25 / 0.16), 1e-14);
  EXPECT_NEAR(formula(2, "0.1 0.5 0.1 0.2 0.05").n(at), std::sqrt(1.1 + 0.5 * 0.25 / 0.15 + 0.2 * 0.25 / 0.2), 1e-14);
  EXPECT_NEAR(formula(3, "2 0.1 2 0.01 -2").n(at), std::sqrt(2 + 0.1 * 0.25 + 0.01 * 4), 1e-14);
  // 2 + 0.3 * 0.5 / (0.25 - 0.3^2) + 0.02 * 0.25 / (0.25 - 0.04) + 0.01 * 4
  EXPECT_NEAR(formula(4, "2 0.3 1 0.3 2 0.02 2 0.2 2 0.01 -2").n(at), std::sqrt(2 + 0.15 / 0.16 + 0.005 / 0.21 + 0.04),
              1e-14);
  EXPECT_NEAR(formula(4, "2 0 0 0 0 0 0 0 0 0.01 -2").n(at), std::sqrt(2.04), 1e-14);
  EXPECT_NEAR(formula(5, "1.5 0.01 -2 -0.004 2").n(at), 1.5 + 0.04 - 0.001, 1e-14);
  EXPECT_NEAR(formula(6, "0.0001 0.05 200 0.002 60").n(at), 1.0001 + 0.05 / 196 + 0.002 / 56, 1e-14);
  EXPECT_NEAR(formula(7, "1.4 0.01 0.001 0.02 0.03 0.04").n(at),
              1.4 + 0.01 / 0.222 + 0.001 / (0.222 * 0.222) + 0.02 * 0.25 + 0.03 * 0.0625 + 0.04 * 0.015625, 1e-14);
  // (n^2 - 1) / (n^2 + 2) = 0.2 + 0.1 * 0.25 / 0.2 + 0.04 * 0.25 = 0.335
  EXPECT_NEAR(formula(8, "0.2 0.1 0.05 0.04").n(at), std::sqrt(1.67 / 0.665), 1e-14);
  // 2 + 0.02 / (0.25 - 0.05) + 0.03 * 0.2 / (0.2^2 + 0.01)
  EXPECT_NEAR(formula(9, "2 0.02 0.05 0.03 0.3 0.01").n(at), std::sqrt(2 + 0.1 + 0.12), 1e-14);
}

TEST(RefractiveIndex, FirstEntryThatCoversCounts) {
  const RefractiveIndex index = parse_refractive_index(
      "REFERENCES: |\n    DATA: not this\nDATA:\n- type: formula 5\n  range: 0.4 0.5\n  coefficients: 1.5 0.01\n    "
      "-2\n"
      "- type: tabulated n\n  data: |\n    0.7 1.4\n    0.45 1.45\n- type: tabulated k\n  data: |\n    0.4 0\n    0.7 "
      "3e-7\n"
      "PROPERTIES:\n  data: 7\n",
      "x.yml");
  EXPECT_NEAR(index.n(0.5e-6), 1.54, 1e-12);     // the formula, its coefficients over two lines
  EXPECT_NEAR(index.n(0.575e-6), 1.425, 1e-12);  // the table, written from long to short
  EXPECT_NEAR(index.k(0.55e-6), 1.5e-7, 1e-15);
  EXPECT_TRUE(index.covers_n(0.41e-6));
  EXPECT_FALSE(index.covers_k(0.39e-6));
}

TEST(RefractiveIndex, OutsideOfWhatAFileStates) {
  const RefractiveIndex index = formula(5, "1.5");
  const std::string said = message([&] { index.n(2.5e-6); });
  EXPECT_NE(said.find("inline.yml"), std::string::npos) << said;
  EXPECT_NE(said.find("2500 nm is outside of what it states, 200 nm to 2000 nm"), std::string::npos) << said;
  EXPECT_NE(message([&] { index.k(0.5e-6); }).find("states no extinction coefficient"), std::string::npos);
  EXPECT_NE(message([&] { formula(3, "-2").n(0.5e-6); }).find("no positive index"), std::string::npos);
}

TEST(RefractiveIndex, MalformedFilesAreNamed) {
  const auto said = [](const std::string& text) { return message([&] { parse_refractive_index(text, "f.yml"); }); };
  const std::string head = "DATA:\n  - type: ";
  EXPECT_NE(said("").find("no entry below DATA"), std::string::npos);
  EXPECT_NE(said(head + "formula 12\n").find("f.yml:2: type \"formula 12\""), std::string::npos);
  EXPECT_NE(said(head + "formula 1\n").find("no `range`"), std::string::npos);
  EXPECT_NE(said(head + "formula 1\n    wavelength_range: 0.5 0.4\n    coefficients: 1\n").find("growing"),
            std::string::npos);
  EXPECT_NE(said(head + "formula 9\n    wavelength_range: 0.4 0.5\n    coefficients: 1 2 3 4 5 6 7\n").find("1 to 6"),
            std::string::npos);
  EXPECT_NE(said(head + "tabulated nk\n    data: |\n        0.4 1.5\n").find("rows of 3"), std::string::npos);
  EXPECT_NE(said(head + "tabulated n\n    data: |\n        0.4 one\n").find("\"one\""), std::string::npos);
  EXPECT_NE(said(head + "tabulated n\n    data: |\n        0.4 nan\n").find("\"nan\""), std::string::npos);
  EXPECT_NE(said(head + "tabulated k\n    data: |\n        0.4 -1\n").find("negative"), std::string::npos);
  EXPECT_NE(said(head + "tabulated n\n    data: |\n        0.4 1\n        0.4 1\n").find("do not grow"),
            std::string::npos);
  EXPECT_NE(message([] { read_refractive_index("/nonexistent.yml"); }).find("cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace gonio::optics
