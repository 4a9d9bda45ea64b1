// render in parts: shares that join, runs that stop and go on, goals of noise and time, and further layers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <set>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/surface.h"
#include "process.h"
#include "render/share.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

// A metal ball on a table under two lamps, before a camera with polarizers; and the same with one lamp.
constexpr const char* scene = R"({
 "gonio": 1,
 "cameras": {"c": {"model": "pinhole", "width_px": 16, "height_px": 12, "fx_px": 22, "fy_px": 22, "cx_px": 7.5,
   "cy_px": 5.5, "mosaic": "polarizers"}},
 "images": [{"id": "one", "camera": "c", "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 1]}},
   {"id": "two", "camera": "c", "light": "small",
    "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 0.9]}}],
 "meshes": {"ball": {"sphere": {"radius_m": 0.1}}, "table": {"plane": {"size_m": [2, 2]}}},
 "surfaces": {"ball": {"model": "metal", "f0": [0.9, 0.7, 0.5], "alpha": 0.3},
   "table": {"model": "diffuse", "albedo": [0.5, 0.4, 0.3]}},
 "lights": {"large": {"model": "sphere", "position_m": [-0.4, 0.1, 0.8], "watt_per_sr": [1, 1, 1], "radius_m": 0.1},
   "small": {"model": "point", "position_m": [0.3, -0.2, 0.7], "watt_per_sr": [1, 1, 1]}},
 "objects": [{"id": "ball", "mesh": "ball", "surface": "ball",
     "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0.1]}},
   {"id": "table", "mesh": "table", "surface": "table"}]
})";

class RenderShares : public testing::Test {
 protected:
  RenderShares() { write_file(folder_ / "s.json", scene); }
  Ended render(Process::Words words) {
    words.insert(words.begin(), "render");
    return run(words, folder_.path());
  }
  // Must succeed in silence; the manifest that it prints.
  manifest::Document rendered(const Process::Words& words) {
    const Ended ended = render(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    return ended.out.empty() ? manifest::Document() : manifest::parse_document(ended.out, "stdout", folder_.path());
  }
  void refused(const Process::Words& words, int status, const char* mentions) {
    const auto before = files();
    const Ended ended = render(words);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(mentions));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(files(), before);
  }
  bool same(const std::string& a, const std::string& b) { return read_file(folder_ / a) == read_file(folder_ / b); }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (!entry.is_directory()) names.insert(fs::relative(entry.path(), folder_.path()).string());
    return names;
  }
  ScratchFolder folder_;
};

TEST_F(RenderShares, JoinToTheBytesOfOneRun) {
  const Process::Words common = {"s.json", "--spp", "32", "--seed", "6", "--per-light", "--stokes"};
  const auto with = [&](std::initializer_list<const char*> more) {
    Process::Words words = common;
    for (const char* word : more) words.emplace_back(word);
    return rendered(words);
  };
  with({"--out", "whole", "--sums"});
  const auto part = with({"--out", "a", "--samples", "10:26", "--threads", "1"});
  EXPECT_THAT(part.renderings.at(0).samples, ElementsAre(10, 26));
  EXPECT_EQ(part.renderings[0].spp, 16);
  with({"--out", "b", "--samples", "26:32", "--threads", "2"});
  with({"--out", "c", "--samples", "0:10", "--threads", "3"});
  const auto merged = rendered({"--merge", "--sums", "--out", "m", "s.json", "a/one.exr", "c/two.exr", "b/one.sums",
                                "b/two.exr", "c/one.exr", "a/two.exr"});
  for (const char* file : {"/one.exr", "/two.exr", "/one.sums", "/one-mosaic.exr", "/two-mosaic.exr"})
    EXPECT_TRUE(same(std::string("m") + file, std::string("whole") + file)) << file;
  ASSERT_EQ(merged.renderings.size(), 2u);
  EXPECT_EQ(merged.renderings[0].spp, 32);
  EXPECT_EQ(merged.renderings[0].seed, 6u);
  EXPECT_GT(merged.renderings[0].relative_error.value_or(0), 0);
  EXPECT_EQ(merged.renderings[0].files.count("mosaic"), 1u);
  // Without a manifest pictures alone; and what was joined can be joined again.
  EXPECT_EQ(render({"--merge", "--out", "n", "a/one.exr", "b/one.exr", "--sums"}).out, "");
  rendered({"--merge", "--out", "o", "c/one.exr", "n/one.exr"});
  EXPECT_TRUE(same("o/one.exr", "whole/one.exr"));
}

TEST_F(RenderShares, ThatCannotBeJoinedAreRefused) {
  rendered({"s.json", "--image", "one", "--spp", "32", "--samples", "0:2", "--out", "a"});
  rendered({"s.json", "--image", "one", "--spp", "32", "--samples", "4:6", "--out", "b"});
  rendered({"s.json", "--image", "one", "--spp", "32", "--samples", "2:4", "--out", "c", "--seed", "9"});
  rendered({"s.json", "--image", "one", "--spp", "4", "--out", "d"});
  refused({"--merge", "--out", "m", "a/one.exr", "b/one.exr"}, 65, "samples 2 to 3 are missing");
  refused({"--merge", "--out", "m", "a/one.exr", "c/one.exr"}, 65, "seed 9");
  refused({"--merge", "--out", "m", "a/one.exr", "a/one.exr"}, 65, "leave one of them out");
  refused({"--merge", "--out", "m", "d/one.exr"}, 66, "--samples");
  refused({"--merge", "--out", "m", "none.exr"}, 66, "none.sums");
  refused({"--merge", "--out", "a", "a/one.exr"}, 73, "--force");
  refused({"--merge", "--out", "m"}, 64, "nothing to join");
  refused({"--merge", "a/one.exr"}, 64, "--out");
  write_file(folder_ / "a/one.sums", read_file(folder_ / "a/one.sums").substr(0, 3000));
  refused({"--merge", "--out", "m", "a/one.exr"}, 65, "cut off");
}

TEST_F(RenderShares, SamplesThatAreNoShare) {
  for (const char* bad : {"4", "4:2", "2:2", "-2:2", "a:b", "0:2:4", "1.5:3"})
    refused({"s.json", "--spp", "32", "--out", "r", "--samples", bad}, 64, "is no share of a picture");
  refused({"s.json", "--spp", "32", "--out", "r", "--samples", "1:4"}, 64, "multiples of 2");
  refused({"s.json", "--spp", "32", "--out", "r", "--samples", "0:34"}, 64, "beyond the 32 samples");
  refused({"s.json", "--spp", "32", "--out", "r", "--samples", "0:2", "--noise", "1%"}, 64, "--samples");
  refused({"s.json", "--spp", "32", "--out", "r", "--samples", "0:2", "--record"}, 64, "--samples");
  refused({"s.json", "--out", "r", "--noise", "0"}, 64, "--noise");
  refused({"s.json", "--out", "r", "--noise", "1mm"}, 64, "--noise");
  refused({"s.json", "--out", "r", "--time", "-3s"}, 64, "--time");
  refused({"s.json", "--out", "r", "--wavelengths", "700nm:400nm:4"}, 64, "--wavelengths");
}

// Whatever the moment: the last whole pass is on the disk, and from there the picture is the one of a run that nobody
// stopped. Passes of a million samples have 64, like those of any number above a thousand.
TEST_F(RenderShares, StoppedRunsGoOn) {
  for (const int signal : {SIGINT, SIGKILL}) {
    const std::string out = "r" + std::to_string(signal);
    Process process({"render", "s.json", "--image", "one", "--spp", "1000000", "--checkpoint", "0s", "--out", out},
                    folder_.path());
    for (int i = 0; i < 60000 && !fs::exists(folder_ / (out + "/one.checkpoint")); ++i) ::usleep(1000);
    ::kill(process.id(), signal);
    const Ended stopped = process.end();
    EXPECT_EQ(stopped.status, signal == SIGKILL ? 128 + SIGKILL : 75);
    EXPECT_EQ(stopped.out, "");
    if (signal != SIGKILL) {
      EXPECT_THAT(stopped.err, HasSubstr("--resume goes on from"));
      EXPECT_EQ(std::count(stopped.err.begin(), stopped.err.end(), '\n'), 1) << stopped.err;
    }
    EXPECT_FALSE(fs::exists(folder_ / (out + "/one.exr")));
    const auto done = render::read_sums_header(folder_ / (out + "/one.checkpoint")).end_sample();
    EXPECT_GT(done, 0);
    const std::string spp = std::to_string(std::max<std::int64_t>(1024, done + 64));
    const Process::Words whole = {"s.json", "--image", "one", "--spp", spp, "--out"};
    Process::Words again = whole, anew = whole;
    again.push_back(out);
    refused(again, 73, "--resume goes on from it");
    again.push_back("--resume");
    rendered(again);
    anew.push_back(out + "-whole");
    rendered(anew);
    EXPECT_TRUE(same(out + "/one.exr", out + "-whole/one.exr")) << "signal " << signal << ", " << done << " samples";
    EXPECT_FALSE(fs::exists(folder_ / (out + "/one.checkpoint")));
  }
}

TEST_F(RenderShares, WhatIsFinishedIsNotRenderedAgain) {
  const Process::Words words = {"s.json", "--spp", "4", "--out", "r", "--preview", "--resume"};
  const auto first = rendered(words);
  const auto time = fs::last_write_time(folder_ / "r/one.exr");
  fs::remove(folder_ / "r/two.png");
  const auto second = rendered(words);
  EXPECT_EQ(fs::last_write_time(folder_ / "r/one.exr"), time);
  EXPECT_TRUE(fs::exists(folder_ / "r/two.png"));
  EXPECT_EQ(second.renderings.at(0).relative_error.value_or(0) > 0, true);
  EXPECT_EQ(second.renderings.size(), 2u);
  refused({"s.json", "--spp", "4", "--seed", "2", "--out", "r", "--resume"}, 73, "--force replaces it");
  refused({"s.json", "--spp", "4", "--out", "r"}, 73, "--force");
}

// A pane of two triangles has no inside.
TEST_F(RenderShares, OpenMeshesOfGlassOnlyWhereTheyAreAllowed) {
  io::TriangleMesh pane;
  pane.positions_m = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}};
  pane.triangles = {{0, 1, 2}, {0, 2, 3}};
  io::write_ply(folder_ / "pane.ply", pane);
  manifest::Document open = manifest::read_document(folder_ / "s.json");
  open.files["pane"] = {"pane.ply", {}, ""};
  open.meshes["ball"] = {};
  open.meshes["ball"].file = "pane";
  open.surfaces["ball"] = {};
  open.surfaces["ball"].model = "dielectric";
  open.surfaces["ball"].parameters["eta"] = 1.5;
  write_file(folder_ / "open.json", manifest::print_document(open, folder_.path()));
  refused({"open.json", "--spp", "2", "--out", "r"}, 65, "--allow-open");
  const Ended allowed = render({"open.json", "--spp", "2", "--out", "r", "--allow-open"});
  EXPECT_EQ(allowed.status, 0) << allowed.err;
  EXPECT_TRUE(fs::exists(folder_ / "r/two.exr"));
}

