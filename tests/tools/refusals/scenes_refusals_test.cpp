// Bad scenes: render refuses what cannot be computed and names what will look wrong; `scene check` names all of it.
#include <gmock/gmock.h>

#include <limits>

#include "base/atomic_file.h"
#include "data.h"
#include "good_scene.h"
#include "io/ply.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class BadScenes : public testing::Test {
 protected:
  BadScenes() { write(tetrahedron()); }
  void write(const io::TriangleMesh& mesh) { io::write_ply(folder_ / "mesh.ply", mesh); }
  Ended render(const std::string& scene, const char* out = "r") {
    return run({"render", "-i", "-", "--spp", "1", "--out", out, "--force"}, folder_.path(), scene);
  }
  Ended check(const std::string& scene) { return run({"scene", "check", "-i", "-"}, folder_.path(), scene); }

  void expect_refused(const std::string& scene, int status, const std::string& mentions) {
    const Ended ended = render(scene, "refused");
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(mentions));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_TRUE(!std::filesystem::exists(folder_ / "refused") || std::filesystem::is_empty(folder_ / "refused"));
  }
  // One line of render's on standard error, the same of check's on standard output.
  void expect_named(const std::string& scene, const std::string& mentions, const std::string& consequence) {
    const Ended rendered = render(scene);
    EXPECT_EQ(rendered.status, 0) << rendered.err;
    expect_one_line(rendered.err, mentions, consequence);
    const Ended checked = check(scene);
    EXPECT_EQ(checked.status, 1) << checked.err;
    expect_one_line(checked.out, mentions, consequence);
  }
  static void expect_one_line(const std::string& text, const std::string& mentions, const std::string& consequence) {
    EXPECT_THAT(text, testing::AllOf(HasSubstr(mentions), HasSubstr(consequence)));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  }
  ScratchFolder folder_;
};

TEST_F(BadScenes, NothingIsWrongWithTheGoodOne) {
  EXPECT_EQ(render(good_scene).err, "");
  const Ended checked = check(good_scene);
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_EQ(checked.out, "");
}

TEST_F(BadScenes, OpenMeshesAsGlass) {
  io::TriangleMesh open = tetrahedron();
  open.triangles.pop_back();
  write(open);
  expect_refused(good_scene, 65, "#/objects/0: the mesh of \"thing\" has 3 open edges around 1 hole");
  const Ended checked = check(good_scene);
  EXPECT_EQ(checked.status, 1);
  expect_one_line(checked.out, "3 open edges around 1 hole", "light that enters never leaves again");
  expect_refused(
      good_scene_with("\"mesh\": \"table\", \"surface\": \"clay\"", "\"mesh\": \"table\", \"surface\": \"glass\""), 65,
      "3 open edges");
}

TEST_F(BadScenes, OpticsThatCannotBe) {
  expect_refused(good_scene_with("\"eta\": 1.5", "\"eta\": 0"), 65, "#/surfaces/glass/eta");
  expect_refused(good_scene_with("\"eta\": 1.5", "\"eta\": 1.5, \"sigma_a_per_m\": [1, -2, 1]"), 65,
                 "#/surfaces/glass/sigma_a_per_m");
  EXPECT_EQ(check(good_scene_with("\"eta\": 1.5", "\"eta\": 0")).status, 65);
}

TEST_F(BadScenes, MissingTextures) {
  const auto textured = [](const char* file) {
    return good_scene_with(R"("albedo": 0.5)",
                           std::string(R"("albedo": 0.5, "textures": {"albedo": ")") + file + "\"}");
  };
  expect_refused(textured("t"), 66, "none.exr");
  expect_refused(textured("u"), 65, "#/surfaces/clay/textures/albedo");
}

TEST_F(BadScenes, NumbersInMeshesThatAreNone) {
  io::TriangleMesh mesh = tetrahedron();
  mesh.positions_m[2].y = std::numeric_limits<double>::quiet_NaN();
  write(mesh);
  expect_refused(good_scene, 65, "mesh.ply");
}

TEST_F(BadScenes, TrianglesWithoutArea) {
  io::TriangleMesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 1, 1});
  write(mesh);
  expect_named(good_scene, "mesh.ply: 1 of 5 triangles have no area", "left out");
  mesh.triangles = {{0, 1, 1}};
  write(mesh);
  expect_refused(good_scene, 65, "mesh.ply");
}

TEST_F(BadScenes, LightsInsideOfThings) {
  expect_named(good_scene_with("[0, 0, 0.6]", "[0.3, 0, 0.05]"),
               "#/lights/lamp: the light \"lamp\" stands inside \"ball\"", "nothing outside is lit by it");
  expect_named(good_scene_with("[0, 0, 0.6]", "[0, 0, 0.1]"), "stands inside \"thing\"", "caustic");
  expect_named(good_scene_with("[0, 0, 0.6]", "[0.3, 0, 0.105]"),
               "the ball of 0.01 m of the light \"lamp\" meets \"ball\"", "within the object");
}

}  // namespace
}  // namespace gonio::tests
