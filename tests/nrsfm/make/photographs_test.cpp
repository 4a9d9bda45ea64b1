// Tracks out of photographs: corners are chosen, followed within what is said of them, and known again in the truth.
#include "nrsfm/make/photographs.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "data.h"
#include "geom/vector.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "nrsfm/make/animatronic_support.h"
#include "nrsfm/make/camera_paths.h"
#include "nrsfm/make/painted_object.h"
#include "scene/deformed.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

// A sheet that rises into a wave, painted, as files of a scene.
struct Wave {
  tests::ScratchFolder folder;
  manifest::Document truth;
  DeformingSurface surface;
  Extent extent;

  explicit Wave(Eigen::Index shapes = 5) {
    const Sheet sheet = flat_sheet(0.2, 0.16, 20);
    surface.triangles = sheet.triangles;
    surface.vertices_m.resize(3 * shapes, sheet.rest.cols());
    for (Eigen::Index f = 0; f < shapes; ++f) {
      const double height_m = 0.012 * static_cast<double>(f) / static_cast<double>(shapes - 1);
      shape_of(surface.vertices_m, f) = sheet.rest;
      surface.vertices_m.row(3 * f + 2) = height_m * (30 * sheet.rest.row(0).array()).cos();
    }
    surface.rig.assign(static_cast<std::size_t>(shapes), {upright_box({0.12, 0, 0}, {0.01, 0.02, 0.02})});
    truth.folder = folder.path();
    extent = enter_painted(truth, surface, "sheet", {.grain_m = 0.004, .seed = 3},
                           [this](const std::string& name) { return folder / name; });
  }
};

TEST(PaintedObject, IsTheSameSurfaceOfSmallerTriangles) {
  const std::vector<std::array<std::uint32_t, 3>> two{{0, 1, 2}, {2, 1, 3}};
  const Refined fine = refined(two, 4);
  EXPECT_EQ(fine.triangles.size(), 32u);
  EXPECT_EQ(fine.vertices.size(), 25u);  // 5 x 5: the shared edge's places are one vertex each
  const Wave wave;
  const io::TriangleMesh half = scene::deformed_mesh(wave.truth, "sheet", 0.5, {.properties = {"paint"}});
  ASSERT_EQ(half.properties.front().size(), half.positions_m.size());
  EXPECT_GT(*std::ranges::max_element(half.properties.front()), 0.7f);
  EXPECT_LT(*std::ranges::min_element(half.properties.front()), 0.3f);
  double highest = 0, area = 0;
  for (const Vec3& v : half.positions_m) highest = std::max(highest, v.z);
  EXPECT_NEAR(highest, 0.006, 1e-6);
  for (const auto& [a, b, c] : half.triangles)
    area += 0.5 * norm(cross(half.positions_m[b] - half.positions_m[a], half.positions_m[c] - half.positions_m[a]));
  EXPECT_GT(area, 0.2 * 0.15);
  ASSERT_EQ(wave.truth.objects.size(), 2u);
  EXPECT_EQ(wave.truth.objects[1].id, "sheet-rig");
  EXPECT_NEAR(wave.extent.lower_m.z(), 0, 1e-12);  // it stands on the plane
  EXPECT_NEAR(wave.extent.lower_m.x() + wave.extent.upper_m.x(), 0, 1e-12);
}

// Pictures as an instrument has them: noise, a lens with distortion, a file each.
struct Recording {
  tests::ScratchFolder folder;
  manifest::Document frames;

  Recording(const Wave& wave, int count) {
    frames.folder = folder.path();
    manifest::Camera camera;
    camera.width_px = 240, camera.height_px = 180;
    camera.fx_px = camera.fy_px = 300, camera.cx_px = 119.5, camera.cy_px = 89.5;
    frames.cameras["camera"] = camera;
    Random random(5);
    for (int k = 0; k < count; ++k) add(wave, k, static_cast<double>(k) / (count - 1), random);
  }

