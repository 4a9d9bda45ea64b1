// develop --merge over many views: interrupted batches go on, memory and threads make no difference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <map>
#include <thread>

#include "base/atomic_file.h"
#include "base/random.h"
#include "base/text.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int width = 64, height = 48, views = 24;

class DevelopBatch : public testing::Test {
 protected:
  void SetUp() override {
    std::string images, files;
    for (int v = 0; v < views; ++v)
      for (const int ms : {4, 16, 64}) {
        const std::string name = format("v%02d_%dms", v, ms);
        write_frame(name + ".png", v, ms);
        files += (files.empty() ? "" : ", ") + format("\"%s\": {\"path\": \"%s.png\"}", name.c_str(), name.c_str());
        images +=
            (images.empty() ? "" : ", ") +
            format("{\"id\": \"%s\", \"file\": \"%s\", \"camera\": \"c\", \"group\": \"v%02d\", \"exposure_s\": %g}",
                   name.c_str(), name.c_str(), v, 1e-3 * ms);
      }
    write_file(folder_ / "in.json",
               "{\"gonio\": 1, \"files\": {" + files +
                   "}, \"cameras\": {\"c\": {\"model\": \"pinhole\", \"width_px\": 64, \"height_px\": "
                   "48, \"fx_px\": 60, \"fy_px\": 60, \"cx_px\": 32, \"cy_px\": 24, \"mosaic\": "
                   "\"RGGB\"}}, \"images\": [" +
                   images + "]}");
  }
  void write_frame(const std::string& name, int view, int ms) const {
    Random random(static_cast<std::uint64_t>(100 * view + ms));
    io::Image frame(width, height, {"Y"});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double mean = 1e-3 * ms * (1 + 0.02 * view) * 2e4 * std::pow(10.0, 1.5 * x / width);
        frame.at(x, y, 0) = static_cast<float>((500 + mean + std::sqrt(mean / 4 + 9) * random.normal()) / 65535);
      }
    io::write_png(folder_ / name, frame, 16);
  }
  std::vector<std::string> words(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> all = {"develop",      "--merge", "--black", "500", "--full-scale", "20000",
                                    "--noise-gain", "4",       "--out",   out,   "in.json"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Ended develop(const std::string& out, std::vector<std::string> more = {}) const {
    return run(words(out, std::move(more)), folder_.path());
  }
  std::map<std::string, std::string> files_in(const std::string& out) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder_ / out))
      files[entry.path().filename().string()] = read_file(entry.path());
    return files;
  }
  // Of all files of a folder: which they are, not what is in them.
  std::map<std::string, fs::file_time_type> times_in(const std::string& out) const {
    std::map<std::string, fs::file_time_type> times;
    if (fs::exists(folder_ / out))
      for (const auto& entry : fs::directory_iterator(folder_ / out)) {
        std::error_code gone;  // what is being written takes another name at any moment
        const auto time = entry.last_write_time(gone);
        if (!gone) times[entry.path().filename().string()] = time;
      }
    return times;
  }
  ScratchFolder folder_;
};

TEST_F(DevelopBatch, ThreadsAndMemoryMakeNoDifference) {
  const Ended one = develop("a", {"--threads", "1"});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(files_in("a").size(), 2u * views);
  const auto document = manifest::parse_document(one.out, "out", folder_.path());
  EXPECT_EQ(manifest::index_of_image(document, "v00"), 0u);
  EXPECT_EQ(manifest::index_of_image(document, "v23"), 23u);
  for (const char* memory : {"4", "0.001"}) {  // the whole batch, and less than one view needs
    ASSERT_EQ(develop("b", {"--threads", "3", "--memory", memory, "--force"}).status, 0);
    EXPECT_EQ(files_in("b"), files_in("a")) << memory;
  }
}

// A frame that cannot be read ends the batch in its middle; mended, the call goes on.
TEST_F(DevelopBatch, WhatIsFinishedIsNotMadeAgain) {
  const Ended whole = develop("a");
  ASSERT_EQ(whole.status, 0) << whole.err;
  const std::string bad = "v17_16ms.png", good = read_file(folder_ / bad);
  write_file(folder_ / bad, good.substr(0, good.size() / 2));
  const Ended broken = develop("b", {"--threads", "2"});
  EXPECT_EQ(broken.status, 65);
  EXPECT_THAT(broken.err, HasSubstr(bad));
  const auto before = times_in("b");
  EXPECT_GE(before.size(), 2u * 17);
  EXPECT_LT(before.size(), 2u * views);
  EXPECT_FALSE(before.contains("v17.exr"));
  write_file(folder_ / bad, good);
  EXPECT_EQ(develop("b").status, 73);  // files are there, and nobody said --resume
  const Ended resumed = develop("b", {"--resume", "--log-level", "info"});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("v03: is there already"));
  EXPECT_THAT(resumed.err, HasSubstr("v17: 3 exposures"));
  const auto after = times_in("b");
  for (const auto& [name, time] : before) EXPECT_EQ(after.at(name), time) << name;
  EXPECT_EQ(files_in("b"), files_in("a"));
  // The same document, but for the folder.
  std::string expected = whole.out;
  for (std::size_t at = expected.find("\"a/"); at != std::string::npos; at = expected.find("\"a/"))
    expected.replace(at, 3, "\"b/");
  EXPECT_EQ(resumed.out, expected);
}

