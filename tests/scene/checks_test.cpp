// Bad scenes, each found and named with what the picture will show because of it; a good one has no findings.
#include "scene/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"

namespace gonio::scene {
namespace {

using testing::HasSubstr;

const std::string good = R"({"gonio": 1, "files": {"f": {"path": "mesh.ply"}},
 "cameras": {"c": {"model": "pinhole", "width_px": 8, "height_px": 6, "fx_px": 10, "fy_px": 10, "cx_px": 3.5, "cy_px": 2.5}},
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

io::TriangleMesh tetrahedron() {
  io::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, 0.2}, {0.1, 0, 0.01}, {-0.1, 0.1, 0.01}, {-0.1, -0.1, 0.01}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return mesh;
}

class Checks : public testing::Test {
 protected:
  Checks() { io::write_ply(folder_ / "mesh.ply", tetrahedron()); }
  void mesh(const io::TriangleMesh& mesh) { io::write_ply(folder_ / "mesh.ply", mesh); }

  Scene scene(const std::string& text, bool allow_open) const {
    Reading reading;
    reading.allow_open = allow_open;
    reading.on_warning = [](const std::string&) {};
    return build_scene(manifest::parse_document(text, "s.json", folder_.path()), reading);
  }
  std::string refusal(const std::string& text) const {
    try {
      scene(text, false);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "none";
  }
  // The only finding.
  void expect_found(const std::string& text, const std::string& pointer, const std::string& what,
                    const std::string& consequence) const {
    const auto all = check_scene(scene(text, true));
    ASSERT_EQ(all.size(), 1u) << (all.size() > 1 ? all[1].what : "");
    EXPECT_EQ(all[0].pointer, pointer);
    EXPECT_THAT(all[0].what, HasSubstr(what));
    EXPECT_THAT(all[0].consequence, HasSubstr(consequence));
  }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  }

