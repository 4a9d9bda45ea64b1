// What scripts/slurm would submit, without any cluster, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "base/atomic_file.h"
#include "data.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const fs::path source = GONIO_SOURCE;

// A scontrol that finds no cluster at once; Debian's tries for a minute.
class SlurmPlan : public testing::Test {
 protected:
  SlurmPlan() {
    write_file(bin_ / "scontrol", "#!/bin/sh\nexit 1\n");
    fs::permissions(bin_ / "scontrol", fs::perms::owner_all);
  }
  Ended slurm(const std::vector<std::string>& more) const {
    Process::Words words{"env", "PATH=" + bin_.path().string() + ":/usr/bin:/bin", source / "scripts/slurm"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder_.path());
  }
  ScratchFolder folder_, bin_;
};

// Every match of a pattern's first group.
std::vector<std::string> all_of(const std::string& text, const std::string& pattern) {
  const std::regex what(pattern);
  std::vector<std::string> found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), what); it != std::sregex_iterator(); ++it)
    found.push_back((*it)[1]);
  return found;
}

TEST_F(SlurmPlan, TheFactorialIsFiveArrays) {
  const Ended plan = slurm({"-f", source / "scripts/experiments/nrsfm.mk", "--dry-run", "--most", "20", "--time",
                            "1:00:00", "--cpus", "2", "--memory", "4G", "--partition", "day", "--", "--account=us"});
  ASSERT_EQ(plan.status, 0) << plan.err;
  EXPECT_THAT(all_of(plan.out, "--array=([^ ]*)"), ElementsAre("0", "0-4", "0-119%20", "0-119%20", "0"));
  EXPECT_THAT(all_of(plan.out, "--dependency=([^ ]*)"),
              ElementsAre("afterok:$j0", "afterok:$j1", "aftercorr:$j2", "afterok:$j3"));
  for (const char* option : {"--time=1:00:00", "--cpus-per-task=2", "--mem=4G", "--partition=day", "--account=us",
                             "--requeue", "--signal=B:TERM@60"})
    EXPECT_EQ(all_of(plan.out, std::string("( ") + option + ")").size(), 5u) << option;
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

// As many elements as make would run recipes, for Makefiles of every kind.
TEST_F(SlurmPlan, HasAnElementForEveryRecipe) {
  for (const char* name : {"nrsfm", "laboratory", "ct-cleaning", "ladders", "render-shares"}) {
    SCOPED_TRACE(name);
    const std::string file = source / "scripts/experiments" / (std::string(name) + ".mk");
    const Ended plan = slurm({"-f", file, "--dry-run"});
    ASSERT_EQ(plan.status, 0) << plan.err;
    const Ended dry = run({"make", "-n", "--trace", "-f", file}, folder_.path());
    ASSERT_EQ(dry.status, 0) << dry.err;
    const auto recipes = all_of(dry.out, "\n?[^\n]*\\.mk:[0-9]+: (target|update target) ").size();
    EXPECT_GT(recipes, 5u);
    EXPECT_EQ(all_of(plan.out, "\n# [0-9]+: (make) ").size(), recipes);
  }
}

// An element takes what it needs for made: make would run its recipe and no other.
TEST_F(SlurmPlan, ElementsMakeOneTargetEach) {
  const std::string file = source / "scripts/experiments/laboratory.mk";
  const Ended plan = slurm({"-f", file, "--dry-run", "SPP=3 4"});
  ASSERT_EQ(plan.status, 0) << plan.err;
  const auto elements = all_of(plan.out, "\n# [0-9]+: (make [^\n]*)");
  ASSERT_GT(elements.size(), 20u);
  for (const std::string& element : elements) {
    const Ended dry = run({"sh", "-c", element + " -n --trace"}, folder_.path());
    ASSERT_EQ(dry.status, 0) << dry.err;
    EXPECT_EQ(all_of(dry.out, "\n?[^\n]*\\.mk:[0-9]+: (target|update target) ").size(), 1u) << element;
    EXPECT_THAT(element, HasSubstr("'SPP=3 4'"));
  }
}

TEST_F(SlurmPlan, UpToDateIsNotPlanned) {
  write_file(folder_ / "Makefile", "all: b\na:\n\ttouch a\nb: a\n\ttouch b\nc: b | d\n\ttouch c\nd:\n\ttouch d\n");
  write_file(folder_ / "a", "");
  const Ended one = slurm({"--dry-run"});
  EXPECT_THAT(all_of(one.out, "# [0-9]+: (make .*)"), ElementsAre(testing::EndsWith(" b")));
  write_file(folder_ / "b", "");
  EXPECT_EQ(slurm({"--dry-run"}).err, "slurm: nothing to submit: all is up to date\n");
  // Order-only: waited for, and no reason to make c.
  write_file(folder_ / "c", "");
  EXPECT_THAT(all_of(slurm({"--dry-run", "c"}).out, "# [0-9]+: (make .*)"), ElementsAre(testing::EndsWith(" d")));
  fs::remove(folder_ / "a");
  EXPECT_THAT(all_of(slurm({"--dry-run", "c"}).out, "# [0-9]+: (make .*)"),
              ElementsAre(testing::EndsWith(" a"), testing::EndsWith(" d"), testing::EndsWith("-o a -W a b"),
                          testing::EndsWith("-o b -W b -o d c")));
}

TEST_F(SlurmPlan, RefusesInWords) {
  const auto refused = [&](const std::vector<std::string>& words, int status, const std::string& says) {
    const Ended ended = slurm(words);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(says));
    EXPECT_EQ(ended.out, "");
  };
  write_file(folder_ / "Makefile", "all:\n\ttouch all\n");
  refused({"nothing.such"}, 65, "No rule to make target 'nothing.such'");
  refused({"-f", "missing.mk"}, 65, "missing.mk: No such file or directory");
  refused({"--frobnicate"}, 64, "unrecognized arguments: --frobnicate; see scripts/slurm --help");
  refused({"--most", "0"}, 64, "0: a whole number from 1 on");
  refused({"--time", "soon"}, 64, "--time soon: not as sbatch takes it: 30, 1:00:00, 2-00:00:00");
  refused({"--time", "1"}, 64, "--time 1 is not longer than --notice 60");
  refused({"-C", "missing"}, 64, "-C missing: No such file or directory");
  write_file(folder_ / "file", "");
  EXPECT_EQ(slurm({"--dry-run", "--help"}).status, 0);
  // No sbatch on the path.
  fs::create_directories(folder_ / "bin");
  for (const char* program : {"python3", "env", "make", "sh"})
    fs::create_symlink(fs::path("/usr/bin") / program, folder_ / "bin" / program);
  const Ended none = run({"env", "PATH=" + (folder_ / "bin").string(), source / "scripts/slurm"}, folder_.path());
  EXPECT_EQ(none.status, 69);
  EXPECT_THAT(none.err, StartsWith("slurm: there is no sbatch: apt-get install slurm-client"));
}

}  // namespace
}  // namespace gonio::tests
