// scene as a person runs it (from GONIO_BIN): export to every format, what is lost, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class SceneProgram : public testing::Test {
 protected:
  SceneProgram() { write_file(folder_ / "s.json", run({"render", "--specimen", "spheres"}, folder_.path()).out); }
  Ended scene(Process::Words words) {
    words.insert(words.begin(), "scene");
    return run(words, folder_.path());
  }
  bool exists(const char* name) const { return std::filesystem::exists(folder_ / name); }
  ScratchFolder folder_;
};

TEST_F(SceneProgram, ExportsToEveryFormatAndHandsTheManifestOn) {
  const std::pair<const char*, const char*> formats[] = {{"blender", "scene.py"},
                                                         {"mitsuba", "view-0-lamp-0.xml"},
                                                         {"pbrt", "view-0-lamp-0.pbrt"},
                                                         {"gltf", "scene.gltf"}};
  for (const auto& [format, file] : formats) {
    const Ended ended = scene({"export", "--to", format, "--out", format, "s.json"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(exists((std::string(format) + "/" + file).c_str())) << format;
    const auto after = manifest::parse_document(ended.out, "stdout", folder_.path());
    EXPECT_EQ(after.images.size(), manifest::read_document(folder_ / "s.json").images.size());
  }
}

TEST_F(SceneProgram, WhatIsLostIsOneLineEachAndCountsUnderStrict) {
  const Ended ended = scene({"export", "--to", "blender", "--out", "b", "--strict", "s.json"});
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_TRUE(exists("b/scene.py"));
  std::istringstream lines(ended.err);
  for (std::string line; std::getline(lines, line);)
    EXPECT_THAT(line, testing::AllOf(HasSubstr("s.json#/"), HasSubstr("has no counterpart of"), HasSubstr("instead")));
}

TEST_F(SceneProgram, RefusesInOneLine) {
  const auto refused = [&](Process::Words words, int status, const char* mentions) {
    const Ended ended = scene(std::move(words));
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(mentions));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  };
  refused({"export", "s.json", "--out", "x"}, 64, "--to");
  refused({"export", "s.json", "--to", "blender"}, 64, "--out");
  refused({"export", "s.json", "--to", "povray", "--out", "x"}, 64, "blender");
  refused({"draw", "s.json"}, 64, "draw");
  refused({"import", "--out", "x"}, 64, "no file to read");
  refused({"import", "s.max", "--out", "x"}, 64, "s.max");
  refused({"import", "none.gltf", "--out", "x"}, 66, "none.gltf");
  refused({"check", "-i", "none.json"}, 66, "none.json");
  EXPECT_TRUE(!exists("x") || std::filesystem::is_empty(folder_ / "x"));
}

TEST_F(SceneProgram, WhatIsExportedAsGltfIsImportedAsTheSameImages) {
  EXPECT_EQ(scene({"export", "--to", "gltf", "--out", "g", "s.json"}).status, 0);
  const Ended ended = scene({"import", "g/scene.gltf", "--out", "back", "-o", "back/scene.json"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const auto before = manifest::read_document(folder_ / "s.json"),
             after = manifest::read_document(folder_ / "back/scene.json");
  ASSERT_EQ(after.images.size(), before.images.size());
  for (std::size_t i = 0; i < after.images.size(); ++i) {
    EXPECT_EQ(after.images[i].id, before.images[i].id);
    EXPECT_EQ(after.images[i].light, before.images[i].light);
  }
  const Ended rendered =
      run({"render", "back/scene.json", "--image", "view-0-lamp-0", "--spp", "1", "--out", "r"}, folder_.path());
  EXPECT_EQ(rendered.status, 0) << rendered.err;
}

TEST_F(SceneProgram, CheckIsWhatItDoesUnlessTold) {
  const Ended named = scene({"check", "s.json"}), bare = scene({"-i", "s.json"});
  EXPECT_EQ(named.status, 0) << named.out << named.err;
  EXPECT_EQ(bare.status, 0) << bare.err;
  EXPECT_EQ(bare.out, "");
}

}  // namespace
}  // namespace gonio::tests
