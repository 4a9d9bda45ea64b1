// The Makefile of gonio(7): as it stands in the manual, interrupted, called again, and left alone once it is done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <regex>
#include <set>
#include <thread>

#include "base/atomic_file.h"
#include "data.h"
#include "io/csv.h"
#include "io/mat.h"
#include "manifest/document.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

const fs::path makefile = fs::path(GONIO_SOURCE) / "scripts/experiments/nrsfm.mk";

Process::Words make(const std::vector<std::string>& more) {
  Process::Words words{"env", std::string("PATH=") + GONIO_BIN + ":" + std::getenv("PATH"), "make", "-f",
                       makefile.string()};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// One kind, two paths, one camera: four sequences and eight answers.
Process::Words small(std::vector<std::string> more = {}) {
  more.insert(more.end(), {"KINDS=stretching", "PATHS=circle line", "CAMERAS=orthographic", "SOLVERS=rigid csf",
                           "FRAMES=12", "POINTS=20", "MODEL=main"});
  return make(more);
}

std::map<std::string, fs::file_time_type> times_below(const fs::path& folder) {
  std::map<std::string, fs::file_time_type> times;
  if (!fs::exists(folder)) return times;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) times[entry.path().string()] = entry.last_write_time();
  return times;
}

// Every file that is there can be read to its end.
void expect_whole(const fs::path& folder) {
  for (const auto& [file, time] : times_below(folder)) {
    SCOPED_TRACE(file);
    const std::string extension = fs::path(file).extension();
    EXPECT_THAT((std::vector<std::string>{".mat", ".json", ".csv", ".html", ".tex"}), ::testing::Contains(extension));
    const std::string bytes = read_file(file);
    EXPECT_FALSE(bytes.empty());
    if (extension == ".mat") {
      EXPECT_NO_THROW(io::read_mat(file));
    } else if (extension == ".json") {
      EXPECT_NO_THROW(manifest::read_document(file));
    } else {
      EXPECT_EQ(bytes.back(), '\n');
    }
  }
}

TEST(Makefile, IsTheOneOfTheManual) {
  const std::string prose = read_file(fs::path(GONIO_SOURCE) / "man/prose/gonio.md");
  for (const fs::path& one : {makefile, makefile.parent_path() / "laboratory.mk"})
    EXPECT_THAT(prose, HasSubstr("```\n" + read_file(one) + "```\n"));
}

TEST(Makefile, MakesTheWholeDesign) {
  ScratchFolder folder;
  const Ended dry = run(make({"-n"}), folder.path());
  ASSERT_EQ(dry.status, 0) << dry.err;
  const auto count = [&dry](const std::string& what) {
    const std::regex pattern(what);
    return std::distance(std::sregex_iterator(dry.out.begin(), dry.out.end(), pattern), std::sregex_iterator());
  };
  EXPECT_EQ(count("nrsfm-make "), 5);
  EXPECT_EQ(count("nrsfm-solve "), 120);
  EXPECT_EQ(count("nrsfm-eval --measure"), 120);
  EXPECT_EQ(count("nrsfm-eval --table"), 1);
  EXPECT_EQ(count(" --table "), 120);
}

TEST(Makefile, RunsToItsTablesAndThenDoesNothing) {
  ScratchFolder folder;
  const Ended first = run(small({"-j2"}), folder.path());
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(run(small({"-q"}), folder.path()).status, 0);
  const auto before = times_below(folder.path());
  EXPECT_EQ(run(small({"-j2"}), folder.path()).status, 0);
  EXPECT_EQ(times_below(folder.path()), before);
  std::size_t answers = 0;
  for (const auto& [file, time] : before) answers += file.find("/answers/") != std::string::npos;
  EXPECT_EQ(answers, 8);
  const io::Csv table = io::read_csv(folder / "run/tables/anova.csv");
  std::set<std::string> terms;
  for (const auto& row : table.rows) terms.insert(row.at(1));
  EXPECT_THAT(terms, IsSupersetOf({"algorithm", "path"}));
  EXPECT_THAT(read_file(folder / "run/factorial.html"), HasSubstr("<svg"));
  expect_whole(folder.path());
  // What one cell loses is made again, and what follows from it, and nothing else.
  const fs::path lost = folder / "run/stretching-line-orthographic-with.json";
  fs::remove(lost);
  EXPECT_EQ(run(small({"-q"}), folder.path()).status, 1);
  ASSERT_EQ(run(small({"-j2"}), folder.path()).status, 0);
  for (const auto& [file, time] : times_below(folder.path())) {
    const bool follows = file.find("line-orthographic-with.") != std::string::npos || file.ends_with(".html") ||
                         file.find("/tables/") != std::string::npos;
    EXPECT_EQ(time == before.at(file), !follows || file.ends_with(".mat")) << file;
  }
}

// Interrupted as by Ctrl-C: the signal goes to make and all that it runs.
TEST(Makefile, GoesOnAfterAnInterruption) {
  ScratchFolder folder, straight;
  Process running(small({"-j2"}), folder.path(), {}, [] { ::setpgid(0, 0); });
  ::setpgid(running.id(), running.id());
  const auto answered = [&folder] {
    return fs::exists(folder / "run/stretching-circle-orthographic-with.json") ||
           fs::exists(folder / "run/stretching-circle-orthographic-without.json");
  };
  for (int k = 0; k < 6000 && !answered(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(-running.id(), SIGINT);
  const Ended stopped = running.end();
  EXPECT_NE(stopped.status, 0);
  EXPECT_FALSE(fs::exists(folder / "run/factorial.html"));
  const auto before = times_below(folder.path());
  EXPECT_GE(before.size(), 6);  // four sequences, their manifest, an answer
  expect_whole(folder.path());
  ASSERT_EQ(run(small({"-j2"}), folder.path()).status, 0);
  const auto after = times_below(folder.path());
  for (const auto& [file, time] : before) EXPECT_EQ(after.at(file), time) << file << " was made twice";
  ASSERT_EQ(run(small(), straight.path()).status, 0);
  for (const auto& [file, time] : after) {
    const std::string name = fs::path(file).lexically_relative(folder.path());
    EXPECT_EQ(read_file(file), read_file(straight / name)) << name;
  }
}

}  // namespace
}  // namespace gonio::tests
