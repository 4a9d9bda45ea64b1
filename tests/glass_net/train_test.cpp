// scripts/glass-net on a set of glass-make, with Debian's torch.
// One process, skipped as one: GlassNet.*
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <tuple>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
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
    static const bool has_torch = run({"/usr/bin/python3", "-c", "import torch, numpy, scipy"}).status == 0;
    if (has_torch) return;
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
  EXPECT_THAT(ended.out, testing::HasSubstr("too few seeds, or objects of the test share"));  // one object
  EXPECT_THAT(read_file(path("table.csv")), testing::HasSubstr("lit,scales,front alone,rgb,mask_l1,2,"));
  // As if five more objects had been judged, all of which intensities get wrong by a tenth more.
  const std::string more =
      "import json, sys\n"
      "for path in sys.argv[1:]:\n"
      "    run = json.load(open(path))\n"
      "    (of,) = run['test_objects'].values()\n"
      "    worse = 1.1 if 'intensities' in path else 1.0\n"
      "    for k in range(5):\n"
      "        run['test_objects'][f'more {k}'] = {key: (1 + k / 10) * worse * v for key, v in of.items()}\n"
      "    json.dump(run, open(path, 'w'))\n";
  Words several{"/usr/bin/python3", "-c", more};
  several.insert(several.end(), table.begin() + 1, table.begin() + 5);
  ASSERT_EQ(run(several, path(".")).status, 0);
  const Ended told = run(table, path("."));
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.out, testing::HasSubstr("Against RGB (over seeds and objects; 95 % interval; p after Holm over"));
  EXPECT_THAT(told.out, testing::ContainsRegex("front alone, lit: front / deg by intensities: [0-9.]+ \\("));
  EXPECT_EQ(run({(scripts / "table").string()}, path(".")).status, 64);
  EXPECT_EQ(run({(scripts / "table").string(), "set.json"}, path(".")).status, 65);
}

// The program, by OpenCV, against what torch found: errors on the test share, calibration on the share that it is of.
TEST_F(GlassNet, TheProgramSaysWhatTheNetworkSays) {
  const Ended trained = train("net", {"--epochs", "12", "--rate", "0.01", "--loss", "scales", "--input", "stokes"});
  ASSERT_EQ(trained.status, 0) << trained.err;
  const Ended test = run({"glass-net", "--weights", "net", "--reliability", "set", "--most", "100%"}, path("."));
  ASSERT_EQ(test.status, 0) << test.err;
  const manifest::Value errors = *record("net").find("test");
  for (const auto& [head, of, factor] :
       {std::tuple{"front: errs by ", "front_deg", 1.0}, std::tuple{"back: errs by ", "back_deg", 1.0},
        std::tuple{"depth: errs by ", "depth_l1_m", 1e3}}) {
    const std::size_t at = test.out.find(head);
    ASSERT_NE(at, std::string::npos) << test.out;
    const double expected = factor * errors.find(of)->as_number();
    EXPECT_NEAR(std::stod(test.out.substr(at + std::string(head).size())), expected, 0.006 * expected) << head;
  }
  const Ended own = run(
      {"glass-net", "--weights", "net", "--reliability", "set", "--share", "validation", "--most", "100%"}, path("."));
  ASSERT_EQ(own.status, 0) << own.err;
  for (const char* head : {"depth: ", "front: ", "back: "}) {
    const std::string figure = "calibration error ";
    const std::size_t at = own.out.find(figure, own.out.find(head));
    EXPECT_LT(std::stod(own.out.substr(at + figure.size())), 1.0) << own.out;
  }
  EXPECT_EQ(run({"glass-net", "--weights", "net", "--reliability", "set", "--most", "0%"}, path(".")).status, 1);
}

// In tiles as in one piece; a photograph of which each pixel is four says the same.
TEST_F(GlassNet, TheProgramTilesAndShrinks) {
  const Ended trained = train("tiled", {"--epochs", "2", "--loss", "scales", "--input", "stokes"});
  ASSERT_EQ(trained.status, 0) << trained.err;
  io::Image light(152, 100, {"Y", "s1.Y", "s2.Y"}), large(304, 200, light.channels);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto value = static_cast<float>(c == 0 ? 2 + std::sin(0.3 * (x / 2)) : 0.3 * std::cos(0.2 * (y / 2) + c));
        large.at(x, y, c) = light.at(x / 2, y / 2, c) = value;
      }
  io::write_picture(path("light.exr"), light), io::write_picture(path("large.exr"), large);
  const Words call{"glass-net", "--weights", "tiled", "--out"};
  const auto answer = [&](const std::string& out, const std::string& file, const Words& more) {
    Words all = call;
    all.push_back(out), all.push_back(file + ".exr"), all.insert(all.end(), more.begin(), more.end());
    const Ended ended = run(all, path("."));
    EXPECT_EQ(ended.status, 0) << ended.err;
    return io::read_picture(path(out + "/" + file + ".exr"));
  };
  const io::Image whole = answer("whole-out", "light", {"--shrink", "1"});
  EXPECT_TRUE(fs::exists(path("whole-out/report.html")));
  for (const char* channel : {"mask", "depth.Z", "normal.X", "back_normal.Z", "uncertainty.normal"})
    EXPECT_GE(whole.channel(channel), 0) << channel;
  const io::Image tiled = answer("tiled-out", "light", {"--shrink", "1", "--tile", "72"});
  ASSERT_EQ(tiled.data.size(), whole.data.size());
  for (std::size_t i = 0; i < whole.data.size(); ++i) ASSERT_NEAR(tiled.data[i], whole.data[i], 1e-4) << i;
  const io::Image shrunk = answer("shrunk-out", "large", {"--shrink", "2"});
  ASSERT_EQ(shrunk.width, large.width);
  double worst = 0;
  for (int y = 1; y + 1 < light.height; ++y)  // of a block's four pixels the mean is about the block's own answer
    for (int x = 1; x + 1 < light.width; ++x) {
      double mean = 0;
      for (int k = 0; k < 4; ++k) mean += shrunk.at(2 * x + k % 2, 2 * y + k / 2, 0) / 4;
      worst = std::max(worst, std::abs(mean - whole.at(x, y, 0)));
    }
  EXPECT_LT(worst, 0.1);
}

TEST_F(GlassNet, TheProgramRefuses) {
  const Ended trained = train("refusing", {"--epochs", "1", "--input", "stokes"});
  ASSERT_EQ(trained.status, 0) << trained.err;
  io::Image grey(64, 64, {"Y"});
  for (std::size_t i = 0; i < grey.data.size(); ++i) grey.data[i] = 0.2F + 0.01F * static_cast<float>(i % 64);
  io::write_picture(path("grey.png"), grey);
  io::write_picture(path("colours.exr"), io::Image(64, 64, {"R", "G", "B"}));
  const auto refused = [&](const Words& more, int status, const std::string& mentions) {
    Words all{"glass-net", "--out", "nothing"};
    all.insert(all.end(), more.begin(), more.end());
    const Ended ended = run(all, path("."));
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_FALSE(fs::exists(path("nothing/report.html")));
  };
  refused({"grey.png"}, 64, "no weights of its own");
  refused({"--weights", "set", "grey.png"}, 66, "no weights of its own");
  refused({"--weights", "refusing", "grey.png"}, 65, "is no mosaic of polarizers");
  refused({"--weights", "refusing", "colours.exr"}, 65, "Stokes vectors");
  refused({"--weights", "refusing", "missing.png"}, 66, "missing.png");
  refused({"--weights", "refusing"}, 64, "no photograph");
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