TEST_F(RenderShares, NoiseAndTimeEndTheWork) {
  const auto coarse = rendered({"s.json", "--image", "one", "--noise", "2%", "--out", "a"}).renderings.at(0);
  const auto fine = rendered({"s.json", "--image", "one", "--noise", "1%", "--out", "b"}).renderings.at(0);
  EXPECT_LE(coarse.relative_error.value(), 0.02);
  EXPECT_LE(fine.relative_error.value(), 0.01);
  EXPECT_GT(fine.spp.value(), 2 * coarse.spp.value());
  const Ended noisy = render({"s.json", "--noise", "0.01%", "--spp", "16", "--out", "c"});
  EXPECT_EQ(noisy.status, 2);
  EXPECT_EQ(std::count(noisy.err.begin(), noisy.err.end(), '\n'), 2) << noisy.err;  // a line for each image
  EXPECT_THAT(noisy.err, HasSubstr("after 16 samples per pixel, 0.01 % was asked for"));
  EXPECT_EQ(manifest::parse_document(noisy.out, "stdout", folder_.path()).renderings.size(), 2u);
  const auto timed = rendered({"s.json", "--image", "one", "--time", "1us", "--out", "d"}).renderings.at(0);
  EXPECT_EQ(timed.spp, 32);  // two passes, the least that has a variance
}