// Killed at any moment, and ended by a signal that programs may answer.
TEST_F(DevelopBatch, AKilledBatchGoesOn) {
  ASSERT_EQ(develop("a").status, 0);
  for (const int signal : {SIGKILL, SIGTERM}) {
    const std::string out = signal == SIGKILL ? "killed" : "ended";
    Process batch(words(out, {"--threads", "2"}), folder_.path());
    for (int k = 0; k < 20000 && times_in(out).size() < 4; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(batch.id(), signal);
    const Ended ended = batch.end();
    if (signal == SIGTERM && ended.status != 0) {
      EXPECT_EQ(ended.status, 75) << ended.err;
      EXPECT_THAT(ended.err, HasSubstr("of 24 views written; --resume makes the rest"));
    }
    const Ended resumed = develop(out, {"--resume"});
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    const auto whole = files_in("a");
    auto files = files_in(out);  // SIGKILL leaves a temporary or two
    std::erase_if(files, [&](const auto& file) { return !whole.contains(file.first); });
    EXPECT_EQ(files, whole);
  }
}

// A picture without its mask is not finished; one of another call, or a mask that was painted over, is nobody's to
// keep.
TEST_F(DevelopBatch, OnlyItsOwnPicturesAreKept) {
  ASSERT_EQ(develop("a").status, 0);
  const auto whole = files_in("a");
  fs::remove(folder_ / "a/v05-mask.png");
  ASSERT_EQ(develop("a", {"--resume"}).status, 0);
  EXPECT_EQ(files_in("a"), whole);
  struct Case {
    std::vector<std::string> more;
    const char* says;
  };
  for (const Case& c :
       std::vector<Case>{{{"--resume", "--demosaic", "bilinear"}, "v00.exr: is not what this call makes"},
                         {{"--resume", "--blooming", "2"}, "v00.exr: is not what this call makes"},
                         {{"--resume", "--force"}, "--force"}}) {
    const Ended ended = develop("a", c.more);
    EXPECT_NE(ended.status, 0);
    EXPECT_THAT(ended.err, HasSubstr(c.says));
  }
  write_frame("v20_4ms.png", 7, 4);  // another frame by the same name
  EXPECT_THAT(develop("a", {"--resume"}).err, HasSubstr("v20.exr: is not what this call makes of \"v20\"; --force"));
  write_frame("v20_4ms.png", 20, 4);
  write_file(folder_ / "a/v02-mask.png", whole.at("v01-mask.png") + "x");
  EXPECT_THAT(develop("a", {"--resume"}).err, HasSubstr("v02-mask.png: is not what this call makes"));
  const Ended other = run({"develop", "--undistort", "--resume", "--out", "a", "in.json"}, folder_.path());
  EXPECT_EQ(other.status, 64);
  EXPECT_THAT(other.err, HasSubstr("--resume"));
}

// Two cameras may call their views alike.
TEST_F(DevelopBatch, ViewsOfTwoCamerasMayBeOfOneGroup) {
  write_file(folder_ / "two.json",
             R"({"gonio": 1, "files": {"a": {"path": "v00_4ms.png"}, "b": {"path": "v01_4ms.png"}},
    "cameras": {"left": {}, "right": {}},
    "images": [{"id": "a", "file": "a", "camera": "left", "group": "v", "exposure_s": 0.004},
               {"id": "b", "file": "b", "camera": "right", "group": "v", "exposure_s": 0.004}]})");
  const Ended ended = run({"develop", "--merge", "--noise-gain", "4", "--out", "d", "two.json"}, folder_.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out", folder_.path());
  EXPECT_EQ(manifest::index_of_image(document, "v"), 0u);
  EXPECT_EQ(manifest::index_of_image(document, "v-right"), 1u);
  EXPECT_TRUE(fs::exists(folder_ / "d/v-right.exr"));
}

}  // namespace
}  // namespace gonio::tests
