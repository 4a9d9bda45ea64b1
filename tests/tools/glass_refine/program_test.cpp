#include <gmock/gmock.h>

#include <fstream>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/surface.h"
#include "process.h"

namespace gonio::tests {
namespace {

namespace fs = std::filesystem;
using Words = Process::Words;

// A recording of five views, made once.
// One process: GlassRefine.*
class GlassRefine : public testing::Test {
 protected:
  static const fs::path& folder() {
    static const ScratchFolder scratch;
    static const bool made = [] {
      const Ended ended = run({"glass-make", "--log-level", "error",  "--objects", "1",       "--views", "5",
                               "--form",     "lathe",       "--size", "32x32",     "--noise", "100%",    "--spp",
                               "16",         "--recording", "0",      "--out",     "set",     "-o",      "set.json"},
                              scratch.path());
      EXPECT_EQ(ended.status, 0) << ended.err;
      return true;
    }();
    static const fs::path path = made ? scratch.path() : fs::path();
    return path;
  }
  static Ended call(const Words& more) {
    Words words{"glass-refine", "--log-level", "error", "--cells", "10", "--spp", "4", "--stands-on", "0mm"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder());
  }
  // A copy of the recording, changed.
  static std::string changed(const std::string& name, const std::function<void(manifest::Document&)>& change) {
    manifest::Document document = manifest::read_document(folder() / "set/object-0.json");
    change(document);
    write_file(folder() / "set" / name, manifest::print_document(document, folder() / "set"));
    return "set/" + name;
  }
  static void expect_refused(const Words& more, int status, const std::string& mentions) {
    const Ended ended = call(more);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.err, testing::HasSubstr(mentions));
    EXPECT_EQ(ended.out, "");
  }
};

TEST_F(GlassRefine, WritesBodyMapsAndWhatEachStageLeft) {
  const Ended ended = call({"--out", "answer", "set/object-0.json", "-o", "answer.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document answer = manifest::read_document(folder() / "answer.json");
  for (const char* file : {"refined", "stages", "maps-view-0", "maps-view-4"})
    EXPECT_TRUE(answer.files.contains(file)) << file;
  EXPECT_EQ(answer.surfaces.at("refined").model, "dielectric");
  EXPECT_TRUE(answer.surfaces.at("refined").parameters.contains("eta"));
  ASSERT_EQ(answer.comparisons.size(), 1u);
  EXPECT_EQ(answer.comparisons[0].image, "view-4");
  const io::Image maps = io::read_picture(folder() / "answer/maps/view-0.exr");
  EXPECT_EQ(maps.width, 32);
  for (const char* layer :
       {"mask", "depth.Z", "normal.X", "uncertainty.normal", "back_normal.Z", "uncertainty.back_normal", "thickness"})
    EXPECT_GE(maps.channel(layer), 0) << layer;
  EXPECT_GT(io::read_ply(folder() / "answer/refined.ply").triangles.size(), 100u);
  EXPECT_EQ(io::read_picture(folder() / "answer/held-out-refined.exr").width, 32);
  const std::string table = read_file(folder() / "answer/stages.csv");
  EXPECT_THAT(table, testing::StartsWith("stage,unexplained,unexplained_held_out,index"));
  EXPECT_THAT(table, testing::HasSubstr("\nhull,"));
  EXPECT_THAT(table, testing::HasSubstr("\nlight-2,"));
  const std::string page = read_file(folder() / "answer/report.html");
  for (const char* part : {"view-4, kept out of the fit", "photograph, hull, answer", "light-2", "back-normal +-"})
    EXPECT_THAT(page, testing::HasSubstr(part));
  // Its maps are what a network's answers look like; the same call gives the same bytes, whatever the threads.
  const Words again{"--network", "answer/maps", "--no-light", "set/object-0.json", "--hold-out", "view-2"};
  for (const char* name : {"one", "two"}) {
    Words words = again;
    words.insert(words.end(),
                 {"--threads", *name == 'o' ? "1" : "3", "--out", name, "-o", std::string(name) + ".json"});
    ASSERT_EQ(call(words).status, 0);
  }
  EXPECT_EQ(read_file(folder() / "one/refined.ply"), read_file(folder() / "two/refined.ply"));
  EXPECT_EQ(read_file(folder() / "one/stages.csv"), read_file(folder() / "two/stages.csv"));
  EXPECT_THAT(read_file(folder() / "one/stages.csv"), testing::HasSubstr("\nnormals,"));
  expect_refused({"--out", "one", "set/object-0.json"}, 73, "--force");
}

TEST_F(GlassRefine, RefusesWhatMakesNoSense) {
  expect_refused({"set/object-0.json"}, 64, "--out");
  expect_refused({"--out", "x", "set/object-0.json", "--hold-out", "view-9"}, 64, "view-9");
  expect_refused({"--out", "x", "set/object-0.json", "--index", "1"}, 64, "--index");
  expect_refused({"--out", "x", "set/report.html"}, 64, "is no manifest");
  expect_refused({"--out", "x", "set/object-0.json", "--network", "nowhere"}, 66, "nowhere");
  expect_refused({"--out", "x", "set/object-0.json", "--network", "set"}, 66, "IMAGE.exr");
  const std::string few = changed("few.json", [](manifest::Document& d) { d.images.resize(3); });
  expect_refused({"--out", "x", few}, 65, "3 views");
  const std::string dark =
      changed("dark.json", [](manifest::Document& d) { d.images[1].light = {}, d.images[1].dark = true; });
  expect_refused({"--out", "x", dark}, 65, "no screen");
  const std::string many = changed("many.json", [](manifest::Document& d) { d.images[1].light = {}; });
  expect_refused({"--out", "x", many}, 65, "several screens");
  const std::string bare = changed("bare.json", [](manifest::Document& d) { d.images[2].mask = ""; });
  expect_refused({"--out", "x", bare}, 65, "no mask");
  const std::string unfiltered =
      changed("unfiltered.json", [](manifest::Document& d) { d.cameras.at("view-2").mosaic = ""; });
  expect_refused({"--out", "x", unfiltered}, 65, "Stokes planes");
  // Poses that do not belong together leave nothing in common.
  const std::string apart =
      changed("apart.json", [](manifest::Document& d) { d.images[0].world_from_camera->translation_m.x += 3; });
  expect_refused({"--out", "x", apart}, 65, "nothing in common");
}

}  // namespace
}  // namespace gonio::tests
