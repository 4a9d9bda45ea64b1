// The manual says all that its prose says: headings of man/prose against those of the pages, in the order of
// man-pages(7).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "base/atomic_file.h"
#include "cli/program.h"
#include "cli/reference.h"
#include "cli/roff.h"
#include "data.h"
#include "manifest/fields.h"
#include "manifest/model.h"
#include "mechanism/mechanism.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::string unquoted(std::string name) {
  std::erase(name, '"');
  for (std::size_t at = 0; (at = name.find("\\-", at)) != std::string::npos;) name.erase(at, 1);
  return name;
}

std::vector<fs::path> all_pages() {
  std::vector<fs::path> pages;
  for (const auto& entry : fs::directory_iterator(fs::path(GONIO_SOURCE) / "man")) {
    const std::string kind = entry.path().extension();
    if (kind == ".1" || kind == ".5" || kind == ".7") pages.push_back(entry.path());
  }
  std::ranges::sort(pages);
  return pages;
}

// As a terminal shows it, without bold and underlines; every stretch of blanks is one.
std::string shown(const fs::path& page, Ended& set) {
  set = run({"groff", "-ww", "-Wbreak", "-t", "-man", "-Tutf8", "-P-c", "-P-b", "-P-u", page.string()});
  std::string text;
  for (std::size_t i = 0; i < set.out.size(); ++i) {
    if (set.out.compare(i, 3, "\u2212") == 0 || set.out.compare(i, 3, "\u2010") == 0) {
      text += '-';  // how minus and hyphen are drawn
      i += 2;
    } else if (set.out[i] != ' ' && set.out[i] != '\n') {
      text += set.out[i];
    } else if (!text.ends_with(' ')) {
      text += ' ';
    }
  }
  return text;
}

// Of a page: what stands behind .SH and .SS.
std::vector<std::string> headings_of_page(const std::string& page, bool subsections) {
  std::vector<std::string> found;
  std::istringstream in(page);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(".SH ") || (subsections && line.starts_with(".SS ")))
      found.push_back(unquoted(line.substr(4)));
  return found;
}

// Of prose, with "## subsections".
std::vector<std::string> headings_of_prose(const std::string& prose) {
  std::vector<std::string> found;
  for (const std::string& name : cli::headings_of(prose)) {
    found.push_back(name);
    std::istringstream in(cli::section_of(prose, name));
    bool code = false;
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("```")) code = !code;
      if (!code && line.starts_with("## ")) found.push_back(line.substr(3));
    }
  }
  return found;
}

std::string one_blank(const std::string& line) {
  std::istringstream words(line);
  std::string out;
  for (std::string word; words >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

fs::path page_of(const std::string& name) {
  const fs::path root = fs::path(GONIO_SOURCE) / "man";
  for (const char* section : {".1", ".5", ".7"})
    if (fs::exists(root / (name + section))) return root / (name + section);
  return {};
}

TEST(Manual, EveryHeadingOfTheProseStandsOnItsPageInItsOrder) {
  int pages = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(GONIO_SOURCE) / "man" / "prose")) {
    SCOPED_TRACE(entry.path().filename());
    const fs::path page = page_of(entry.path().stem());
    ASSERT_FALSE(page.empty());
    const std::vector<std::string> said = headings_of_prose(read_file(entry.path()));
    std::vector<std::string> printed = headings_of_page(read_file(page), true);
    ASSERT_FALSE(said.empty());
    std::erase_if(printed, [&](const std::string& name) { return std::ranges::count(said, name) == 0; });
    EXPECT_EQ(printed, said) << "run scripts/regenerate";
    ++pages;
  }
  EXPECT_GT(pages, 20);
}

cli::Program small_program() {
  cli::Program p;
  p.name = "small";
  p.sentence = "does little";
  p.synopsis = {"[OPTION]..."};
  p.references = {"A. Author 1999"};
  return p;
}

TEST(Manual, SectionsStandInTheOrderOfManPages) {
  const std::string page =
      cli::man_page(small_program(),
                    "# DESCRIPTION\nSmall.\n\n# THE TABLE\nRows.\n\n## Columns\nMany.\n\n"
                    "# NOTES\nLate.\n\n# EXAMPLES\n```\n# no heading\nsmall\n```\n\n# SECOND\nMore.\n\n"
                    "# ENVIRONMENT\nNone.\n\n# FILES\nFew.\n");
  EXPECT_THAT(headings_of_page(page, false),
              ElementsAre("NAME", "SYNOPSIS", "DESCRIPTION", "THE TABLE", "SECOND", "OPTIONS", "EXIT STATUS",
                          "ENVIRONMENT", "FILES", "NOTES", "EXAMPLES", "REFERENCES", "SEE ALSO"));
  for (const char* text : {"\nSmall.\n", "\nRows.\n", "\n.SS \"Columns\"\nMany.\n", "\nLate.\n", "\n# no heading\n",
                           "\nMore.\n", "\nNone.\n", "\nFew.\n"})
    EXPECT_THAT(page, HasSubstr(text));
}

