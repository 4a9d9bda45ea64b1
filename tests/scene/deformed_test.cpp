// Meshes on their way through their shapes, and scenes that hold them.
#include "scene/deformed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/scene.h"

namespace gonio::scene {
namespace {

io::TriangleMesh triangle(double height_m) {
  io::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, height_m}, {1, 0, height_m}, {0, 1, 2 * height_m}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

struct Sheet {
  tests::ScratchFolder folder;
  manifest::Document document;

  Sheet() {
    document.folder = folder.path();
    manifest::Mesh mesh;
    mesh.file = add("rest", triangle(7));
    for (int k = 0; k < 3; ++k) mesh.shapes.push_back(add("shape-" + std::to_string(k), triangle(k * k)));
    document.meshes["sheet"] = mesh;
    document.surfaces["paper"].parameters["albedo"] = 0.5;
    document.objects.push_back({.id = "thing", .mesh = "sheet", .surface = "paper", .world_from_object = {}});
  }
  std::string add(const std::string& id, const io::TriangleMesh& mesh) {
    io::write_ply(folder / (id + ".ply"), mesh);
    return manifest::add_file(document, folder / (id + ".ply"), id);
  }
  void seen(const std::string& image, double share) {
    manifest::ImageEntry entry;
    entry.id = image;
    entry.shapes["thing"] = share;
    document.images.push_back(entry);
  }
  double height_m(double share) const { return deformed_mesh(document, "sheet", share).positions_m[2].z; }
  std::string refusal(const std::string& image = "") const {
    try {
      Reading reading;
      reading.image = image;
      build_scene(document, reading);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
};

TEST(Deformed, VerticesGoStraightFromShapeToShape) {
  const Sheet sheet;
  EXPECT_DOUBLE_EQ(sheet.height_m(0), 0);
  EXPECT_DOUBLE_EQ(sheet.height_m(0.5), 2);
  EXPECT_DOUBLE_EQ(sheet.height_m(0.625), 2 + 0.25 * 6);
  EXPECT_DOUBLE_EQ(sheet.height_m(1), 8);
  Sheet rigid;
  rigid.document.meshes.at("sheet").shapes.clear();
  EXPECT_DOUBLE_EQ(rigid.height_m(0.5), 14);
}

TEST(Deformed, ASceneHasTheShapeOfItsImage) {
  Sheet sheet;
  sheet.seen("early", 0.25), sheet.seen("late", 1);
  EXPECT_EQ(deformation_of(sheet.document, "thing", "late"), 1);
  EXPECT_EQ(deformation_of(sheet.document, "another", "late"), 0);
  EXPECT_THAT(sheet.refusal(), testing::HasSubstr("/images/1/shapes/thing: is 1 where image early has 0.25"));
  sheet.document.images.clear();
  const Scene scene = build_scene(sheet.document);
  const auto& mesh = std::get<std::shared_ptr<const mesh::Mesh>>(scene.instances.front().shape);
  EXPECT_DOUBLE_EQ(mesh->positions_m[2].z, 0);
}

TEST(Deformed, RefusesWhatIsNoShapeOfTheMesh) {
  Sheet sheet;
  sheet.seen("a", 1.5);
  EXPECT_THAT(sheet.refusal(), testing::HasSubstr("is 1.5"));
  sheet.document.images.clear();
  io::TriangleMesh other = triangle(1);
  other.positions_m.push_back({1, 1, 1});
  sheet.document.meshes.at("sheet").shapes[0] = sheet.add("other", other);
  EXPECT_THAT(sheet.refusal(), testing::HasSubstr("has 4 vertices where the mesh has 3"));
}

}  // namespace
}  // namespace gonio::scene
