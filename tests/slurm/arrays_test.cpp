// scripts/slurm on a cluster of two nodes: every recipe runs once, in make's order, on both; a node that dies and a
// time limit lose only what ran; the same call goes on; shares of a picture join to the bytes of one call.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"
#include "data.h"
#include "slurm/cluster.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const fs::path source = GONIO_SOURCE;

// One at a time: SlurmArrays.*
class SlurmArrays : public testing::Test {
 protected:
  explicit SlurmArrays(int node_timeout_s = 120) : node_timeout_s_(node_timeout_s) {}
  void SetUp() override {
    fs::create_directories(folder_ / "cluster");
    fs::create_directories(work_);
    cluster_ = std::make_unique<Cluster>(folder_ / "cluster", node_timeout_s_);
    if (cluster_->missing().empty()) return;
    if (data_is_required()) FAIL() << cluster_->missing();
    GTEST_SKIP() << cluster_->missing();
  }
  Process::Words words(const std::vector<std::string>& more) const {
    Process::Words all = cluster_->environment();
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Process::Words slurm(const std::vector<std::string>& more) const {
    Process::Words all = words({source / "scripts/slurm", "-f", "Makefile", "--poll", "0.3", "--again", "3"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  // "WORD TARGET NODE" of each line that recipes wrote into journal, in their order.
  std::vector<std::array<std::string, 3>> journal() const {
    std::vector<std::array<std::string, 3>> entries;
    std::istringstream in(fs::exists(work_ / "journal") ? read_file(work_ / "journal") : "");
    for (std::array<std::string, 3> e; in >> e[0] >> e[1] >> e[2];) entries.push_back(e);
    return entries;
  }
  // Place of "WORD TARGET" in the journal; it stands there once.
  std::size_t place(const std::string& word, const std::string& target) const {
    const auto entries = journal();
    std::size_t found = entries.size(), times = 0;
    for (std::size_t i = 0; i < entries.size(); ++i)
      if (entries[i][0] == word && entries[i][1] == target) found = i, ++times;
    EXPECT_EQ(times, 1u) << word << ' ' << target;
    return found;
  }
  bool wait_until(const std::function<bool()>& condition) const {
    for (int k = 0; k < 1200; ++k) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

  int node_timeout_s_;
  ScratchFolder folder_;
  fs::path work_ = folder_ / "work";
  std::unique_ptr<Cluster> cluster_;
};

// Sources in two chunks of an array, one element each above them, a recipe of two targets, a phony group, and what
// needs only to be there. The sources wait until both nodes are at work.
constexpr const char* graph = R"(
N = 1 2 3 4 5 6
RECIPE = echo begin $@ $${SLURMD_NODENAME:-here} >> journal; cat $^ > $@; echo $@ >> $@
END    = echo end $@ $${SLURMD_NODENAME:-here} >> journal
.RECIPEPREFIX = >
.SECONDEXPANSION:
.PHONY: all both
all: run/end both
both: run/last
run/%.a: | run
> $(RECIPE); k=0; until [ $$k -ge 300 ] || [ -z "$$SLURMD_NODENAME" ] || \
>   { grep -q n1 journal && grep -q n2 journal; }; do k=$$((k + 1)); sleep 0.1; done; $(END)
$(N:%=run/%.b): run/%.b: run/%.a
> $(RECIPE); $(END)
run/one run/two &: run/1.b
> echo begin run/one $${SLURMD_NODENAME:-here} >> journal; cat $^ > run/one; cp run/one run/two; \
>   echo end run/one $${SLURMD_NODENAME:-here} >> journal
run/end: $$(foreach n,$(N),run/$$n.b) run/two | run/stamp
> $(RECIPE); $(END)
run/stamp run/last: run/1.a
> $(RECIPE); $(END)
run:
> mkdir -p run; echo begin run $${SLURMD_NODENAME:-here} >> journal; $(END)
)";

TEST_F(SlurmArrays, RunEveryRecipeOnceInOrderOnBothNodes) {
  write_file(work_ / "Makefile", graph);
  const Ended made = run(slurm({"all", "--most", "3"}), work_);
  ASSERT_EQ(made.status, 0) << made.err;
  const auto entries = journal();
  EXPECT_EQ(entries.size(), 2u * (1 + 6 + 6 + 1 + 3));
  std::set<std::string> nodes;
  for (const auto& entry : entries) nodes.insert(entry[2]);
  EXPECT_EQ(nodes, (std::set<std::string>{"n1", "n2"}));
  const auto in_order = [&](const std::string& first, const std::string& second) {
    EXPECT_LT(place("end", first), place("begin", second)) << first << ' ' << second;
  };
  for (const std::string n : {"1", "2", "3", "4", "5", "6"}) {
    in_order("run", "run/" + n + ".a");
    in_order("run/" + n + ".a", "run/" + n + ".b");
    in_order("run/" + n + ".b", "run/end");
  }
  in_order("run/1.b", "run/one");
  in_order("run/one", "run/end");
  in_order("run/stamp", "run/end");
  in_order("run/1.a", "run/last");
  // The bytes are make's own.
  fs::create_directories(folder_ / "plain");
  write_file(folder_ / "plain/Makefile", graph);
  ASSERT_EQ(run(words({"make"}), folder_ / "plain").status, 0);
  for (const auto& entry : fs::directory_iterator(folder_ / "plain/run"))
    EXPECT_EQ(read_file(entry.path()), read_file(work_ / "run" / entry.path().filename())) << entry.path();

  const Ended again = run(slurm({"all"}), work_);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, "slurm: nothing to submit: all is up to date\n");
  // What a newer source touches, and nothing else.
  fs::remove(work_ / "journal");
  fs::remove(work_ / "run/2.b");
  const Ended part = run(slurm({"all"}), work_);
  EXPECT_EQ(part.status, 0) << part.err;
  EXPECT_EQ(journal().size(), 4u);
  in_order("run/2.b", "run/end");
}

TEST_F(SlurmArrays, StopAtAFailedRecipeAndSayWhereItsLogIs) {
  write_file(work_ / "Makefile",
             "all: top other.in\n%.in:\n\techo 'no $@ today' && test $* != bad && touch $@\n"
             "%.out: %.in\n\ttouch $@\ntop: good.out bad.out\n\ttouch $@\n");
  const Ended made = run(slurm({}), work_);
  EXPECT_EQ(made.status, 1) << made.err;
  EXPECT_THAT(made.err, HasSubstr("bad.in failed (status 2): see " + (work_ / "slurm-logs/1/").string()));
  EXPECT_THAT(made.err, HasSubstr("2 targets were not begun: they need what failed"));
  for (const char* file : {"good.in", "other.in", "good.out"}) EXPECT_TRUE(fs::exists(work_ / file)) << file;
  for (const char* file : {"bad.out", "top"}) EXPECT_FALSE(fs::exists(work_ / file)) << file;
  const auto at = made.err.find("see ") + 4;
  EXPECT_THAT(read_file(made.err.substr(at, made.err.find('\n', at) - at)), HasSubstr("bad.in] Error 1"));
}

struct SlurmArraysLosingANode : SlurmArrays {
  SlurmArraysLosingANode() : SlurmArrays(5) {}
};

// n1 is lost while an element runs there; what that left is half a file, which a later attempt must not take for done.
TEST_F(SlurmArraysLosingANode, LoseOnlyWhatRan) {
  write_file(work_ / "Makefile", R"(
.RECIPEPREFIX = >
N = 1 2 3 4
all: end
%.part:
> echo begin $@ $$SLURMD_NODENAME >> journal; test ! -e $@ && echo half > $@; \
>   test $$SLURMD_NODENAME != n1 || sleep 300; echo whole > $@; echo end $@ $$SLURMD_NODENAME >> journal
end: $(N:%=%.part)
> cat $^ > $@
)");
  Process running(slurm({}), work_);
  const bool begun = wait_until([this] {
    bool first = false, second = false;
    for (const auto& entry : journal()) first |= entry[2] == "n1", second |= entry[0] == "end";
    return first && second;
  });
  cluster_->lose_node("n1");
  const Ended made = running.end();
  ASSERT_TRUE(begun);
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(read_file(work_ / "end"), "whole\nwhole\nwhole\nwhole\n");
  std::map<std::string, int> begins;
  for (const auto& entry : journal()) begins[entry[1]] += entry[0] == "begin";
  for (const auto& entry : journal()) {
    EXPECT_EQ(begins[entry[1]], entry[2] == "n1" || begins[entry[1]] == 2 ? 2 : 1) << entry[1];
    if (entry[0] == "end") {
      EXPECT_EQ(entry[2], "n2");
    }
  }
  EXPECT_EQ(begins.size(), 4u);
  int twice = 0;
  for (const auto& [target, times] : begins) twice += times > 1;
  EXPECT_EQ(twice, 1);
}

// A program below a shell is told of the limit, saves where it is, and goes on from there in a second attempt.
TEST_F(SlurmArrays, ATimeLimitIsResumedFrom) {
  write_file(work_ / "count", R"(#!/bin/bash
n=$(cat saved 2>/dev/null || echo 0)
trap 'echo $n > saved; exit 75' TERM
echo from $n $SLURMD_NODENAME >> journal
last=$([ -n "$SLURM_RESTART_COUNT" ] && echo $((n + 3)) || echo 600)
while [ $n -lt $last ]; do n=$((n + 1)); sleep 0.2 & wait $!; done
echo to $n $SLURMD_NODENAME >> journal
)");
  fs::permissions(work_ / "count", fs::perms::owner_all);
  write_file(work_ / "Makefile",
             "all: b\na:\n\t./count | cat || exit 1; test -s journal; echo a > $@\nb: a\n\tcp $< $@\n");
  const Ended made = run(slurm({"--time", "1", "--notice", "55"}), work_);
  ASSERT_EQ(made.status, 0) << made.err;
  const auto entries = journal();
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0][1], "0");
  EXPECT_GT(std::stoi(entries[1][1]), 0);
  EXPECT_EQ(std::stoi(entries[2][1]), std::stoi(entries[1][1]) + 3);
  EXPECT_EQ(read_file(work_ / "b"), "a\n");
}

TEST_F(SlurmArrays, CancelledOrLeftAloneTheSameCallGoesOn) {
  write_file(work_ / "Makefile",
             "all: b\na:\n\techo begin $@ $$SLURMD_NODENAME >> journal; echo half > $@; k=0; "
             "until [ -e go ] || [ $$k -ge 300 ]; do k=$$((k + 1)); sleep 0.1; done; echo a > $@\nb: a\n\tcp $< $@\n");
  const auto begun = [this](std::size_t times) { return wait_until([&] { return journal().size() == times; }); };
  EXPECT_EQ(run(slurm({"--no-wait"}), work_).status, 0);
  ASSERT_TRUE(begun(1));
  const Ended too_early = run(slurm({"--no-wait"}), work_);
  EXPECT_EQ(too_early.status, 75);
  EXPECT_THAT(too_early.err, HasSubstr("an earlier call is still at work; scancel "));
  Process waiting(slurm({}), work_);
  run(words({"scancel", "--user", "root"}));
  ASSERT_TRUE(begun(2));  // the killed one is out of the queue, its half a file gone
  EXPECT_EQ(run(slurm({"--no-wait"}), work_).status, 75);
  run(words({"scancel", "--user", "root"}));
  const Ended cancelled = waiting.end();
  EXPECT_EQ(cancelled.status, 75) << cancelled.err;
  EXPECT_THAT(cancelled.err, HasSubstr("a was cancelled or killed: see "));
  EXPECT_THAT(cancelled.err, HasSubstr("the same call goes on with what is left"));
  EXPECT_FALSE(fs::exists(work_ / "a"));
  write_file(work_ / "go", "");
  const Ended made = run(slurm({}), work_);
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(read_file(work_ / "b"), "a\n");
}

TEST_F(SlurmArrays, SharesOfAPictureJoinToTheBytesOfOneCall) {
  write_file(work_ / "scene.json", R"({"gonio": 1,
    "cameras": {"c": {"model": "pinhole", "width_px": 16, "height_px": 12, "fx_px": 22, "fy_px": 22, "cx_px": 7.5,
      "cy_px": 5.5}},
    "images": [{"id": "one", "camera": "c", "world_from_camera": {"rotation": [0, 1, 0, 0],
      "translation_m": [0, 0, 1]}}],
    "meshes": {"ball": {"sphere": {"radius_m": 0.1}}}, "surfaces": {"ball": {"model": "diffuse", "albedo": 0.5}},
    "lights": {"lamp": {"model": "sphere", "position_m": [-0.4, 0.1, 0.8], "watt_per_sr": [1, 1, 1],
      "radius_m": 0.1}},
    "objects": [{"id": "ball", "mesh": "ball", "surface": "ball"}]})");
  fs::copy_file(source / "scripts/experiments/render-shares.mk", work_ / "Makefile");
  const Ended made = run(slurm({"all", "SCENE=scene.json", "IMAGE=one", "SPP=64", "SHARE=12"}), work_);
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("run/%/one.exr, 5 to make"));
  EXPECT_THAT(made.err, HasSubstr("run/60-64/one.exr, 1 to make"));  // arrays of this cluster have five elements
  ASSERT_EQ(run({"render", "scene.json", "--spp", "64", "--out", "whole"}, work_).status, 0);
  EXPECT_EQ(read_file(work_ / "run/one.exr"), read_file(work_ / "whole/one.exr"));
}

}  // namespace
}  // namespace gonio::tests
