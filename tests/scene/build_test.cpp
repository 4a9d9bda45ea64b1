// From manifests to scenes: what is read, what is applied, what is refused and in which words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "scene/mechanisms.h"
#include "scene/scene.h"

namespace gonio::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string small_scene = R"({"gonio": 1,
 "cameras": {"c": {"model": "pinhole", "width_px": 8, "height_px": 6, "fx_px": 10, "fy_px": 10, "cx_px": 3.5, "cy_px": 2.5}},
 "meshes": {"ball": {"sphere": {"radius_m": 0.05}}, "table": {"plane": {"size_m": [1.2, 1.0]}}},
 "surfaces": {"clay": {"model": "diffuse", "albedo": 0.5}},
 "lights": {"a": {"model": "point", "position_m": [0, 0, 1], "watt_per_sr": 1},
            "b": {"model": "point", "position_m": [1, 0, 1], "watt_per_sr": [1, 2, 3]}},
 "objects": [{"id": "ball", "mesh": "ball", "surface": "clay",
              "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0.1, 0.2, 0.3]}},
             {"id": "table", "mesh": "table", "surface": "clay"}],
 "images": [{"id": "i", "camera": "c", "light": "b", "gain": 2}, {"id": "j", "camera": "c"}]})";

Scene scene_of(const std::string& text, const std::filesystem::path& folder = ".") {
  return build_scene(manifest::parse_document(text, "s.json", folder));
}
std::string with(const std::string& from, const std::string& to) {
  std::string text = small_scene;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
std::string problem_of(const std::string& text, const std::filesystem::path& folder = ".") {
  try {
    scene_of(text, folder);
  } catch (const Error& error) {
    EXPECT_TRUE(error.code() == Exit::data || error.code() == Exit::no_input);
    return error.what();
  }
  return "none";
}

TEST(Build, ASmallScene) {
  const Scene scene = scene_of(small_scene);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(std::get<Sphere>(scene.instances[0].shape).radius_m, 0.05);
  EXPECT_EQ(std::get<Plane>(scene.instances[1].shape).size_y_m, 1.0);
  EXPECT_NEAR(norm(scene.centre_m - Vec3{0.1, 0.2, 0.3}), 0, 1e-15);  // the table does not count
  EXPECT_THAT(scene.views[0].lights, ElementsAre(1u));
  EXPECT_THAT(scene.views[1].lights, ElementsAre(0u, 1u));
  EXPECT_EQ(scene.views[0].gain, (Rgb{2, 2, 2}));
  EXPECT_EQ(scene.appearance.indirect_strength, 1);
}

TEST(Build, MechanismsAreApplied) {
  const Scene scene = scene_of(with("\"gonio\": 1,", R"("gonio": 1, "mechanisms": {
    "surface.interface": {"f0": 0.04, "alpha": 0.1}, "light.finite-size": {"on": ["b"], "radius_m": 0.1},
    "transport.indirect": {"strength": 0}, "optics.vignetting": {"falloff": 0.2},
    "light.ambient": {"radiance_r": 0.1}, "lens.radial": {"k1": -0.2}},)"));
  EXPECT_EQ(scene.appearance.surfaces[0].model->info().id, "coated-diffuse");
  EXPECT_TRUE(scene.appearance.lights[0].emitter->sample({}, {}).delta);
  EXPECT_FALSE(scene.appearance.lights[1].emitter->sample({}, {}).delta);
  EXPECT_EQ(scene.appearance.indirect_strength, 0);
  EXPECT_EQ(scene.appearance.vignetting_falloff, 0.2);
  EXPECT_EQ(scene.appearance.ambient->hit({}, {0, 0, 1}).radiance, (Rgb{0.1, 0, 0}));
  const Vec2 corner = *scene.views[0].camera.project({-0.3, 0, 1});
  EXPECT_NEAR(corner.x, 3.5 - 3 * (1 - 0.2 * 0.09), 1e-12);
}

TEST(Build, TexturesAreBilinearAndLinear) {
  const tests::ScratchFolder folder;
  io::Image texture(2, 1, {"R", "G", "B"});
  texture.data = {0.2f, 0.2f, 0.2f, 0.6f, 0.4f, 0.2f};
  io::write_picture(folder / "t.exr", texture);
  const std::string text =
      with(R"({"model": "diffuse", "albedo": 0.5})", R"({"model": "diffuse", "textures": {"albedo": "t"}})");
  const std::string with_file =
      std::string(text).replace(text.find("\"cameras\""), 0, R"("files": {"t": {"path": "t.exr"}}, )");
  const Scene scene = scene_of(with_file, folder.path());
  const Surface& clay = scene.appearance.surfaces[0];
  EXPECT_NEAR(clay.values_at({.uv = {0.25, 0.5}}).rgb(0).x, 0.2, 1e-6);
  EXPECT_NEAR(clay.values_at({.uv = {0.75, 0.5}}).rgb(0).x, 0.6, 1e-6);
  EXPECT_NEAR(clay.values_at({.uv = {0.5, 0.3}}).rgb(0).y, 0.3, 1e-6);
}

TEST(Build, TellsWhichFilesItReads) {
  const tests::ScratchFolder folder;
  io::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  io::write_ply(folder / "m.ply", mesh);
  std::string text = with(R"({"sphere": {"radius_m": 0.05}})", R"({"file": "m"})");
  text.replace(text.find("\"cameras\""), 0, R"("files": {"m": {"path": "m.ply"}}, )");
  std::vector<std::string> names;
  build_scene(manifest::parse_document(text, "s.json", folder.path()),
              {.on_file = [&](const std::filesystem::path& path) { names.push_back(path.filename().string()); }});
  EXPECT_THAT(names, ElementsAre("m.ply"));
  mesh.triangles = {{0, 0, 1}};
  io::write_ply(folder / "m.ply", mesh);
  EXPECT_THAT(problem_of(text, folder.path()), HasSubstr("zero area"));
  std::filesystem::remove(folder / "m.ply");
  EXPECT_THAT(problem_of(text, folder.path()), HasSubstr("s.json#/files/m"));
}

TEST(Build, RefusesInWords) {
  EXPECT_THAT(problem_of(with("0.05", "-0.05")), HasSubstr("s.json#/meshes/ball"));
  EXPECT_THAT(problem_of(with("[1.2, 1.0]", "[1.2, 0]")), HasSubstr("s.json#/meshes/table"));
  EXPECT_THAT(problem_of(with("\"albedo\": 0.5", "\"albedo\": 1.5")), HasSubstr("s.json#/surfaces/clay/albedo"));
  EXPECT_THAT(problem_of(with("\"rotation\": [1, 0, 0, 0]", "\"rotation\": [2, 0, 0, 0]")),
              HasSubstr("s.json#/objects/0"));
  manifest::Document document = manifest::parse_document(small_scene, "s.json", ".");
  document.objects.clear();
  EXPECT_THROW(build_scene(document), Error);
  document = manifest::parse_document(small_scene, "s.json", ".");
  document.objects[0].world_from_object->translation_m.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(build_scene(document), Error);
}

TEST(Vignetting, IsExactlyOneAtNeutral) {
  EXPECT_EQ(vignetting(0, 640, 480, {0, 0}), 1);
  EXPECT_NEAR(vignetting(0.2, 641, 481, {0, 240}), 1 - 0.2 * (320.0 * 320.0) / (320.5 * 320.5), 1e-15);
  EXPECT_EQ(vignetting(5, 640, 480, {0, 0}), 0);
}

TEST(ParseMechanism, TakesUnitsAndNames) {
  const auto [mechanism, use] = parse_mechanism("light.finite-size:radius_m=35mm,on=a,on=b", "--with");
  EXPECT_EQ(mechanism->id, "light.finite-size");
  EXPECT_NEAR(use.parameters.at("radius_m").scalar(), 0.035, 1e-15);
  EXPECT_THAT(use.on, ElementsAre("a", "b"));
  EXPECT_EQ(parse_mechanism("surface.interface:f0=4%", "--with").second.parameters.at("f0").scalar(), 0.04);
  EXPECT_THROW(parse_mechanism("surface.interface:f0", "--with"), Error);
  EXPECT_THROW(parse_mechanism("nothing", "--with"), Error);
}

}  // namespace
}  // namespace gonio::scene
