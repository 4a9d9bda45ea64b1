// Ties broken by photographs: a wedge whose markers form a square stands in one of four ways, of which its shape
// photographs differently; a cube stands in none that can be told.
#include "reassembly/tie_break.h"

#include <gtest/gtest.h>

#include "data.h"
#include "geom/angle.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/entries.h"
#include "render/looking_at.h"
#include "render/session.h"

namespace gonio::reassembly {
namespace {

// A block of which the top leans: `drop` of its height is missing at +x.
io::TriangleMesh block(double drop) {
  io::TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    const double x = k & 1 ? 0.03 : -0.03, y = k & 2 ? 0.03 : -0.03;
    mesh.positions_m.push_back({x, y, k & 4 ? (k & 1 ? 0.04 * (1 - drop) : 0.04) : 0});
  }
  for (const auto& q : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}}) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

manifest::Document scene(const std::filesystem::path& folder, double drop) {
  manifest::Document d;
  d.folder = folder;
  manifest::Camera camera;
  camera.width_px = 160, camera.height_px = 120;
  camera.fx_px = camera.fy_px = 240.0;
  camera.cx_px = 79.5, camera.cy_px = 59.5;
  d.cameras["c"] = camera;
  for (const double azimuth : {20.0, 110.0}) {
    manifest::PlannedImage image;
    image.id = "v" + std::to_string(static_cast<int>(azimuth)), image.camera = "c";
    const double a = azimuth * degree;
    static_cast<Rigid<frame::World, frame::Camera>&>(image.world_from_camera) =
        render::looking_at({0.3 * std::cos(a), 0.3 * std::sin(a), 0.15}, {0, 0, 0.02});
    manifest::enter_image(d, image);
  }
  manifest::Light lamp;
  lamp.model = "point";
  lamp.parameters["position_m"] = manifest::Parameter(std::vector<double>{0.4, -0.3, 0.6});
  lamp.parameters["watt_per_sr"] = manifest::Parameter(std::vector<double>{1, 1, 1});
  d.lights["lamp"] = lamp;
  manifest::Surface grey;
  grey.parameters["albedo"] = manifest::Parameter(std::vector<double>{0.5, 0.5, 0.5});
  d.surfaces["grey"] = grey;
  io::write_ply(folder / "block.ply", block(drop));
  d.meshes["block"].file = manifest::add_file(d, folder / "block.ply", "block");
  d.meshes["block"].normals = "flat";
  manifest::Object object{.id = "block", .mesh = "block", .surface = "grey", .world_from_object = {}};
  object.world_from_object.emplace();
  d.objects.push_back(object);
  render::SessionOptions options;
  options.spp = 16, options.seed = 7, options.geometry = false, options.force = true;
  const render::Session session(d, options, [](const std::filesystem::path&) {});
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    const auto path = folder / (d.images[i].id + ".exr");
    io::write_picture(path, session.render(i, path).picture);
    render::enter_recording(d, i, path);
  }
  return d;
}

std::vector<Candidate> quarter_turns() {
  std::vector<Candidate> all;
  for (int k = 0; k < 4; ++k) {
    Candidate c;
    c.world_from_object.rotation = quaternion_of_rotation_vector({0, 0, ((k + 1) % 4) * pi / 2});
    all.push_back(c);
  }
  return all;  // the true one is the last
}

TEST(TieBreak, AShapeThatLooksOtherwiseDecides) {
  const tests::ScratchFolder folder;
  const auto document = scene(folder.path(), 0.5);
  const auto candidates = quarter_turns();
  const Tie tie = break_tie(document, "block", candidates, {.spp = 16, .folder = folder.path()});
  ASSERT_TRUE(tie.meant.has_value()) << tie.words;
  EXPECT_EQ(*tie.meant, 3U) << tie.words;
  manifest::Document dark = document;
  dark.lights.clear();
  EXPECT_FALSE(break_tie(dark, "block", candidates, {.folder = folder.path()}).meant.has_value());
}

TEST(TieBreak, AShapeThatLooksTheSameDoesNot) {
  const tests::ScratchFolder folder;
  const Tie tie = break_tie(scene(folder.path(), 0), "block", quarter_turns(), {.spp = 16, .folder = folder.path()});
  EXPECT_FALSE(tie.meant.has_value()) << tie.words;
}

}  // namespace
}  // namespace gonio::reassembly
