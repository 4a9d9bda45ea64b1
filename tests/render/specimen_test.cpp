// Built-in scenes are sound, and the virtual sensor's noise is what the manifest says it is.
#include "render/specimen.h"

#include <gtest/gtest.h>

#include <map>

#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/object.h"
#include "render/preview.h"
#include "render/specimen_glass.h"
#include "render/virtual_sensor.h"
#include "scene/scene.h"

namespace gonio::render {
namespace {

TEST(Specimen, EveryOneBuildsAScene) {
  const tests::ScratchFolder folder;
  for (const Specimen& s : specimens()) {
    manifest::Document document = specimen(s.name, folder.path());
    document.allow_outside = true;  // the mesh lies in the scratch folder
    const scene::Scene scene = scene::build_scene(document);
    const std::map<std::string, std::size_t> views = {{"board", 12}, {"glass", 2},   {"goniometer", 63},
                                                      {"arc", 2783}, {"matrix", 10}, {"mirror-ball", 3}};
    EXPECT_EQ(scene.views.size(), views.contains(s.name) ? views.at(s.name) : 9u);
    for (const scene::View& view : scene.views) {
      Vec3 target_m = scene.centre_m;
      if (s.name == "matrix")
        target_m = document.objects[&view - scene.views.data() < 5 ? 0 : 1].world_from_object->translation_m;
      const auto pixel = view.camera.project(inverse(view.world_from_camera) * target_m);
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x, 0.5 * view.camera.width_px(), 0.2 * view.camera.width_px());
      EXPECT_NEAR(pixel->y, 0.5 * view.camera.height_px(), 0.2 * view.camera.height_px());
    }
  }
}

// Every edge once in each direction, the volume positive: closed, and looking outwards.
double volume_of_closed(const io::TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
    volume += dot(mesh.positions_m[t[0]], cross(mesh.positions_m[t[1]], mesh.positions_m[t[2]])) / 6;
  }
  for (const auto& [edge, count] : edges)
    if (count != 1 || !edges.contains({edge.second, edge.first})) return -1;
  return volume;
}
double lowest_of(const io::TriangleMesh& mesh) {
  double lowest = 1;
  for (const Vec3 p : mesh.positions_m) lowest = std::min(lowest, p.z);
  return lowest;
}

TEST(Specimen, TheKnotIsAClosedTubeThatRestsOnTheTable) {
  const tests::ScratchFolder folder;
  specimen("knot", folder.path());
  const io::TriangleMesh mesh = io::read_ply(folder / "knot.ply");
  EXPECT_GT(volume_of_closed(mesh), 0);
  EXPECT_NEAR(lowest_of(mesh), -0.029, 2e-4);  // its object's pose lifts it by 29 mm
}

// A cut half ball, less a half ellipsoid, and a rim: half of a ring (Pappus). 96 sectors are 0.2 % short of round.
TEST(Specimen, TheBowlIsClosedAndHoldsGlass) {
  const double r = 0.06, wall = 0.005, lift = r * std::sqrt(1 - 0.45 * 0.45), inner = r - wall;
  const double outside = pi * (r * r * lift - lift * lift * lift / 3);
  const double inside = 2.0 / 3 * pi * inner * inner * (lift - wall);
  const double rim = pi * wall * wall / 8 * 2 * pi * (r - wall / 2);
  const io::TriangleMesh mesh = bowl(r, wall, 96);
  EXPECT_NEAR(volume_of_closed(mesh) / (outside - inside + rim), 1, 0.01);
  EXPECT_NEAR(lowest_of(mesh), 0, 1e-12);
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions_m[t[0]], b = mesh.positions_m[t[1]], c = mesh.positions_m[t[2]];
    EXPECT_GT(norm(cross(b - a, c - a)), 0);
    const Vec3 n = normalized(cross(b - a, c - a));
    for (const std::uint32_t v : t) EXPECT_GT(dot(n, mesh.normals[v]), 0);
  }
}

// 40000 readings per level: relative standard deviation of the variance 0.7 %, limit 4 of them; mean within 4.5
// standard errors.
TEST(VirtualSensor, MeanAndVarianceAreAsStated) {
  const manifest::Noise noise{.gain = 100, .read = 0.02};
  for (const float level : {0.0f, 0.1f, 0.9f, 20.0f}) {
    io::Image flat(200, 200, {"R", "G", "B"});
    std::fill(flat.data.begin(), flat.data.end(), level);
    const io::Image image = recorded(flat, noise, "flat", 3);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < image.data.size(); i += 3) {
      sum += image.data[i];
      squares += image.data[i] * image.data[i];
    }
    const double mean = sum / 40000, variance = squares / 40000 - mean * mean, stated = level / 100 + 0.0004;
    EXPECT_NEAR(mean, level, 4.5 * std::sqrt(stated / 40000));
    EXPECT_NEAR(variance, stated, 0.03 * stated);
  }
}

TEST(VirtualSensor, ImagesHaveNoiseOfTheirOwn) {
  const io::Image flat(4, 4, {"R", "G", "B"});
  const manifest::Noise noise{.gain = 100, .read = 0.02};
  EXPECT_EQ(recorded(flat, noise, "a", 1).data, recorded(flat, noise, "a", 1).data);
  EXPECT_NE(recorded(flat, noise, "a", 1).data, recorded(flat, noise, "b", 1).data);
  EXPECT_NE(recorded(flat, noise, "a", 1).data, recorded(flat, noise, "a", 2).data);
}

TEST(Preview, WhiteIsThe99thPercentile) {
  io::Image ramp(100, 10, {"R", "G", "B", "variance.R"});
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 100; ++x) ramp.at(x, y, 1) = static_cast<float>(7 * x);
  const io::Image image = preview(ramp);
  EXPECT_EQ(image.at(0, 0, 1), 0);
  EXPECT_EQ(image.at(99, 0, 1), 1);
  EXPECT_LT(image.at(90, 0, 1), 1);
  EXPECT_EQ(image.at(50, 0, 0), 0);
}

}  // namespace
}  // namespace gonio::render
