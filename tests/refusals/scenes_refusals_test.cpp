// Bad scenes: render refuses what cannot be computed and names what will look wrong; `scene check` names all of it.
#include <gmock/gmock.h>

#include <limits>

#include "base/atomic_file.h"
#include "data.h"
#include "io/ply.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

// A body of glass, a ball of clay and a table under one lamp.
const std::string good = R"({"gonio": 1, "files": {"f": {"path": "mesh.ply"}, "t": {"path": "none.exr"}},
 "cameras": {"c": {"model": "pinhole", "width_px": 8, "height_px": 6, "fx_px": 10, "fy_px": 10,
                   "cx_px": 3.5, "cy_px": 2.5}},
 "meshes": {"m": {"file": "f"}, "ball": {"sphere": {"radius_m": 0.05}}, "table": {"plane": {"size_m": [1.2, 1.0]}}},
 "surfaces": {"clay": {"model": "diffuse", "albedo": 0.5}, "glass": {"model": "dielectric", "eta": 1.5}},
 "lights": {"lamp": {"model": "sphere", "position_m": [0, 0, 0.6], "watt_per_sr": 1, "radius_m": 0.01}},
 "objects": [{"id": "thing", "mesh": "m", "surface": "glass"},
             {"id": "ball", "mesh": "ball", "surface": "clay",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.3, 0, 0.05]}},
             {"id": "table", "mesh": "table", "surface": "clay",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, -0.2]}}],
 "images": [{"id": "i", "camera": "c",
             "world_from_camera": {"rotation": [0, 1, 0, 0], "translation_m": [0, 0, 1]}}]})";

class BadScenes : public testing::Test {
 protected:
  BadScenes() { write(tetrahedron()); }
  static io::TriangleMesh tetrahedron() {
    io::TriangleMesh mesh;
    mesh.positions_m = {{0, 0, 0.2}, {0.1, 0, 0.01}, {-0.1, 0.1, 0.01}, {-0.1, -0.1, 0.01}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    return mesh;
  }
  void write(const io::TriangleMesh& mesh) { io::write_ply(folder_ / "mesh.ply", mesh); }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }
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
  EXPECT_EQ(render(good).err, "");
  const Ended checked = check(good);
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  EXPECT_EQ(checked.out, "");
}

TEST_F(BadScenes, OpenMeshesAsGlass) {
  io::TriangleMesh open = tetrahedron();
  open.triangles.pop_back();
  write(open);
  expect_refused(good, 65, "#/objects/0: the mesh of \"thing\" has 3 open edges around 1 hole");
  const Ended checked = check(good);
  EXPECT_EQ(checked.status, 1);
  expect_one_line(checked.out, "3 open edges around 1 hole", "light that enters never leaves again");
  expect_refused(with("\"mesh\": \"table\", \"surface\": \"clay\"", "\"mesh\": \"table\", \"surface\": \"glass\""), 65,
                 "3 open edges");
}

TEST_F(BadScenes, OpticsThatCannotBe) {
  expect_refused(with("\"eta\": 1.5", "\"eta\": 0"), 65, "#/surfaces/glass/eta");
  expect_refused(with("\"eta\": 1.5", "\"eta\": 1.5, \"sigma_a_per_m\": [1, -2, 1]"), 65,
                 "#/surfaces/glass/sigma_a_per_m");
  EXPECT_EQ(check(with("\"eta\": 1.5", "\"eta\": 0")).status, 65);
}

TEST_F(BadScenes, MissingTextures) {
  const auto textured = [](const char* file) {
    return with(R"("albedo": 0.5)", std::string(R"("albedo": 0.5, "textures": {"albedo": ")") + file + "\"}");
  };
  expect_refused(textured("t"), 66, "none.exr");
  expect_refused(textured("u"), 65, "#/surfaces/clay/textures/albedo");
}

TEST_F(BadScenes, NumbersInMeshesThatAreNone) {
  io::TriangleMesh mesh = tetrahedron();
  mesh.positions_m[2].y = std::numeric_limits<double>::quiet_NaN();
  write(mesh);
  expect_refused(good, 65, "mesh.ply");
}

TEST_F(BadScenes, TrianglesWithoutArea) {
  io::TriangleMesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 1, 1});
  write(mesh);
  expect_named(good, "mesh.ply: 1 of 5 triangles have no area", "left out");
  mesh.triangles = {{0, 1, 1}};
  write(mesh);
  expect_refused(good, 65, "mesh.ply");
}

TEST_F(BadScenes, LightsInsideOfThings) {
  expect_named(with("[0, 0, 0.6]", "[0.3, 0, 0.05]"), "#/lights/lamp: the light \"lamp\" stands inside \"ball\"",
               "nothing outside is lit by it");
  expect_named(with("[0, 0, 0.6]", "[0, 0, 0.1]"), "stands inside \"thing\"", "caustic");
  expect_named(with("[0, 0, 0.6]", "[0.3, 0, 0.105]"), "the ball of 0.01 m of the light \"lamp\" meets \"ball\"",
               "within the object");
}

}  // namespace
}  // namespace gonio::tests
