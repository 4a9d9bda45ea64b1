#include <gmock/gmock.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using Words = Process::Words;

class GlassMake : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_ / name; }
  static Words small(const std::string& out) {
    return {"glass-make", "--log-level", "error", "--objects", "2",   "--views", "2",  "--form", "lathe", "--form",
            "bottle",     "--size",      "32x32", "--noise",   "60%", "--spp",   "16", "--out",  out};
  }
  Ended call(Words words, const Words& more) const {
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder_.path());
  }
  // Bytes of all files below a folder by their names there.
  std::map<std::string, std::string> bytes_below(const std::string& name) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(path(name)))
      if (entry.is_regular_file()) all[fs::relative(entry.path(), path(name)).string()] = read_file(entry.path());
    return all;
  }
  void expect_refused(const Words& more, int status, const std::string& mentions) const {
    const Ended ended = call({"glass-make", "--out", "refused"}, more);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_EQ(ended.out, "");
    EXPECT_FALSE(fs::exists(path("refused")) && !fs::is_empty(path("refused")));
  }

 private:
  ScratchFolder folder_;
};

// Made in one call, in shards by several threads, and killed in the middle and taken up again: the same bytes.
TEST_F(GlassMake, IsTheSameWhicheverWayItIsMade) {
  ASSERT_EQ(call(small("whole"), {"-o", "whole.json"}).status, 0);
  for (const char* part : {"3/3", "1/3", "2/3"})
    ASSERT_EQ(call(small("parts"), {"--threads", "3", "--shard", part, "-o", "part.json"}).status, 0) << part;
  ASSERT_EQ(call(small("parts"), {"--gather", "-o", "parts.json"}).status, 0);
  EXPECT_EQ(bytes_below("parts"), bytes_below("whole"));
  const std::string makefile = std::string(GONIO_SOURCE) + "/scripts/experiments/glass.mk";
  const Ended made = call(
      {"env", std::string("PATH=") + GONIO_BIN + ":" + std::getenv("PATH"), "make", "-j2", "-f", makefile, "OBJECTS=2",
       "VIEWS=2", "SIZE=32x32", "NOISE=60%", "SPP=16", "PARTS=3", "MORE=--form lathe --form bottle --log-level error"},
      {});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(bytes_below("run/set"), bytes_below("whole"));
  const manifest::Document whole = manifest::read_document(path("whole.json"));
  EXPECT_TRUE(whole.files.contains("cells"));
  EXPECT_TRUE(whole.files.contains("training-front"));

  Words words = small("killed");
  words.insert(words.end(), {"--resume", "-o", "killed.json"});
  Process process(words, path("."));
  for (int wait = 0; wait < 2000 && !fs::exists(path("killed/cells")); ++wait) usleep(10000);
  ::kill(process.id(), SIGKILL);
  EXPECT_EQ(process.end().status, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(path("killed.json")));
  const Ended again = run(words, path("."));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(bytes_below("killed"), bytes_below("whole"));
}

TEST_F(GlassMake, SaysWhatIsMissingAndWhatIsThere) {
  ASSERT_EQ(call(small("set"), {"--cell", "1", "-o", "one.json"}).status, 0);
  const Ended early = call(small("set"), {"--gather"});
  EXPECT_EQ(early.status, 65);
  EXPECT_THAT(early.err, testing::HasSubstr("2 others of 4 cells"));
  const Ended again = call(small("set"), {"--cell", "1"});
  EXPECT_EQ(again.status, 73);
  EXPECT_THAT(again.err, testing::HasSubstr("--resume"));
  EXPECT_EQ(call(small("set"), {"--cell", "1", "--resume", "-o", "two.json"}).status, 0);
  EXPECT_EQ(read_file(path("one.json")), read_file(path("two.json")));
}

TEST_F(GlassMake, RefusesWhatMakesNoSense) {
  expect_refused({"--size", "31x32"}, 64, "--size");
  expect_refused({"--size", "32"}, 64, "--size");
  expect_refused({"--size", "999999x32"}, 64, "--size");
  expect_refused({"--shard", "0/4"}, 64, "--shard");
  expect_refused({"--shard", "5/4"}, 64, "--shard");
  expect_refused({"--shard", "x"}, 64, "--shard");
  expect_refused({"--shard", "1/"}, 64, "--shard");
  expect_refused({"--cell", "-1"}, 64, "--cell");
  expect_refused({"--cell", "50"}, 64, "none of 50 cells");
  expect_refused({"--recording", "10"}, 64, "none of 10 objects");
  expect_refused({"--recording", "x"}, 64, "--recording");
  expect_refused({"--form", "cup"}, 64, "cup");
  expect_refused({"--objects", "0"}, 64, "objects");
  expect_refused({"--noise", "0%"}, 64, "noise");
  expect_refused({"--meshes", "nowhere"}, 66, "nowhere");
  fs::create_directories(path("empty"));
  expect_refused({"--meshes", "empty"}, 66, ".ply");
  fs::create_directories(path("broken"));
  std::ofstream(path("broken/a.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  expect_refused({"--meshes", "broken", "--objects", "1", "--views", "1"}, 65, "a.obj");
  const Ended nothing = run({"glass-make"}, path("."));
  EXPECT_EQ(nothing.status, 64);
  EXPECT_THAT(nothing.err, testing::HasSubstr("--out"));
}

// Closed meshes of other programs make a set, each in a cell of its own.
TEST_F(GlassMake, TakesMeshesOfOthers) {
  GONIO_NEEDS_DATA("print/meshes");
  fs::create_directories(path("bodies"));
  for (const char* name : {"unit_sphere.STL", "torus.STL", "fandisk.obj"})
    fs::copy(data("print/meshes") / name, path("bodies") / name);
  const Ended ended = run({"glass-make", "--log-level", "error", "--meshes", "bodies", "--views", "1", "--size",
                           "32x32", "--noise", "60%", "--spp", "16", "--out", "set", "-o", "set.json"},
                          path("."));
  ASSERT_EQ(ended.status, 0) << ended.err;
  const std::string table = read_file(path("set/cells.csv"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
}

}  // namespace
}  // namespace gonio::tests