TEST_F(RenderShares, LayersOfLightsPolarizationAndWavelengths) {
  const auto done = rendered({"s.json", "--image", "one", "--spp", "16", "--per-light", "--stokes", "--wavelengths",
                              "450nm:650nm:5", "--out", "r"});
  const manifest::Rendering& entry = done.renderings.at(0);
  EXPECT_THAT(entry.wavelengths_m, ElementsAre(4.5e-7, 5e-7, 5.5e-7, 6e-7, 6.5e-7));
  const io::Image picture = io::read_picture(folder_ / "r/one.exr");
  for (const char* channel : {"variance.R", "normal.X", "depth.Z", "mask.A", "id", "variance.s3.B", "S0.450,0nm",
                              "S3.650,0nm", "visibility.large"})
    EXPECT_GE(picture.channel(channel), 0) << channel;
  const io::Image mosaic = io::read_picture(manifest::resolve(done, entry.files.at("mosaic"), "/renderings/0/files"));
  EXPECT_THAT(mosaic.channels, ElementsAre("R", "G", "B"));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (const char* band : {"R", "G", "B"}) {
        const auto value = [&](const std::string& layer) { return picture.at(x, y, picture.channel(layer + band)); };
        const double s0 = value(""), s1 = value("s1."), s2 = value("s2."), s3 = value("s3.");
        ASSERT_NEAR(value("light.large.") + value("light.small."), s0, 1e-6 * s0);
        ASSERT_LE(std::hypot(s1, s2, s3), s0 * (1 + 1e-6));
        const int quarter = 2 * (y % 2) + x % 2;  // 90 45; 135 0 degrees
        const double behind = 0.5 * (s0 + (quarter == 0 ? -s1 : quarter == 1 ? s2 : quarter == 2 ? -s2 : s1));
        ASSERT_NEAR(mosaic.at(x, y, mosaic.channel(band)), behind, 1e-6 * s0);
      }
}

}  // namespace
}  // namespace gonio::tests
