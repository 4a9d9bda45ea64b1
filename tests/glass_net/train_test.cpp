// scripts/glass-net on a set of glass-make, with Debian's torch.
#include <gmock/gmock.h>

#include <csignal>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/value.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using Words = Process::Words;

const fs::path scripts = fs::path(GONIO_SOURCE) / "scripts" / "glass-net";

class GlassNet : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    made_ = run({"glass-make", "--log-level", "error", "--objects", "10", "--views", "1", "--form", "lathe", "--size",
                 "32x32", "--noise", "90%", "--spp", "16", "--out", "set", "-o", "set.json"},
                folder_->path())
                .status;
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override {
    ASSERT_EQ(made_, 0);
    if (run({"/usr/bin/python3", "-c", "import torch, numpy, scipy"}).status == 0) return;
    ASSERT_FALSE(data_is_required()) << "scripts/setup installs python3-torch, python3-numpy, python3-scipy";
    GTEST_SKIP() << "no torch, numpy or scipy";
  }
  fs::path path(const std::string& name) const { return *folder_ / name; }
  Words words(const std::string& out, const Words& more) const {
    Words all{(scripts / "train").string(),
              "--set",
              "set",
              "--out",
              out,
              "--width",
              "4",
              "--levels",
              "3",
              "--batch",
              "4",
              "--threads",
              "1"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Ended train(const std::string& out, const Words& more) const { return run(words(out, more), folder_->path()); }
  manifest::Value record(const std::string& run) const {
    return manifest::parse_json(read_file(path(run + "/run.json")), run);
  }
  void expect_refused(const Words& more, int status, const std::string& mentions) const {
    const Ended ended = train("refused", more);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_FALSE(fs::exists(path("refused/run.json")));
  }

 private:
  static ScratchFolder* folder_;
  static int made_;
};
ScratchFolder* GlassNet::folder_ = nullptr;
int GlassNet::made_ = -1;

// Eight cells, sixty epochs: the loss falls by half; what was killed and taken up again has the same weights.
TEST_F(GlassNet, LearnsAndIsTheSameAfterItWasKilled) {
  const Words more{"--epochs", "60", "--rate", "0.01", "--input", "stokes"};
  const Ended ended = train("whole", more);
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, "");
  const manifest::Value whole = record("whole");
  const auto& losses = whole.find("losses")->as_array();
  ASSERT_EQ(losses.size(), 60u);
  EXPECT_LT(losses.back().as_number(), losses.front().as_number() / 2);
  EXPECT_EQ(whole.find("cells")->find("training")->as_integer(), 8);
  EXPECT_EQ(whole.find("heads")->as_array().size(), 4u);
  EXPECT_THAT(read_file(path("whole/network.onnx")), testing::HasSubstr("answers"));

  Words again = words("killed", more);
  again.push_back("--resume");
  Process process(again, path("."));
  for (int wait = 0; wait < 6000 && !fs::exists(path("killed/resume.pt")); ++wait) usleep(10000);
  ::kill(process.id(), SIGKILL);
  EXPECT_EQ(process.end().status, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(path("killed/run.json")));
  ASSERT_EQ(run(again, path(".")).status, 0);
  EXPECT_TRUE(read_file(path("killed/weights.pt")) == read_file(path("whole/weights.pt")));
  EXPECT_FALSE(fs::exists(path("killed/resume.pt")));
}

// With a scale for each pixel, without the back; and the table of two seeds of two inputs.
TEST_F(GlassNet, RunsBecomeATable) {
  Words table{(scripts / "table").string()};
  for (const char* input : {"rgb", "intensities"})
    for (const char* seed : {"1", "2"}) {
      const std::string out = std::string("runs/") + input + seed;
      const Ended ended = train(out, {"--epochs", "2", "--loss", "scales", "--without-back", "--light", "lit",
                                      "--input", input, "--seed", seed});
      ASSERT_EQ(ended.status, 0) << ended.err;
      table.push_back(out + "/run.json");
    }
  EXPECT_EQ(record("runs/rgb1").find("heads")->as_array().size(), 3u);
  table.insert(table.end(), {"--csv", "table.csv"});
  const Ended ended = run(table, path("."));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, testing::HasSubstr("front alone, light: lit, loss: scales"));
  EXPECT_THAT(ended.out, testing::HasSubstr("by intensities"));
  EXPECT_THAT(read_file(path("table.csv")), testing::HasSubstr("lit,scales,front alone,rgb,mask_l1,2,"));
  EXPECT_EQ(run({(scripts / "table").string()}, path(".")).status, 64);
  EXPECT_EQ(run({(scripts / "table").string(), "set.json"}, path(".")).status, 65);
}

TEST_F(GlassNet, RefusesWhatDoesNotFit) {
  expect_refused({"--levels", "7"}, 64, "multiples of 64");
  expect_refused({"--set", "nowhere"}, 66, "nowhere/tensors");
  fs::create_directories(path("there"));
  write_file(path("there/run.json"), "{}");
  const Ended there = train("there", {});
  EXPECT_EQ(there.status, 73);
  EXPECT_THAT(there.err, testing::HasSubstr("run.json"));
}

}  // namespace
}  // namespace gonio::tests
