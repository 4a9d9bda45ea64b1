// ct-mesh-clean as a person runs it: what it writes, what the next programs make of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/volume.h"
#include "process.h"
#include "tools/ct_mesh_clean/shapes.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

// A hollow glass sphere of radius 20 voxels with walls of 4, and three markers of radius 4 glued to it.
io::VolumeData ornament(double noise = 60) {
  const Vec3 middle{31.5, 31.5, 31.5};
  std::vector<Shape> shapes{shell(middle, 16, 20, 2100)};
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 0.8, 0.6}, Vec3{-0.6, 0, -0.8}})
    shapes.push_back(ball(middle + d * 23.5, 4, 4100));
  return volume_of(64, shapes, noise, 7);
}

const manifest::VolumeStep& step_of(const manifest::Document& d, const std::string& name) {
  for (const manifest::VolumeStep& s : d.volumes.begin()->second.steps)
    if (s.name == name) return s;
  throw std::runtime_error("no step " + name);
}

TEST(CtMeshClean, MakesASoundMeshFindsTheMarkersAndEntersThePieceAsGlass) {
  const ScratchFolder folder;
  io::write_nrrd(folder / "ornament.nrrd", ornament());
  const Ended ended = run({"ct-mesh-clean", "--markers", "0.8mm", "--out", "o", "ornament.nrrd"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = manifest::parse_document(ended.out, "stdout", folder.path());
  const manifest::Volume& volume = d.volumes.at("ornament");
  EXPECT_EQ(volume.size, (std::vector<std::int64_t>{64, 64, 64}));
  EXPECT_EQ(volume.sound, true);
  EXPECT_EQ(d.objects.at(0).surface, "glass");
  EXPECT_EQ(d.surfaces.at("glass").model, "dielectric");
  ASSERT_EQ(d.markers.size(), 3u);
  for (const manifest::Marker& m : d.markers) {
    const Vec3 centre{m.centre_m[0], m.centre_m[1], m.centre_m[2]};
    EXPECT_NEAR(norm(centre - Vec3{3.15e-3, 3.15e-3, 3.15e-3}), 23.5e-4, 1e-5);
    EXPECT_EQ(m.covariance_m2.size(), 9u);
  }
  const manifest::VolumeStep& verdict = step_of(d, "verdict");
  EXPECT_EQ(verdict.figures.at("components"), 2);  // the wall's two sides
  EXPECT_EQ(verdict.figures.at("self_intersections"), 0);
  EXPECT_LT(verdict.figures.at("distance_rms_m"), 0.3e-4);
  // Outside of the caps that the markers covered, vertices lie on the two spheres.
  const io::TriangleMesh mesh = io::read_ply(manifest::resolve(d, d.meshes.at("ornament").file, ""));
  double worst = 0;
  std::size_t counted = 0;
  for (const Vec3& p : mesh.positions_m) {
    const Vec3 v = p * 1e4 - Vec3{31.5, 31.5, 31.5};
    bool near = false;
    for (const manifest::Marker& m : d.markers)
      near = near || norm(p - Vec3{m.centre_m[0], m.centre_m[1], m.centre_m[2]}) < 9e-4;
    if (near) continue;
    ++counted;
    worst = std::max(worst, std::min(std::abs(norm(v) - 20), std::abs(norm(v) - 16)));
  }
  EXPECT_GT(counted, 1000u);
  EXPECT_LT(worst, 0.5);
  for (const char* file : {"ornament.ply", "ornament-markers.ply", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(folder / "o" / file)) << file;
  EXPECT_THAT(read_file(folder / "o/report.html"), HasSubstr("The mesh is sound"));
}

TEST(CtMeshClean, WhatItMakesPassesSceneCheckAndRendersWithStokesVectors) {
  const ScratchFolder folder;
  io::write_nrrd(folder / "ball.nrrd", volume_of(40, {ball({19.5, 19.5, 19.5}, 12, 2100)}, 40, 3));
  write_file(folder / "scene.json", R"({"gonio": 1,
 "cameras": {"c": {"width_px": 24, "height_px": 24, "fx_px": 60, "fy_px": 60, "cx_px": 11.5, "cy_px": 11.5}},
 "lights": {"room": {"model": "uniform", "radiance": 1}},
 "images": [{"id": "v", "camera": "c", "world_from_camera":
   {"matrix": [[1, 0, 0, 0.002], [0, 1, 0, 0.002], [0, 0, 1, -0.006], [0, 0, 0, 1]]}}]})");
  const Ended made = run({"ct-mesh-clean", "-i", "scene.json", "--out", "o", "ball.nrrd"}, folder.path());
  ASSERT_EQ(made.status, 0) << made.err;
  const Ended checked = run({"scene", "check"}, folder.path(), made.out);
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_EQ(checked.err, "");
  const Ended rendered = run({"render", "--stokes", "--spp", "4", "--out", "r"}, folder.path(), made.out);
  EXPECT_EQ(rendered.status, 0) << rendered.err;
}

TEST(CtMeshClean, AComponentOfTheTableGoesAndAnEnclosedOneGoesOnRequest) {
  const ScratchFolder folder;
  const Vec3 middle{23.5, 23.5, 27.5};
  io::write_nrrd(
      folder / "pot.nrrd",
      volume_of(48, {shell(middle, 11, 15, 2100), ball(middle, 4, 2100), {[](Vec3 p) { return p.z - 3; }, 1900}}, 40,
                5));
  std::string said, verdict;
  const auto voxels = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"ct-mesh-clean", "--clean", "none", "--out", "o", "--force"});
    words.push_back("pot.nrrd");
    const Ended ended = run(words, folder.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    const manifest::Document d = manifest::parse_document(ended.out, "stdout", folder.path());
    said = ended.err, verdict = step_of(d, "verdict").how;
    return step_of(d, "components").figures;
  };
  EXPECT_EQ(voxels({"--largest", "0"}).at("kept"), 3);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_THAT(said, HasSubstr("pot.nrrd: its border cuts 1 of the 3 components that stay"));
  EXPECT_THAT(verdict, HasSubstr("the volume's border cuts the object"));
  EXPECT_EQ(voxels({"--largest", "0", "--drop-cut"}).at("kept"), 2);
  EXPECT_EQ(said, "");
  EXPECT_THAT(verdict, testing::Not(HasSubstr("border")));
  EXPECT_EQ(voxels({"--largest", "0", "--drop-cut", "--drop-enclosed"}).at("kept"), 1);
}

