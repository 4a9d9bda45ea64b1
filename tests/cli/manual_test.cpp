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
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::string unquoted(std::string name) {
  std::erase(name, '"');
  return name;
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

// Lines that do not fill a narrow column of a table ("cannot adjust line") are no fault of the text.
TEST(Manual, PagesOfProgramsAreSetWithoutWarnings) {
  for (const auto* program : cli::all_programs()) {
    const Ended set = run({"groff", "-ww", "-Wbreak", "-t", "-man", "-Tutf8", page_of(program->name)});
    if (set.status == 127) GTEST_SKIP() << "groff is not installed";
    EXPECT_EQ(set.err, "") << program->name;
    EXPECT_GT(set.out.size(), 2000u) << program->name;
  }
}

}  // namespace
}  // namespace gonio::tests
