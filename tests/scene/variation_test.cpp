// Parameters per vertex, per face label and by laws: from the manifest to the value at a point, and what is refused.
#include "scene/variation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "data.h"
#include "manifest/document.h"

namespace gonio::scene {
namespace {

using testing::HasSubstr;

// A unit square of two triangles with properties and labels, and a sphere.
struct Stage {
  Stage() {
    mesh.positions_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.properties = {{0.1f, 0.2f, 0.4f, 0.8f}, {1, 0.5f, 0, 0}, {0, 0.5f, 1, 0}, {0.25f, 0.25f, 0.25f, 1}};
    mesh.labels = {3, -1};
  }
  Scene build(const std::string& clay, const std::string& shape = "square", const std::string& more = "") const {
    io::write_ply(folder / "m.ply", mesh, {.properties = {"wear", "paint_r", "paint_g", "paint_b"}});
    const std::string text = R"({"gonio": 1, "files": {"m": {"path": "m.ply"}}, )"
                             R"("meshes": {"square": {"file": "m"}, "ball": {"sphere": {"radius_m": 0.5}}}, )"
                             R"("surfaces": {"clay": )" +
                             clay + R"(}, )" + more + R"("objects": [{"id": "o", "mesh": ")" + shape +
                             R"(", "surface": "clay"}]})";
    return build_scene(manifest::parse_document(text, "s.json", folder.path()));
  }
  std::string problem(const std::string& clay, const std::string& shape = "square") const {
    try {
      build(clay, shape);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "none";
  }
  static const mesh::Mesh* mesh_of(const Scene& scene) {
    return std::get<std::shared_ptr<const mesh::Mesh>>(scene.instances[0].shape).get();
  }
  tests::ScratchFolder folder;
  io::TriangleMesh mesh;
};

TEST(PerVertex, InterpolatesOverTheTriangle) {
  const Stage stage;
  const Scene scene = stage.build(R"({"model": "coated-diffuse", "albedo": 0.5, "vertices": {"alpha": "wear"}})");
  const Surface& clay = scene.appearance.surfaces[0];
  EXPECT_TRUE(clay.varies());
  const auto at = [&](std::uint32_t triangle, double b1, double b2) {
    return clay.values_at({.mesh = Stage::mesh_of(scene), .triangle = triangle, .b1 = b1, .b2 = b2}).scalar(3);
  };
  EXPECT_NEAR(at(0, 0, 0), 0.1, 1e-7);
  EXPECT_NEAR(at(0, 1, 0), 0.2, 1e-7);
  EXPECT_NEAR(at(1, 0, 1), 0.8, 1e-7);
  EXPECT_NEAR(at(1, 0.25, 0.25), 0.5 * 0.1 + 0.25 * 0.4 + 0.25 * 0.8, 1e-7);
  EXPECT_EQ(clay.values_at({.mesh = Stage::mesh_of(scene)}).rgb(0), (Rgb{0.5, 0.5, 0.5}));
  EXPECT_TRUE(Stage::mesh_of(scene)->labels.empty());  // nobody asked for them
}

TEST(PerVertex, ColoursTakeThreePropertiesOrOne) {
  const Stage stage;
  const Scene three = stage.build(R"({"model": "diffuse", "vertices": {"albedo": "paint"}})");
  const Rgb paint = three.appearance.surfaces[0]
                        .values_at({.mesh = Stage::mesh_of(three), .triangle = 0, .b1 = 0.5, .b2 = 0.25})
                        .rgb(0);
  EXPECT_NEAR(norm(paint - Rgb{0.5, 0.5, 0.25}), 0, 1e-7);
  const Scene one = stage.build(R"({"model": "diffuse", "vertices": {"albedo": "wear"}})");
  EXPECT_NEAR(one.appearance.surfaces[0].values_at({.mesh = Stage::mesh_of(one), .b1 = 1}).rgb(0).z, 0.2, 1e-7);
}

TEST(PerLabel, TakesTheFacesValue) {
  const Stage stage;
  const Scene scene = stage.build(R"({"model": "diffuse", "labels": {"albedo": {"3": [0.1, 0.2, 0.3], "-1": 0.7}}})");
  const Surface& clay = scene.appearance.surfaces[0];
  EXPECT_EQ(clay.values_at({.mesh = Stage::mesh_of(scene), .triangle = 0}).rgb(0), (Rgb{0.1, 0.2, 0.3}));
  EXPECT_EQ(clay.values_at({.mesh = Stage::mesh_of(scene), .triangle = 1}).rgb(0), (Rgb{0.7, 0.7, 0.7}));
  const Surface copy = clay;  // as simulations of "what if" do; the rules are shared
  EXPECT_EQ(copy.varying[0].rule, clay.varying[0].rule);
}

