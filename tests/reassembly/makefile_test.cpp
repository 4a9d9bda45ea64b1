// scripts/experiments/reassembly.mk: as it stands in the manual, and what it would run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>

#include "base/atomic_file.h"
#include "data.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const fs::path steps_makefile = fs::path(GONIO_SOURCE) / "scripts/experiments/reassembly.mk";

Ended dry_run(const fs::path& folder, const std::vector<std::string>& more) {
  Process::Words words{
      "env", std::string("PATH=") + GONIO_BIN + ":" + std::getenv("PATH"), "make", "-n", "-f", steps_makefile.string()};
  words.insert(words.end(), more.begin(), more.end());
  return run(words, folder);
}

std::ptrdiff_t count(const std::string& text, const std::string& pattern) {
  const std::regex what(pattern);
  return std::distance(std::sregex_iterator(text.begin(), text.end(), what), std::sregex_iterator());
}

TEST(StepsOfReassembly, AreThoseOfTheManual) {
  EXPECT_THAT(read_file(fs::path(GONIO_SOURCE) / "man/prose/gonio.md"),
              HasSubstr("```\n" + read_file(steps_makefile) + "```\n"));
}

TEST(StepsOfReassembly, AreEightAndEachIsHeldAgainstThePhotograph) {
  ScratchFolder folder;
  const Ended dry = dry_run(folder.path(), {"POSES=truth"});
  ASSERT_EQ(dry.status, 0) << dry.err;
  for (const std::string step : {"a", "b", "c", "d", "e", "f", "g", "h"}) {
    EXPECT_EQ(count(dry.out, "render run/" + step + "\\.json --image front"), 1) << step;
    EXPECT_EQ(count(dry.out, "--rendered run/pictures/" + step + "/front\\.exr"), 1) << step;
  }
  EXPECT_EQ(count(dry.out, "ct-mesh-clean -i"), 4);
  EXPECT_EQ(count(dry.out, "unwrap run/balls\\.json"), 3);
  EXPECT_EQ(count(dry.out, "render run/absorb/[a-z]+-[0-9]+\\.json"), 10);
  EXPECT_THAT(dry.out, Not(HasSubstr("reassemble -i")));
  // The light of a step is unwrapped before it, and absorption is not sought in the picture that it is judged by.
  EXPECT_LT(dry.out.find("orthographic raw run/orthographic.exr"), dry.out.find("render run/a.json"));
  EXPECT_LT(dry.out.find("render run/absorb/soda-24.json"), dry.out.find("render run/absorb/borosilicate-0.json"));
  EXPECT_EQ(count(dry.out, "render run/absorb/[^ ]+ --image front"), 0);
}

// A line that goes on within parentheses keeps make's recipe prefix, which the shell then takes for a redirection.
TEST(StepsOfReassembly, RedirectNothingByAccident) {
  ScratchFolder folder;
  for (const std::string labels : {"LABELS=truth", "LABELS=photographs"})
    for (const std::string poses : {"POSES=truth", "POSES=markers"}) {
      const Ended dry = dry_run(folder.path(), {poses, labels});
      ASSERT_EQ(dry.status, 0) << dry.err;
      EXPECT_EQ(count(dry.out, ">  "), 0) << poses << ' ' << labels;
    }
}

TEST(StepsOfReassembly, AskReassembleWhereItIsThere) {
  ScratchFolder folder;
  const Ended dry = dry_run(folder.path(), {"POSES=markers"});
  ASSERT_EQ(dry.status, 0) << dry.err;
  EXPECT_EQ(count(dry.out, "reassemble -i run/rig\\.json"), 2);
  EXPECT_EQ(count(dry.out, "--contact elastic"), 1);
  EXPECT_EQ(count(dry.out, "--piece pot-lid=run/pot-lid\\.json"), 2);
  EXPECT_THAT(dry.out, Not(HasSubstr("reassembly-maker assemble")));
}

}  // namespace
}  // namespace gonio::tests
