// Bad scenes, each found and named with what the picture will show because of it; a good one has no findings.
#include "scene/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "good_scene.h"
#include "io/ply.h"
#include "manifest/document.h"

namespace gonio::scene {
namespace {

using testing::HasSubstr;

class Checks : public testing::Test {
 protected:
  Checks() { io::write_ply(folder_ / "mesh.ply", tests::tetrahedron()); }
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
  tests::ScratchFolder folder_;
};

TEST_F(Checks, AGoodSceneHasNone) {
  EXPECT_EQ(refusal(tests::good_scene), "none");
  EXPECT_TRUE(check_scene(scene(tests::good_scene, false)).empty());
}

TEST_F(Checks, AnOpenMeshAsGlassIsRefusedUnlessAllowed) {
  io::TriangleMesh open = tests::tetrahedron();
  open.triangles.pop_back();
  mesh(open);
  const std::string words = refusal(tests::good_scene);
  EXPECT_THAT(words, HasSubstr("s.json#/objects/0: the mesh of \"thing\" has 3 open edges around 1 hole"));
  EXPECT_THAT(words, HasSubstr("light that enters never leaves"));
  EXPECT_THAT(words, HasSubstr("--allow-open"));
  expect_found(tests::good_scene, "/objects/0", "3 open edges", "absorbed inside is wrong");
  EXPECT_EQ(refusal(tests::good_scene_with("\"surface\": \"glass\"", "\"surface\": \"clay\"")),
            "none");  // a shell of clay may be open
}

TEST_F(Checks, APlaneBoundsNothing) {
  const std::string text = tests::good_scene_with("\"mesh\": \"table\", \"surface\": \"clay\"",
                                                  "\"mesh\": \"table\", \"surface\": \"glass\"");
  EXPECT_THAT(refusal(text), HasSubstr("\"table\" is a plane, and bounds a medium"));
  expect_found(text, "/objects/2", "plane", "never leaves");
}

TEST_F(Checks, AMeshThatFacesInwards) {
  io::TriangleMesh turned = tests::tetrahedron();
  for (auto& t : turned.triangles) std::swap(t[1], t[2]);
  mesh(turned);
  EXPECT_EQ(refusal(tests::good_scene), "none");
  expect_found(tests::good_scene, "/objects/0", "faces inwards", "a cavity in glass");
}

TEST_F(Checks, ATriangleTurnedRound) {
  io::TriangleMesh turned = tests::tetrahedron();
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  mesh(turned);
  EXPECT_THAT(refusal(tests::good_scene), HasSubstr("3 edges whose triangles face opposite ways"));
  expect_found(tests::good_scene, "/objects/0", "face opposite ways", "inside and outside change places");
}

TEST_F(Checks, AWallWithinTheGlass) {
  io::TriangleMesh walled = tests::tetrahedron();
  walled.triangles.push_back({0, 1, 2});
  walled.triangles.push_back({0, 2, 1});
  mesh(walled);
  expect_found(tests::good_scene, "/objects/0", "more than two triangles meet at 3 edges", "interfaces of the medium");
}

TEST_F(Checks, NormalsAgainstTheTriangles) {
  io::TriangleMesh wrong = tests::tetrahedron();
  for (const Vec3 p : wrong.positions_m) wrong.normals.push_back(normalized(Vec3{0, 0, 0.07} - p));
  mesh(wrong);
  expect_found(tests::good_scene, "/objects/0", "point against 4 of its 4 triangles", "turned inside out");
}

TEST_F(Checks, LightsAndCamerasInsideOfThings) {
  expect_found(tests::good_scene_with("[0, 0, 0.6]", "[0, 0, 0.1]"), "/lights/lamp", "stands inside \"thing\"",
               "caustic");
  expect_found(tests::good_scene_with("[0, 0, 0.6]", "[0.3, 0, 0.05]"), "/lights/lamp", "stands inside \"ball\"",
               "hidden");
  expect_found(tests::good_scene_with("[0, 0, 0.6]", "[0.3, 0, 0.105]"), "/lights/lamp",
               "the ball of 0.01 m of the light \"lamp\" meets \"ball\"", "within the object");
  expect_found(tests::good_scene_with("[0, 1, 0, 0], \"translation_m\": [0, 0, 1]",
                                      "[0, 1, 0, 0], \"translation_m\": [0.3, 0, 0.06]"),
               "/images/0/world_from_camera", "stands inside \"ball\"", "sees the inside");
}

TEST_F(Checks, OverlappingMediaOfEqualPriority) {
  const std::string text = tests::good_scene_with(
      "\"mesh\": \"ball\", \"surface\": \"clay\",\n              \"world_from_object\": {\"rotation\": "
      "[1, 0, 0, 0], \"translation_m\": [0.3, 0, 0.05]}",
      "\"mesh\": \"ball\", \"surface\": \"glass\"");
  expect_found(text, "/objects/1/priority", "\"thing\" and \"ball\" overlap", "\"thing\", fills the common part");
  std::string ranked = text;
  ranked.replace(ranked.find("\"mesh\": \"ball\", \"surface\""), 0, "\"priority\": 1, ");
  EXPECT_TRUE(check_scene(scene(ranked, false)).empty());
}

TEST_F(Checks, ImagesOfNothingAndInTheDark) {
  expect_found(tests::good_scene_with("[0, 1, 0, 0], \"translation_m\": [0, 0, 1]",
                                      "[1, 0, 0, 0], \"translation_m\": [0, 0, 1]"),
               "/images/0", "sees none of the objects", "empty picture");
  expect_found(
      tests::good_scene_with(
          "{\"lamp\": {\"model\": \"sphere\", \"position_m\": [0, 0, 0.6], \"watt_per_sr\": 1, \"radius_m\": 0.01}}",
          "{}"),
      "/images/0/light", "no light is on", "black picture");
}

TEST_F(Checks, ImpossibleOpticsAreNamed) {
  EXPECT_THAT(refusal(tests::good_scene_with("\"eta\": 1.5", "\"eta\": 0")), HasSubstr("s.json#/surfaces/glass/eta"));
  EXPECT_THAT(refusal(tests::good_scene_with("\"eta\": 1.5", "\"eta\": 1.5, \"sigma_a_per_m\": [1, -2, 1]")),
              HasSubstr("s.json#/surfaces/glass/sigma_a_per_m"));
}

TEST_F(Checks, TrianglesWithoutAreaAreCountedAndNaNIsRefused) {
  io::TriangleMesh thin = tests::tetrahedron();
  thin.triangles.push_back({0, 1, 1});
  mesh(thin);
  std::vector<std::string> heard;
  Reading reading;
  reading.on_warning = [&](const std::string& message) { heard.push_back(message); };
  build_scene(manifest::parse_document(tests::good_scene, "s.json", folder_.path()), reading);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_THAT(heard[0], HasSubstr("mesh.ply: 1 of 5 triangles have no area"));
  EXPECT_THAT(heard[0], HasSubstr("hole"));
}

}  // namespace
}  // namespace gonio::scene
