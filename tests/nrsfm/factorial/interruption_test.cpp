// nrsfm-solve interrupted in the middle of a solver: it ends at once, with what has been answered and nothing besides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <csignal>
#include <thread>

#include "base/random.h"
#include "data.h"
#include "nrsfm/files.h"
#include "process.h"

namespace gonio::tests {
namespace {

using ::testing::HasSubstr;

TEST(Interruption, KeepsWhatIsAnsweredAndLeavesNothingHalfWritten) {
  ScratchFolder folder;
  Random random(1);
  nrsfm::Sequence noise;  // which em_ppca could work on for hours
  noise.tracks = Eigen::MatrixXd::NullaryExpr(400, 60, [&] { return random.normal(); });
  noise.visible = nrsfm::Visible::Constant(200, 60, true);
  nrsfm::write_sequence(noise, folder / "noise.mat");
  const std::filesystem::path answer = folder / "a/noise-rigid.mat";
  Process solving({"nrsfm-solve", "--solver", "rigid", "--solver", "em_ppca", "--set", "rank=15", "--iterations",
                   "1000000", "--threads", "1", "--out", "a", "-o", "out.json", "noise.mat"},
                  folder.path());
  for (int k = 0; k < 6000 && !std::filesystem::exists(answer); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(solving.id(), SIGINT);
  const Ended ended = solving.end();
  EXPECT_EQ(ended.status, 75);
  EXPECT_EQ(ended.err, "nrsfm-solve: interrupted by a signal, with 1 of 2 answers written; --resume makes the rest\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.json"));
  const auto written = std::filesystem::last_write_time(answer);
  const auto begin = std::filesystem::directory_iterator(folder / "a");
  EXPECT_EQ(std::distance(begin, std::filesystem::directory_iterator()), 1);
  const Ended again = run({"nrsfm-solve", "--solver", "rigid", "--iterations", "1000000", "--resume", "--out", "a",
                           "-o", "out.json", "noise.mat"},
                          folder.path());
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(std::filesystem::last_write_time(answer), written);
}

}  // namespace
}  // namespace gonio::tests