  void add(const Wave& wave, int k, double share, Random& random) {
    manifest::ImageEntry image;
    image.id = "view-" + std::to_string(100 + k);
    image.camera = "camera", image.response = "linear";
    image.shapes = {{"sheet", share}, {"sheet-rig", share}};
    const double turn = 0.25 * share;
    const Eigen::Matrix3d down =
        (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const Eigen::Quaterniond q(down);
    const Eigen::Vector3d eye = -0.35 * down.col(2);
    auto& pose = image.world_from_camera.emplace();
    pose.rotation = {q.w(), q.x(), q.y(), q.z()}, pose.translation_m = {eye.x(), eye.y(), eye.z()};
    frames.images.push_back(image);
    PictureView view;
    view.width = 240, view.height = 180, view.pinhole = {300, 300, 120, 90};
    view.camera.rotation = down.transpose(), view.camera.translation = -down.transpose() * eye;
    const GreyPicture seen = picture_of(mesh_at(wave, share), wave.surface.vertices_m.topRows(3), view, {0.004, 3});
    io::Image picture(240, 180, {"Y"});
    for (std::size_t i = 0; i < seen.value.size(); ++i)
      picture.data[i] = static_cast<float>(std::clamp(seen.value[i] / 255.0 + 0.01 * random.normal(), 0.0, 1.0));
    const auto path = folder / (image.id + ".png");
    io::write_picture(path, picture);
    frames.images.back().file = manifest::add_file(frames, path, image.id);
  }

  // The sheet alone, of its own triangles: paint between vertices is the renderer's there.
  static FrameMesh mesh_at(const Wave& wave, double share) {
    const double along = share * static_cast<double>(wave.surface.frames() - 1);
    const auto f = std::min(static_cast<Eigen::Index>(along), wave.surface.frames() - 2);
    FrameMesh mesh{shape_of(wave.surface.vertices_m, f), wave.surface.triangles};
    mesh.vertices_m += (along - static_cast<double>(f)) * (shape_of(wave.surface.vertices_m, f + 1) - mesh.vertices_m);
    const Vec3 place = wave.truth.objects.front().world_from_object->translation_m;
    mesh.vertices_m.colwise() += Eigen::Vector3d(place.x, place.y, place.z);
    return mesh;
  }
};

TEST(Photographs, PointsAreFollowedWithinWhatIsSaidOfThem) {
  const Wave wave;
  const Recording recording(wave, 13);
  const Photographs photographs(recording.frames);
  ASSERT_EQ(photographs.count(), 13u);
  const FollowOptions options{.points = 60, .every = 3};
  const FollowedPoints followed = follow(
      13, [&](std::size_t k) { return photographs.picture(k); }, options);
  ASSERT_EQ(followed.tracks_px.rows(), 10);
  const KnownTracks known =
      with_truth(photographs, followed, photographs.sequence(followed, 3), 3, wave.truth, "sheet");
  ASSERT_GT(known.tracks.points(), 40);
  const Tracks truth =
      project(*known.tracks.truth, known.tracks.cameras, Projection::perspective, *known.tracks.pinhole);
  std::vector<double> errors, scores;
  double moved = 0;
  for (Eigen::Index p = 0; p < known.tracks.points(); ++p)
    for (Eigen::Index f = 0; f < 5; ++f) {
      if (!known.tracks.visible(f, p)) continue;
      const double error = (known.tracks.tracks - truth).block<2, 1>(2 * f, p).norm(), sigma = known.tracks.sigma(f, p);
      if (sigma == 0) {
        EXPECT_LT(error, 1e-4) << f << " " << p;  // where it was chosen
      }
      if (sigma > 0) errors.push_back(error), scores.push_back(error / std::sqrt(2.0) / sigma);
      moved = std::max(moved, (truth.block<2, 1>(2 * f, p) - truth.block<2, 1>(0, p)).norm());
    }
  EXPECT_GT(moved, 10);
  EXPECT_LT(stats::median(errors), 0.25);
  EXPECT_GT(stats::median(scores), 0.3);  // 0.83 of normal errors; a surface that turns adds what no residual shows
  EXPECT_LT(stats::median(scores), 3);
  // What geometry sees of the same points: at the truth, and wherever the surface does not hide it.
  EXPECT_EQ(known.ideal.points(), known.tracks.points());
  EXPECT_GE(known.ideal.visible.count(), known.tracks.visible.count());
  EXPECT_LT((known.ideal.tracks - truth).array().isNaN().select(0, known.ideal.tracks - truth).norm(), 1e-9);
}

}  // namespace
}  // namespace gonio::nrsfm
