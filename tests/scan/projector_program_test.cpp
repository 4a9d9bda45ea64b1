// calib-charuco --projector as people run it, on photographs of a world of closed forms, and what it refuses.
// One process: ProjectorProgram.*:ProjectorRefusals.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "base/text.h"
#include "camera/corner_table.h"
#include "data.h"
#include "io/codes.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/projection.h"
#include "manifest/sections/rig.h"
#include "process.h"
#include "scan/board_world.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

constexpr int views = 6;

scan::Sequence shown() {
  return cosines_and_white(BoardWorld{}, {1, 8, 40}, 3);
}

// Pictures of all views, a folder each, rendered once.
const std::filesystem::path& photographs() {
  static const ScratchFolder folder;
  static const bool made = [] {
    const BoardSession session(BoardWorld{}, shown(), views);
    for (std::size_t v = 0; v < views; ++v) {
      make_folder(folder / format("view%zu", v));
      for (std::size_t f = 0; f < shown().frames.size(); ++f) {
        io::Image picture(session.world().camera.width, session.world().camera.height, {"Y"});
        picture.data = session.frame(v, f, 1).light;
        io::write_png(folder / format("view%zu/%zu.png", v, f), picture, 16);
      }
    }
    manifest::Document d;
    d.projections["cosines"] = scan::projection_of(shown());
    write_file(folder / "shown.json", manifest::print_document(d, folder.path()));
    return true;
  }();
  EXPECT_TRUE(made);
  return folder.path();
}

std::vector<std::string> pictures(const std::vector<int>& of = {0, 1, 2, 3, 4, 5}) {
  std::vector<std::string> all;
  for (const int v : of)
    for (std::size_t f = 0; f < shown().frames.size(); ++f) all.push_back(format("view%d/%zu.png", v, f));
  return all;
}

Ended calibrate(std::vector<std::string> words, const std::vector<std::string>& files,
                const char* manifest = "shown.json") {
  words.insert(words.begin(), {"calib-charuco", "-i", manifest, "--checkerboard", "9x6", "--square", "22mm"});
  words.insert(words.end(), files.begin(), files.end());
  return run(words, photographs());
}

TEST(ProjectorProgram, PhotographsBecomeARigOfCameraAndProjector) {
  const Ended ended = calibrate(
      {"--projector", "beamer", "--fix", "p1", "--fix", "p2", "--fix", "k3", "--out", "calibrated"}, pictures());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = manifest::parse_document(ended.out, "rig.json", photographs(), {.allow_outside = true});
  const BoardWorld world;
  const manifest::Camera& beamer = d.cameras.at("beamer");
  EXPECT_EQ(beamer.width_px, 480);
  EXPECT_EQ(beamer.height_px, 360);
  EXPECT_NEAR(beamer.fx_px.scalar(), world.projector.fx, 4 * beamer.sigma.at("fx_px").front());
  EXPECT_NEAR(beamer.cy_px.scalar(), world.projector.cy, 4 * beamer.sigma.at("cy_px").front());
  EXPECT_LT(beamer.rms_px.value(), 0.2);
  ASSERT_TRUE(beamer.quality);
  const manifest::Rig& rig = d.rigs.at("rig");
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].camera, "beamer");
  EXPECT_TRUE(std::filesystem::exists(photographs() / "calibrated/calibration-beamer.html"));
  const camera::CornerTable corners = camera::read_corners(d, "corners-beamer");
  EXPECT_EQ(corners.images.size(), static_cast<std::size_t>(views));
  EXPECT_THAT(ended.out, HasSubstr("\"id\": \"view2-beamer\""));
  // The same manifest again: nothing is entered twice.
  write_file(photographs() / "again.json", ended.out);
  const Ended again = run({"calib-charuco", "-i", "again.json", "--projector", "beamer", "--no-quality", "--fix", "p1",
                           "--fix", "p2", "--fix", "k3"},
                          photographs());
  ASSERT_EQ(again.status, 0) << again.err;
  const manifest::Document twice =
      manifest::parse_document(again.out, "again.json", photographs(), {.allow_outside = true});
  EXPECT_THAT(again.out, testing::Not(HasSubstr("beamer-2")));
  EXPECT_NEAR(twice.cameras.at("beamer").fx_px.scalar(), beamer.fx_px.scalar(), 1e-6);
  // Then the pair measures: a board's plane, from the pictures that are in the manifest.
  const Ended measured =
      run({"structured-light", "-i", "again.json", "--camera", "camera", "--projector", "beamer", "--out", "scan"},
          photographs());
  EXPECT_EQ(measured.status, 0) << measured.err;
  EXPECT_TRUE(std::filesystem::exists(photographs() / "scan/view3.ply"));
}

