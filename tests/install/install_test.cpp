// What `cmake --install` leaves behind is usable: programs run, man finds their pages from the PATH, nothing is
// missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "cli/program.h"
#include "data.h"

namespace gonio {
namespace {

namespace fs = std::filesystem;

struct Ended {
  int status;
  std::string text;  // stdout and stderr
};

Ended shell(const std::string& command, const fs::path& log) {
  const int status = std::system(("( " + command + " ) >'" + log.string() + "' 2>&1 </dev/null").c_str());
  std::ostringstream text;
  text << std::ifstream(log).rdbuf();
  return {WEXITSTATUS(status), text.str()};
}

class Installed : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch = new tests::ScratchFolder;
    const auto log = *scratch / "log";
    const auto destination = *scratch / "dest";
    const Ended ended =
        shell("DESTDIR='" + destination.string() + "' cmake --install '" GONIO_BUILD "' --prefix /p", log);
    ASSERT_EQ(ended.status, 0) << ended.text;
    prefix = destination / "p";
  }
  static void TearDownTestSuite() {
    delete scratch;
    scratch = nullptr;
  }
  // With the installed bin/ first on the PATH and no other hint to where things are.
  static Ended run(const std::string& command) {
    return shell("unset MANPATH; PATH='" + (prefix / "bin").string() + "':\"$PATH\"; " + command, *scratch / "log");
  }
  static inline tests::ScratchFolder* scratch = nullptr;
  static inline fs::path prefix;
};

TEST_F(Installed, EveryProgramRuns) {
  for (const auto* program : cli::all_programs()) {
    const Ended ended = run("test \"$(command -v " + program->name + ")\" = '" +
                            (prefix / "bin" / program->name).string() + "' && " + program->name + " --help");
    EXPECT_EQ(ended.status, 0) << program->name << ": " << ended.text;
    EXPECT_THAT(ended.text, testing::HasSubstr(program->sentence));
  }
}

TEST_F(Installed, ManFindsEveryPageFromThePath) {
  if (run("command -v man").status != 0) GTEST_SKIP() << "no man here";
  for (const auto* program : cli::all_programs()) {
    const Ended ended = run("man -w " + program->name);
    EXPECT_THAT(ended.text, testing::StartsWith((prefix / "share/man/man1").string())) << program->name;
  }
  EXPECT_EQ(run("man -w 5 gonio-manifest").status, 0);
  EXPECT_EQ(run("man -w 7 gonio-conventions").status, 0);
}

TEST_F(Installed, EveryProgramHasItsCompletions) {
  for (const auto* program : cli::all_programs()) {
    const auto& name = program->name;
    EXPECT_TRUE(fs::exists(prefix / "share/bash-completion/completions" / name)) << name;
    EXPECT_TRUE(fs::exists(prefix / "share/zsh/site-functions" / ("_" + name))) << name;
    EXPECT_TRUE(fs::exists(prefix / "share/fish/vendor_completions.d" / (name + ".fish"))) << name;
  }
}

TEST_F(Installed, SchemasAndLicenceAreThere) {
  EXPECT_FALSE(fs::is_empty(prefix / "share/gonio/schemas"));
  EXPECT_TRUE(fs::exists(prefix / "share/doc/gonio/LICENSE"));
}

// base/loaded_library.h: a plan of an arm's way among solids asks one of the modules for distances.
TEST_F(Installed, WhatProgramsLoadLiesBesideThem) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(GONIO_BUILD "/lib/gonio")) {
    EXPECT_TRUE(fs::exists(prefix / "lib/gonio" / entry.path().filename())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0U);
  const std::string desk = (*scratch / "desk").string();
  const std::string plan = "acquire '" + desk + "/lab.json' --log-level warning -o '" + desk +
                           "/plan.json' --plan board:views=3,tilt=30deg,nearest=25cm,farthest=35cm";
  const Ended ended =
      run("mkdir '" + desk + "' && acquire --specimen desk --out '" + desk + "' -o '" + desk + "/lab.json' && " + plan);
  EXPECT_EQ(ended.status, 0) << ended.text;
  fs::rename(prefix / "lib/gonio", prefix / "lib/elsewhere");
  const Ended without = run(plan);
  fs::rename(prefix / "lib/elsewhere", prefix / "lib/gonio");
  EXPECT_EQ(without.status, 70) << "the plan asked no module";
  EXPECT_THAT(without.text, testing::HasSubstr("install gonio anew"));
}

TEST_F(Installed, OnlyProgramsLieInBin) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(prefix / "bin")) {
    const auto name = entry.path().filename().string();
    EXPECT_TRUE(std::any_of(cli::all_programs().begin(), cli::all_programs().end(), [&](const auto* program) {
      return program->name == name;
    })) << name;
    ++count;
  }
  EXPECT_EQ(count, cli::all_programs().size());
}

}  // namespace
}  // namespace gonio
