// render as a person runs it (from GONIO_BIN): specimens, pipes, quick forms, virtual recordings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/light.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/surface.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class Render : public testing::Test {
 protected:
  Ended render(Process::Words words, const std::string& input = {}) {
    words.insert(words.begin(), "render");
    return run(words, folder_.path(), input);
  }
  manifest::Document document(const Ended& ended) {
    EXPECT_EQ(ended.status, 0) << ended.err;
    return manifest::parse_document(ended.out, "stdout", folder_.path());
  }
  std::string bytes(const std::string& name) { return read_file(folder_ / name); }
  ScratchFolder folder_;
};

TEST_F(Render, ASpecimenThroughAPipe) {
  const Ended specimen = render({"--specimen", "knot", "--out", "k"});
  EXPECT_EQ(names_in(document(specimen), "images").size(), 9u);
  const Ended ended = render({"--image", "view-1-lamp-2", "--spp", "2", "--out", "r", "--preview"}, specimen.out);
  const manifest::Document done = document(ended);
  ASSERT_EQ(done.renderings.size(), 1u);
  EXPECT_EQ(done.renderings[0].image, "view-1-lamp-2");
  EXPECT_EQ(done.renderings[0].spp, 2);
  const io::Image picture = io::read_picture(manifest::resolve(done, done.renderings[0].file, "/renderings/0"));
  for (const char* channel :
       {"R", "variance.B", "position.Z", "normal.X", "id", "distance.lamp-2", "visibility.lamp-2"})
    EXPECT_GE(picture.channel(channel), 0) << channel;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "r/view-1-lamp-2.png"));
  EXPECT_EQ(ended.err, "");
}

// Also of a picture that was finished before they were asked for.
TEST_F(Render, LayersAsPicturesToLookAt) {
  const Ended specimen = render({"--specimen", "glass", "--out", "g"});
  ASSERT_EQ(specimen.status, 0) << specimen.err;
  const Process::Words words = {"--image", "front", "--spp", "2", "--out", "r", "--stokes"};
  ASSERT_EQ(render(words, specimen.out).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r/front-depth.png"));
  Process::Words again = words;
  again.insert(again.end(), {"--preview-layers", "--resume"});
  ASSERT_EQ(render(again, specimen.out).status, 0);
  for (const char* layer : {"s1", "s2", "s3", "depth", "normal", "back-normal"}) {
    const auto file = folder_ / ("r/front-" + std::string(layer) + ".png");
    ASSERT_TRUE(std::filesystem::exists(file)) << layer;
    EXPECT_EQ(io::read_picture(file).width, io::read_picture(folder_ / "r/front.exr").width) << layer;
  }
}

TEST_F(Render, AManifestInsideTheFolderThatOutMakes) {
  const Ended ended = render({"--specimen", "knot", "--out", "new/folder", "-o", "new/folder/scene.json"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "new/folder/scene.json"));
  const Ended beside = render({"--specimen", "knot", "--out", "other", "-o", "missing/scene.json"});
  EXPECT_EQ(beside.status, 73);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other")) << "nothing is made where the answer has no place";
}

TEST_F(Render, SameSeedSameBytes) {
  write_file(folder_ / "s.json", render({"--specimen", "spheres"}).out);
  const Process::Words words = {"s.json", "--image", "view-0-lamp-0", "--spp", "4", "--seed", "5"};
  const auto with = [&](const char* out, const char* threads) {
    Process::Words all = words;
    all.insert(all.end(), {"--out", out, "--threads", threads});
    EXPECT_EQ(render(all).status, 0);
    return bytes(std::string(out) + "/view-0-lamp-0.exr");
  };
  const std::string one = with("a", "1");
  EXPECT_EQ(with("b", "3"), one);
  Process::Words all = words;  // and whichever other images are rendered with it
  all.insert(all.end(), {"--image", "view-2-lamp-1", "--out", "c"});
  EXPECT_EQ(render(all).status, 0);
  EXPECT_EQ(bytes("c/view-0-lamp-0.exr"), one);
}

TEST_F(Render, RecordingsConcealWhatTheyShow) {
  write_file(folder_ / "s.json", render({"--specimen", "spheres"}).out);
  const manifest::Document before = manifest::read_document(folder_ / "s.json");
  const Ended ended = render({"s.json", "--image", "view-0-lamp-0", "--spp", "4", "--record", "--with",
                              "light.finite-size:radius_m=30mm", "--out", "rec"});
  const manifest::Document after = document(ended);
  EXPECT_TRUE(after.mechanisms.empty());
  EXPECT_TRUE(after.renderings.empty());
  EXPECT_TRUE(has_entry(after, "files", "recording-view-0-lamp-0"));
  EXPECT_THAT(files_of_image(after, 0), testing::ElementsAre(folder_ / "rec/view-0-lamp-0.exr"));
  EXPECT_TRUE(files_of_image(after, 1).empty());
  EXPECT_EQ(after.surfaces.at("clay").parameters.at("albedo").value, (std::vector<double>{0.5, 0.5, 0.5}));
  EXPECT_EQ(after.lights.at("lamp-0").model, before.lights.at("lamp-0").model);
  const io::Image picture = io::read_picture(folder_ / "rec/view-0-lamp-0.exr");
  EXPECT_THAT(picture.channels, testing::ElementsAre("R", "G", "B"));
}

TEST_F(Render, RefusesInOneLine) {
  write_file(folder_ / "s.json", render({"--specimen", "spheres"}).out);
  const auto refused = [&](Process::Words words, int status, const char* mentions) {
    const Ended ended = render(std::move(words));
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(mentions));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  };
  refused({"s.json"}, 64, "--out");
  refused({"s.json", "--out", "r", "--image", "none"}, 64, "there is no image \"none\"");
  refused({"s.json", "--out", "r", "--with", "surface.interfaec:f0=0.1"}, 64, "no mechanism \"surface.interfaec\"");
  refused({"s.json", "--out", "r", "--with", "surface.interface:f0=7"}, 64, "not plausible");
  refused({"s.json", "--out", "r", "--with", "light.finite-size:radius_m=3deg"}, 64, "--with");
  refused({"s.json", "--out", "r", "--with", "surface.interface:f0=0.05,on=glass"}, 65, "glass");
  refused({"s.json", "--out", "r", "--spp", "0"}, 64, "--spp");
  refused({"--specimen", "bust"}, 64, "knot");
  refused({}, 66, "scene");
}

TEST_F(Render, CheckRunsNothing) {
  write_file(folder_ / "s.json", render({"--specimen", "spheres"}).out);
  const Ended ended = render({"s.json", "--out", "r", "--check"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r"));
}

}  // namespace
}  // namespace gonio::tests