TEST(Manual, SectionsThatNobodyWroteAreLeftOut) {
  EXPECT_THAT(
      headings_of_page(cli::man_page(small_program(), "# DESCRIPTION\nSmall.\n"), false),
      ElementsAre("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "FILES", "REFERENCES", "SEE ALSO"));
}

TEST(Manual, ABarWithinACellDoesNotEndIt) {
  const std::string page = cli::roff_from_markdown("| what | unit |\n|---|---|\n| mean of \\|x\\| | m |\n");
  EXPECT_THAT(page, HasSubstr("T{\nmean of |x|\nT}\tT{\nm\nT}"));
}

// A star opens what a later one closes, before a word and not behind one; products, patterns and assignments stay.
TEST(Manual, StarsThatOpenNothingAreStars) {
  for (const char* text : {"pixel value *= 1", "a*cos(theta)+b *2* c*d", "left*.jpg right*.jpg",
                           "E *= (D / d)^2, a *= b", "2 * 3 * 4", "a**b and c**d", "*.png"}) {
    std::string printed = cli::roff_text(text);
    EXPECT_EQ(std::ranges::count(printed, '*'),
              std::ranges::count(std::string(text), '*') - 2 * (std::string(text).find("*2*") != std::string::npos))
        << printed;
  }
  EXPECT_EQ(cli::roff_text("*first*, **second**: `a*b` x*y"), "\\fIfirst\\fR, \\fBsecond\\fR: \\fBa*b\\fR x*y");
  EXPECT_EQ(cli::roff_text("`x' = r^2 ~ -1`"), "\\fBx\\(aq = r\\(ha2 \\(ti \\-1\\fR");
  EXPECT_THAT(cli::roff_from_markdown("```\n'a' \\ *= `b`\n```\n"), HasSubstr("\n\\(aqa\\(aq \\(rs *= \\(gab\\(ga\n"));
}

// Lines that do not fill a narrow column of a table ("cannot adjust line") are no fault of the text.
TEST(Manual, EveryPageIsSetWithoutWarnings) {
  for (const auto* program : cli::all_programs()) EXPECT_FALSE(page_of(program->name).empty()) << program->name;
  for (const fs::path& page : all_pages()) {
    Ended set;
    const std::string text = shown(page, set);
    if (set.status == 127) GTEST_SKIP() << "groff is not installed";
    EXPECT_EQ(set.err, "") << page.filename();
    EXPECT_GT(text.size(), 2000u) << page.filename();
  }
}

TEST(Manual, EquationsStandAsTheRegistryHasThem) {
  Ended set;
  const std::string text = shown(page_of("gonio-mechanisms"), set);
  if (set.status == 127) GTEST_SKIP() << "groff is not installed";
  EXPECT_GT(mechanism::all_mechanisms().size(), 60u);
  for (const auto* m : mechanism::all_mechanisms())
    EXPECT_THAT(text, HasSubstr(" " + one_blank(m->equation) + " ")) << m->id;
}

// Formulas of the prose are fenced code.
TEST(Manual, FencedLinesStandAsTheyAreWritten) {
  for (const char* name : {"gonio-surfaces", "gonio-mechanisms", "gonio-conventions", "gonio-nrsfm"}) {
    Ended set;
    const std::string text = shown(page_of(name), set);
    if (set.status == 127) GTEST_SKIP() << "groff is not installed";
    std::istringstream prose(read_file(fs::path(GONIO_SOURCE) / "man" / "prose" / (std::string(name) + ".md")));
    bool code = false;
    for (std::string line; std::getline(prose, line);) {
      if (line.starts_with("```")) {
        code = !code;
      } else if (code) {
        EXPECT_THAT(text, HasSubstr(one_blank(line))) << name;
      }
    }
  }
}

TEST(Manual, LongPagesStartWithTheirContents) {
  int long_pages = 0;
  for (const fs::path& page : all_pages()) {
    const std::string text = read_file(page);
    if (std::ranges::count(text, '\n') < 500) continue;
    ++long_pages;
    const std::vector<std::string> headings = headings_of_page(text, false);
    ASSERT_GT(headings.size(), 1u);
    EXPECT_EQ(headings[1], "CONTENTS") << page.filename();
    const std::string contents = text.substr(0, text.find(".SH \"DESCRIPTION\""));
    for (const std::string& heading : headings_of_page(text, true))
      if (heading != "NAME" && heading != "CONTENTS") {
        EXPECT_THAT(unquoted(contents), HasSubstr(heading)) << page.filename();
      }
  }
  EXPECT_GE(long_pages, 4);
}

TEST(Manual, SurfacesHaveTheirDefaultsAndBounds) {
  const std::string page = read_file(page_of("gonio-surfaces"));
  for (const auto family : {manifest::Family::surface, manifest::Family::law})
    for (const auto* model : manifest::models(family))
      for (const auto& p : model->parameters)
        EXPECT_THAT(page,
                    HasSubstr("\nT}\tT{\n" + (p.preset ? cli::roff_text(manifest::shown_number(*p.preset)) : "needed") +
                              "\nT}\tT{\n" + cli::roff_text(manifest::bounds_text(p.lower, p.upper)) + "\nT}\tT{\n" +
                              cli::roff_text(p.meaning) + "\nT}"))
            << model->id << "." << p.name;
}

}  // namespace
}  // namespace gonio::tests
