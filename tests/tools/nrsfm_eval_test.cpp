// nrsfm-eval as a program among others: a pipe that is closed, an interrupt, a pipeline from tracks to tables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/evaluation.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NrsfmEval : public testing::Test {
 protected:
  Ended shell(const std::string& line) {
    return run({"bash", "-euo", "pipefail", "-c", std::string("PATH=") + GONIO_BIN + ":$PATH\n" + line},
               folder_.path());
  }
  void make() {
    const Ended made = shell(
        "nrsfm-make --kind stretching --path circle --path line --missing without --frames 15 --points 30 --out s | "
        "nrsfm-solve --solver rigid --out a -o solved.json");
    ASSERT_EQ(made.status, 0) << made.err;
  }
  ScratchFolder folder_;
};

TEST_F(NrsfmEval, EndsAPipelineAndSaysNothingToAClosedPipe) {
  make();
  const Ended whole = shell("nrsfm-eval -i solved.json --csv e.csv -o evaluated.json");
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_EQ(manifest::read_document((folder_ / "evaluated.json").string()).evaluations.size(), 4);
  const Ended closed = shell("nrsfm-eval -i solved.json | true; echo \"${PIPESTATUS[0]}\"");
  EXPECT_EQ(closed.err.find("Broken"), std::string::npos) << closed.err;
  EXPECT_EQ(closed.err.find("terminate"), std::string::npos) << closed.err;
  const Ended again = shell("nrsfm-eval <solved.json >again.json");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(read_file(folder_ / "again.json"), read_file(folder_ / "evaluated.json"));
}

// Has the program taken charge of SIGINT? Asked until it has.
bool listens(pid_t id) {
  const std::string path = "/proc/" + std::to_string(id) + "/status";
  for (int i = 0; i < 60000; ++i, ::usleep(1000)) {
    const std::string status = read_file(path);
    const std::size_t at = status.find("SigCgt:");
    if (at != std::string::npos && (std::stoull(status.substr(at + 7), nullptr, 16) >> (SIGINT - 1) & 1) != 0)
      return true;
  }
  return false;
}

// Stopped in the middle of long bootstraps: status 75, one line, and no file that was not there before.
TEST_F(NrsfmEval, InterruptedLeavesNothingHalfWritten) {
  make();
  Process process({"nrsfm-eval", "-i", "solved.json", "--draws", "100000", "--block", "1", "--threads", "1", "--csv",
                   "e.csv", "--html", "p.html", "-o", "o.json"},
                  folder_.path());
  ASSERT_TRUE(listens(process.id()));
  ::kill(process.id(), SIGINT);
  const Ended stopped = process.end();
  EXPECT_EQ(stopped.status, 75) << stopped.err;
  EXPECT_EQ(std::count(stopped.err.begin(), stopped.err.end(), '\n'), 1) << stopped.err;
  for (const char* name : {"e.csv", "p.html", "o.json"}) EXPECT_FALSE(fs::exists(folder_ / name)) << name;
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder_.path())) files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 1) << "solved.json alone";
}

}  // namespace
}  // namespace gonio::tests