struct Case {
  std::vector<std::string> words, files;
  const char* manifest;
  int status;
  const char* says;
};

class ProjectorRefusals : public testing::Test {
 protected:
  static void refuse(const std::vector<Case>& cases) {
    for (const Case& c : cases) {
      const Ended ended = calibrate(c.words, c.files, c.manifest);
      EXPECT_EQ(ended.status, c.status) << c.says << ": " << ended.err;
      EXPECT_THAT(ended.err, HasSubstr(c.says));
      EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
      EXPECT_TRUE(ended.out.empty());
    }
  }
  static void write(const char* name, const auto& change) {
    manifest::Document d;
    d.projections["cosines"] = scan::projection_of(shown());
    change(d);
    write_file(photographs() / name, manifest::print_document(d, photographs()));
  }
};

TEST_F(ProjectorRefusals, ManifestsThatSayTooLittleOrContradictThemselves) {
  photographs();
  constexpr scan::Axis both[] = {scan::Axis::column, scan::Axis::row};
  write("two.json", [](auto& d) { d.projections["other"] = d.projections["cosines"]; });
  write("wide.json", [](auto& d) { d.cameras["beamer"].width_px = 1920, d.cameras["beamer"].height_px = 1080; });
  write("columns.json",
        [](auto& d) { std::erase_if(d.projections["cosines"].frames, [](const auto& f) { return f.axis == "row"; }); });
  write("bits.json", [&](auto& d) {
    scan::Sequence gray = scan::gray_sequence(480, 360, both);
    gray.frames.resize(gray.frames.size() - 2);
    d.projections["cosines"] = scan::projection_of(gray);
  });
  write("nothing.json", [](auto& d) { d.projections.clear(); });
  const std::vector<std::string> all = pictures(), cut(all.begin(), all.end() - 1);
  std::vector<std::string> gray;
  for (int f = 0; f < 36; ++f) gray.push_back(format("view0/%d.png", f % 19));
  const std::vector<std::string> words{"--projector", "beamer"};
  refuse(
      {{words, cut, "shown.json", 65, "is the last of 18 pictures by camera camera, and the projection cosines has 19"},
       {words, all, "two.json", 64, "--projection: is missing, and there are 2"},
       {{"--projector", "beamer", "--projection", "gray"}, all, "two.json", 65, "has no gray among 2"},
       {words, all, "nothing.json", 65, "has none"},
       {words, {}, "shown.json", 66, "have no pictures of projection cosines"},
       {words, all, "wide.json", 65, "has 1920 x 1080 pixels, and what it shows 480 x 360"},
       {words, pictures({0}), "columns.json", 65, "and the projection cosines has 10"},
       {words, std::vector<std::string>(all.begin(), all.begin() + 10), "columns.json", 65, "tells one axis alone"},
       {words, gray, "bits.json", 65, "no white or no black picture"},
       {{"--projector", "camera"}, all, "shown.json", 65, "is a photograph by camera, the projector"},
       {{"--projection", "cosines"}, all, "shown.json", 64, "projector"}});
}

// Pictures of a mirrored and of a turned-over projector, and of one that is switched off.
TEST_F(ProjectorRefusals, ProjectorsThatRunTheWrongWayRound) {
  photographs();
  for (const char* kind : {"mirrored", "exchanged", "off"}) {
    BoardWorld world;
    world.across = 3, world.at_edges = 4;
    world.mirrored = kind == std::string("mirrored"), world.exchanged = kind == std::string("exchanged");
    if (kind == std::string("off")) world.projected = 0, world.ambient = 0.6;
    const BoardSession session(world, shown(), 1);
    make_folder(photographs() / kind);
    for (std::size_t f = 0; f < shown().frames.size(); ++f) {
      io::Image picture(world.camera.width, world.camera.height, {"Y"});
      picture.data = session.frame(0, f, 1).light;
      io::write_png(photographs() / format("%s/%zu.png", kind, f), picture, 16);
    }
  }
  const auto of = [](const char* kind) {
    std::vector<std::string> all;
    for (std::size_t f = 0; f < shown().frames.size(); ++f) all.push_back(format("%s/%zu.png", kind, f));
    return all;
  };
  const std::vector<std::string> words{"--projector", "beamer"};
  refuse({{words, of("mirrored"), "shown.json", 65, "mirrored-beamer is mirrored"},
          {words, of("exchanged"), "shown.json", 65, "exchanged-beamer has columns for rows"},
          {words, of("off"), "shown.json", 65,
           "of 54 corners of the board the codes tell 0: 100 % of the pixels about them are dark"}});
}

}  // namespace
}  // namespace gonio::tests