TEST(CtMeshClean, ALimitThatIsMissedIsExitTwoAndEverythingIsWritten) {
  const ScratchFolder folder;
  io::write_nrrd(folder / "ball.nrrd", volume_of(32, {ball({15.5, 15.5, 15.5}, 10, 2100)}, 60, 9));
  const Ended ended = run({"ct-mesh-clean", "--limit-bend", "0.0001deg", "--out", "o", "ball.nrrd"}, folder.path());
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "o/ball.ply"));
  EXPECT_THAT(ended.out, HasSubstr("rays are bent wrongly"));
  EXPECT_THAT(ended.err, HasSubstr("ball.nrrd: closed, 2-manifold"));  // nobody is left to guess
  EXPECT_THAT(ended.err, HasSubstr("rays are bent wrongly"));
}

TEST(CtMeshClean, SameInputSameBytesWhateverTheThreads) {
  const ScratchFolder folder;
  const Vec3 middle{17.5, 17.5, 17.5};
  io::write_nrrd(folder / "piece.nrrd",
                 volume_of(36, {shell(middle, 8, 11, 2100), ball({31, 17.5, 17.5}, 3, 4100)}, 60, 7));
  std::vector<std::string> meshes;
  for (const char* threads : {"1", "2"}) {
    const Ended ended = run({"ct-mesh-clean", "--threads", threads, "--out", threads, "piece.nrrd"}, folder.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
    meshes.push_back(read_file(folder / threads / "piece.ply"));
  }
  EXPECT_EQ(meshes[0], meshes[1]);
}

}  // namespace
}  // namespace gonio::tests