  tests::ScratchFolder folder_;
};

TEST_F(Checks, AGoodSceneHasNone) {
  EXPECT_EQ(refusal(good), "none");
  EXPECT_TRUE(check_scene(scene(good, false)).empty());
}

TEST_F(Checks, AnOpenMeshAsGlassIsRefusedUnlessAllowed) {
  io::TriangleMesh open = tetrahedron();
  open.triangles.pop_back();
  mesh(open);
  const std::string words = refusal(good);
  EXPECT_THAT(words, HasSubstr("s.json#/objects/0: the mesh of \"thing\" has 3 open edges around 1 hole"));
  EXPECT_THAT(words, HasSubstr("light that enters never leaves"));
  EXPECT_THAT(words, HasSubstr("--allow-open"));
  expect_found(good, "/objects/0", "3 open edges", "absorbed inside is wrong");
  EXPECT_EQ(refusal(with("\"surface\": \"glass\"", "\"surface\": \"clay\"")), "none");  // a shell of clay may be open
}

TEST_F(Checks, APlaneBoundsNothing) {
  const std::string text =
      with("\"mesh\": \"table\", \"surface\": \"clay\"", "\"mesh\": \"table\", \"surface\": \"glass\"");
  EXPECT_THAT(refusal(text), HasSubstr("\"table\" is a plane, and bounds a medium"));
  expect_found(text, "/objects/2", "plane", "never leaves");
}

TEST_F(Checks, AMeshThatFacesInwards) {
  io::TriangleMesh turned = tetrahedron();
  for (auto& t : turned.triangles) std::swap(t[1], t[2]);
  mesh(turned);
  EXPECT_EQ(refusal(good), "none");
  expect_found(good, "/objects/0", "faces inwards", "a cavity in glass");
}

TEST_F(Checks, ATriangleTurnedRound) {
  io::TriangleMesh turned = tetrahedron();
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  mesh(turned);
  EXPECT_THAT(refusal(good), HasSubstr("3 edges whose triangles face opposite ways"));
  expect_found(good, "/objects/0", "face opposite ways", "inside and outside change places");
}

TEST_F(Checks, AWallWithinTheGlass) {
  io::TriangleMesh walled = tetrahedron();
  walled.triangles.push_back({0, 1, 2});
  walled.triangles.push_back({0, 2, 1});
  mesh(walled);
  expect_found(good, "/objects/0", "more than two triangles meet at 3 edges", "interfaces of the medium");
}

TEST_F(Checks, NormalsAgainstTheTriangles) {
  io::TriangleMesh wrong = tetrahedron();
  for (const Vec3 p : wrong.positions_m) wrong.normals.push_back(normalized(Vec3{0, 0, 0.07} - p));
  mesh(wrong);
  expect_found(good, "/objects/0", "point against 4 of its 4 triangles", "turned inside out");
}

TEST_F(Checks, LightsAndCamerasInsideOfThings) {
  expect_found(with("[0, 0, 0.6]", "[0, 0, 0.1]"), "/lights/lamp", "stands inside \"thing\"", "caustic");
  expect_found(with("[0, 0, 0.6]", "[0.3, 0, 0.05]"), "/lights/lamp", "stands inside \"ball\"", "hidden");
  expect_found(with("[0, 0, 0.6]", "[0.3, 0, 0.105]"), "/lights/lamp",
               "the ball of 0.01 m of the light \"lamp\" meets \"ball\"", "within the object");
  expect_found(with("[0, 1, 0, 0], \"translation_m\": [0, 0, 1]", "[0, 1, 0, 0], \"translation_m\": [0.3, 0, 0.06]"),
               "/images/0/world_from_camera", "stands inside \"ball\"", "sees the inside");
}

TEST_F(Checks, OverlappingMediaOfEqualPriority) {
  const std::string text = with(
      "\"mesh\": \"ball\", \"surface\": \"clay\",\n              \"world_from_object\": {\"rotation\": "
      "[1, 0, 0, 0], \"translation_m\": [0.3, 0, 0.05]}",
      "\"mesh\": \"ball\", \"surface\": \"glass\"");
  expect_found(text, "/objects/1/priority", "\"thing\" and \"ball\" overlap", "\"thing\", fills the common part");
  std::string ranked = text;
  ranked.replace(ranked.find("\"mesh\": \"ball\", \"surface\""), 0, "\"priority\": 1, ");
  EXPECT_TRUE(check_scene(scene(ranked, false)).empty());
}

TEST_F(Checks, ImagesOfNothingAndInTheDark) {
  expect_found(with("[0, 1, 0, 0], \"translation_m\": [0, 0, 1]", "[1, 0, 0, 0], \"translation_m\": [0, 0, 1]"),
               "/images/0", "sees none of the objects", "empty picture");
  expect_found(
      with("{\"lamp\": {\"model\": \"sphere\", \"position_m\": [0, 0, 0.6], \"watt_per_sr\": 1, \"radius_m\": 0.01}}",
           "{}"),
      "/images/0/light", "no light is on", "black picture");
}

TEST_F(Checks, ImpossibleOpticsAreNamed) {
  EXPECT_THAT(refusal(with("\"eta\": 1.5", "\"eta\": 0")), HasSubstr("s.json#/surfaces/glass/eta"));
  EXPECT_THAT(refusal(with("\"eta\": 1.5", "\"eta\": 1.5, \"sigma_a_per_m\": [1, -2, 1]")),
              HasSubstr("s.json#/surfaces/glass/sigma_a_per_m"));
}

TEST_F(Checks, TrianglesWithoutAreaAreCountedAndNaNIsRefused) {
  io::TriangleMesh thin = tetrahedron();
  thin.triangles.push_back({0, 1, 1});
  mesh(thin);
  std::vector<std::string> heard;
  Reading reading;
  reading.on_warning = [&](const std::string& message) { heard.push_back(message); };
  build_scene(manifest::parse_document(good, "s.json", folder_.path()), reading);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_THAT(heard[0], HasSubstr("mesh.ply: 1 of 5 triangles have no area"));
  EXPECT_THAT(heard[0], HasSubstr("hole"));
}

}  // namespace
}  // namespace gonio::scene