TEST(ByLaw, FollowsNormalAndHeight) {
  const Stage stage;
  const Scene scene = stage.build(R"({"model": "coated-diffuse", "albedo": 0.5, "laws": {
    "alpha": {"law": "print-normal", "rho": 0.1, "s": 2},
    "sigma_rad": {"law": "print-layers", "alpha_even": 0.2, "alpha_odd": 0.4, "layer_m": 0.1}}})");
  const Surface& clay = scene.appearance.surfaces[0];
  const double h = std::sqrt(0.5);
  const auto values = clay.values_at({.position_m = {0, 0, 0.15}, .normal = {0, h, h}});
  EXPECT_NEAR(values.scalar(3), 0.55, 1e-12);
  EXPECT_NEAR(values.scalar(1), 0.4, 1e-12);
  // rho = 0 on walls: below what alpha may be, and kept at its lower bound.
  const Scene bare = stage.build(R"({"model": "coated-diffuse", "albedo": 0.5,
    "laws": {"alpha": {"law": "print-normal", "rho": 0, "s": 2}}})");
  const auto& info = bare.appearance.surfaces[0].model->info().parameters[3];
  EXPECT_EQ(bare.appearance.surfaces[0].values_at({.normal = {1, 0, 0}}).scalar(3), info.lower);
}

TEST(ByLaw, KnowsTheCurvatureOfSpheresAndMeshes) {
  const Stage stage;
  const std::string polished = R"({"model": "coated-diffuse", "albedo": 0.5,
    "laws": {"alpha": {"law": "polish-curvature", "rho": 0.2, "s": 5, "curvature_per_m": 2}}})";
  const Scene ball = stage.build(polished, "ball");  // 1 / 0.5 m
  EXPECT_NEAR(ball.appearance.surfaces[0].values_at({.position_m = {0, 0.3, 0.4}, .normal = {0, 0.6, 0.8}}).scalar(3),
              0.6, 1e-12);
  const Scene square = stage.build(polished);
  EXPECT_EQ(Stage::mesh_of(square)->mean_curvature_per_m.size(), 4u);
  EXPECT_NEAR(square.appearance.surfaces[0].values_at({.mesh = Stage::mesh_of(square)}).scalar(3),
              0.2 + 0.8 / (1 + std::exp(5.0)), 1e-9);
  EXPECT_TRUE(Stage::mesh_of(stage.build(R"({"model": "diffuse", "albedo": 1})"))->mean_curvature_per_m.empty());
}

TEST(Variation, SurvivesAMechanismThatChangesTheModel) {
  const Stage stage;
  const Scene scene = stage.build(R"({"model": "diffuse", "vertices": {"albedo": "wear"}})", "square",
                                  R"("mechanisms": {"surface.interface": {"f0": 0.04, "alpha": 0.1}}, )");
  const Surface& clay = scene.appearance.surfaces[0];
  EXPECT_EQ(clay.model->info().id, "coated-diffuse");
  EXPECT_NEAR(clay.values_at({.mesh = Stage::mesh_of(scene), .b1 = 1}).rgb(0).x, 0.2, 1e-7);
}

TEST(Variation, RefusesInWords) {
  Stage stage;
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "vertices": {"albedo": "rust"}})"),
              HasSubstr("s.json#/objects/0: the mesh's vertices have no property \"rust\" (nor rust_r"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "vertices": {"albedo": "wear"}})", "ball"),
              HasSubstr("spheres and planes do not have"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "vertices": {"albedo": "wear"}, "labels": {"albedo": {"3": 1}}})"),
              HasSubstr("s.json#/surfaces/clay/labels/albedo: albedo varies in two ways"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "vertices": {"colour": "wear"}, "albedo": 1})"),
              HasSubstr("s.json#/surfaces/clay/vertices/colour"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "labels": {"albedo": {"3": 1}}})"),
              HasSubstr("label -1 of triangle 1 has no value for albedo"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "labels": {"albedo": {"3": 1.5, "-1": 0}}})"),
              HasSubstr("s.json#/surfaces/clay/labels/albedo/3"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "labels": {"albedo": {"red": 1}}})"), HasSubstr("is no integer"));
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "laws": {"albedo": {"law": "print-normal", "rho": 0.1, "s": 1}}})"),
              HasSubstr("laws govern single numbers"));
  stage.mesh.properties[0][2] = 7;
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "vertices": {"albedo": "wear"}})"),
              HasSubstr("wear of vertex 2 is 7, outside 0 to 1"));
  stage.mesh.labels.clear();
  EXPECT_THAT(stage.problem(R"({"model": "diffuse", "labels": {"albedo": {"3": 1}}})"),
              HasSubstr("faces have no property \"label\""));
}

}  // namespace
}  // namespace gonio::scene
