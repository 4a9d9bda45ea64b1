// Virtual cameras: paths, projections, and which points the surface hides.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "data.h"
#include "io/ply.h"
#include "nrsfm/files.h"
#include "nrsfm/make/animatronic_support.h"
#include "nrsfm/make/factorial.h"

namespace gonio::nrsfm {
namespace {

// Unit sphere by latitude and longitude.
FrameMesh sphere(int bands) {
  FrameMesh mesh;
  mesh.vertices_m.resize(3, (bands + 1) * 2 * bands);
  for (int i = 0; i <= bands; ++i)
    for (int j = 0; j < 2 * bands; ++j) {
      const double polar = pi * i / bands, azimuth = pi * j / bands;
      mesh.vertices_m.col(i * 2 * bands + j) << std::sin(polar) * std::cos(azimuth),
          std::sin(polar) * std::sin(azimuth), std::cos(polar);
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * 2 * bands + j % (2 * bands)); };
  for (int i = 0; i < bands; ++i)
    for (int j = 0; j < 2 * bands; ++j) {
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < bands) mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

CameraFromObject down_the_x_axis(double distance) {
  CameraFromObject camera;
  camera.rotation << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  camera.translation << 0, 0, distance;
  return camera;
}

// From a distance d the horizon of a unit sphere is the plane x = 1 / d; from infinity x = 0.
TEST(Occlusion, HidesTheFarSideOfASphere) {
  const FrameMesh mesh = sphere(40);
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    const double horizon = projection == Projection::perspective ? 1.0 / 3 : 0;
    const auto visible = visible_in(mesh, mesh.vertices_m, down_the_x_axis(3), projection);
    int checked = 0;
    for (Eigen::Index p = 0; p < mesh.vertices_m.cols(); ++p) {
      const double x = mesh.vertices_m(0, p);
      if (std::abs(x - horizon) < 0.08) continue;  // facets about the horizon
      EXPECT_EQ(visible(p), x > horizon) << x;
      ++checked;
    }
    EXPECT_GT(checked, 2500);
  }
}

// A small plate between camera and sheet hides what lies in its shadow; the sheet shows from behind unless one-sided.
TEST(Occlusion, FollowsOccludersAndSides) {
  Sheet sheet = flat_sheet(2, 2, 12);
  FrameMesh mesh{sheet.rest, sheet.triangles};
  const auto offset = static_cast<std::uint32_t>(sheet.rest.cols());
  mesh.vertices_m.conservativeResize(3, sheet.rest.cols() + 4);
  mesh.vertices_m.rightCols<4>() << -0.23, 0.23, 0.23, -0.23, -0.23, -0.23, 0.23, 0.23, 1, 1, 1, 1;
  mesh.triangles.push_back({offset, offset + 1, offset + 2});
  mesh.triangles.push_back({offset, offset + 2, offset + 3});
  CameraFromObject above;
  above.rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  above.translation << 0, 0, 2;
  const auto from_near = visible_in(mesh, sheet.rest, above, Projection::perspective);
  const auto parallel = visible_in(mesh, sheet.rest, above, Projection::orthographic);
  for (Eigen::Index p = 0; p < sheet.rest.cols(); ++p) {
    const double reach = sheet.rest.col(p).head<2>().cwiseAbs().maxCoeff();
    EXPECT_EQ(from_near(p), reach > 0.46) << reach;  // the shadow is twice the plate, from 2 m with the plate at 1 m
    EXPECT_EQ(parallel(p), reach > 0.23) << reach;
  }
  const FrameMesh bare{sheet.rest, sheet.triangles};
  CameraFromObject below;
  below.rotation << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  below.translation << 0, 0, 2;
  EXPECT_TRUE(visible_in(bare, sheet.rest, below, Projection::perspective).all());
  EXPECT_FALSE(visible_in(bare, sheet.rest, below, Projection::perspective, 0, true).any());
  EXPECT_TRUE(visible_in(bare, sheet.rest, above, Projection::perspective, 0, true).all());
}

TEST(CameraPaths, LookAtTheCentreFromTheirPlaces) {
  const PathOptions options{.distance_m = 2, .scene_radius_m = 0.4, .centre_m = {0.1, -0.2, 0.3}};
  for (const std::string& name : path_names()) {
    const auto cameras = camera_path(name, 61, options);
    ASSERT_EQ(cameras.size(), 61u);
    double turned = 0, longest = 0;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (std::size_t f = 0; f < cameras.size(); ++f) {
      const CameraFromObject& c = cameras[f];
      EXPECT_NEAR((c.rotation * c.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
      EXPECT_NEAR(c.rotation.determinant(), 1, 1e-12);
      const Eigen::Vector3d seen = c.rotation * options.centre_m + c.translation;
      EXPECT_NEAR(seen.head<2>().norm(), 0, 1e-12);
      EXPECT_GT(seen.z(), 2 * options.scene_radius_m);
      const Eigen::Vector3d eye = -c.rotation.transpose() * c.translation;
      if (f > 0) longest = std::max(longest, (eye - before).norm());
      before = eye;
      turned = std::max(turned, Eigen::AngleAxisd(c.rotation * cameras[0].rotation.transpose()).angle());
    }
    EXPECT_LT(longest, 0.5) << name;
    if (name == "tricky") {
      EXPECT_LT(turned, 0.35);
    } else {
      EXPECT_GT(turned, 0.7) << name;
    }
  }
  EXPECT_THROW(camera_path("spiral", 5, options), Error);
}

TEST(CameraPaths, ProjectAsTheirModelsSay) {
  Shapes shape(3, 1);
  shape << 0.2, -0.1, 0.3;
  const auto cameras = camera_path("line", 1, {.distance_m = 2, .scene_radius_m = 0.4});
  const Eigen::Vector3d p = cameras[0].rotation * Eigen::Vector3d(shape.col(0)) + cameras[0].translation;
  const Tracks flat = project(shape, cameras, Projection::orthographic, {});
  EXPECT_NEAR((flat.col(0) - p.head<2>()).norm(), 0, 1e-15);
  const Tracks deep = project(shape, cameras, Projection::perspective, {800, 700, 640, 480});
  EXPECT_NEAR(deep(0, 0), 800 * p.x() / p.z() + 640, 1e-9);
  EXPECT_NEAR(deep(1, 0), 700 * p.y() / p.z() + 480, 1e-9);
}

// A rigid ball as a motion: what the camera misses is what lies behind, frame by frame.
Motion turning_ball(Eigen::Index frames) {
  Motion motion;
  motion.kind = "ball";
  const auto mesh = std::make_shared<FrameMesh>(sphere(16));
  motion.points_m = mesh->vertices_m.middleCols(64, 384).replicate(frames, 1);
  motion.mesh = [mesh](Eigen::Index) { return *mesh; };
  return motion;
}

TEST(Film, MissingDataIsStructured) {
  const Motion ball = turning_ball(24);
  const Sequence with = film(ball, {"ball", "circle", "perspective", "with"}, 1, {});
  const Sequence without = film(ball, {"ball", "circle", "perspective", "without"}, 1, {});
  EXPECT_TRUE(without.complete());
  EXPECT_EQ(without.points(), with.points());
  EXPECT_GT(with.missing_share(), 0.35);
  EXPECT_LT(with.missing_share(), 0.75);
  // Hidden in a frame mostly means hidden in the next: far fewer changes than of entries thrown at random.
  double changes = 0;
  for (Eigen::Index f = 1; f < with.frames(); ++f)
    changes += (with.visible.row(f) != with.visible.row(f - 1)).cast<double>().mean();
  const double share = with.missing_share();
  EXPECT_LT(changes / 23, 0.5 * 2 * share * (1 - share));
  EXPECT_TRUE(with.tracks.topRows(2).array().isNaN().any());
  EXPECT_EQ(with.name, "ball-circle-perspective-with");
  EXPECT_EQ(with.factors.at("path"), "circle");
  // The whole scene lies in the picture.
  EXPECT_GT(without.tracks.minCoeff(), 0);
  EXPECT_LT(without.tracks.maxCoeff(), view_width_px);
}

// The cells with and without missing data follow the same points, so many as are wanted, of those that enough frames
// see, whichever of them is made.
TEST(Film, TwinsDifferInNothingButWhatIsHidden) {
  Motion ball = turning_ball(20);
  ball.wanted = 100;
  for (const std::string& path : path_names())
    for (const char* camera : {"orthographic", "perspective"}) {
      const Sequence with = film(ball, {"ball", path, camera, "with"}, 1, {.least_seen = 0.25});
      const Sequence without = film(ball, {"ball", path, camera, "without"}, 1, {.least_seen = 0.25});
      ASSERT_EQ(with.points(), 100) << path;
      ASSERT_EQ(without.points(), 100) << path;
      EXPECT_EQ((*with.truth - *without.truth).cwiseAbs().maxCoeff(), 0);
      EXPECT_TRUE(without.complete());
      EXPECT_TRUE(path != "circle" || !with.complete());
      EXPECT_GE(with.visible.cast<int>().colwise().sum().minCoeff(), 5) << path;
      for (Eigen::Index f = 0; f < with.frames(); ++f)
        for (Eigen::Index p = 0; p < with.points(); ++p) {
          const Eigen::Vector2d a = with.tracks.block<2, 1>(2 * f, p), b = without.tracks.block<2, 1>(2 * f, p);
          if (with.visible(f, p))
            ASSERT_EQ(a, b);
          else
            ASSERT_TRUE(a.array().isNaN().all());
        }
    }
  // The side that a camera hardly moving never sees is not followed, and others take its place.
  const Sequence tricky = film(ball, {"ball", "tricky", "perspective", "without"}, 1, {});
  EXPECT_LT((*tricky.truth)(Eigen::seq(1, Eigen::last, 3), Eigen::all).maxCoeff(), 0.35);
  EXPECT_GT(ball.points_m.leftCols(100)(Eigen::seq(1, Eigen::last, 3), Eigen::all).maxCoeff(), 0.5);
  Motion few = ball;
  few.points_m = ball.points_m.leftCols(140);
  EXPECT_LT(film(few, {"ball", "tricky", "perspective", "with"}, 1, {}).points(), 100);
}

TEST(Film, AnimatronicsHaveAsManyPointsAsAreWanted) {
  const Sheet sheet = flat_sheet(0.2, 0.1, 12);  // anchors that stand by change none of those that are preferred
  const auto few = spread_anchors(sheet.triangles, sheet.rest, {}, 30, 5);
  const auto many = spread_anchors(sheet.triangles, sheet.rest, {}, 120, 5);
  for (std::size_t k = 0; k < few.size(); ++k) {
    EXPECT_EQ(few[k].triangle, many[k].triangle);
    EXPECT_EQ(few[k].b1, many[k].b1);
  }
  const Motion motion = motion_of(*find_animatronic("stretching"), {.frames = 8, .points = 30, .seed = 2});
  EXPECT_GT(motion.points_m.cols(), 30);
  for (const char* path : {"circle", "tricky"})
    EXPECT_EQ(film(motion, {"stretching", path, "perspective", "with"}, 1, {}).points(), 30);
}

TEST(Film, DesignIsFullFactorial) {
  const auto cells =
      design({"a", "b", "c", "d", "e"}, path_names(), {"orthographic", "perspective"}, {"with", "without"});
  EXPECT_EQ(cells.size(), 120u);
  EXPECT_EQ(name_of(cells[1], 7), "a-circle-orthographic-without-seed7");
}

TEST(Scans, MeshesAndTracksOfAFolder) {
  const gonio::tests::ScratchFolder scratch;
  const std::filesystem::path& folder = scratch.path();
  std::filesystem::create_directories(folder / "ball");
  FrameMesh mesh = sphere(8);
  Shapes points(6, 48);
  for (int f = 0; f < 2; ++f) {
    io::TriangleMesh ply;
    for (Eigen::Index v = 0; v < mesh.vertices_m.cols(); ++v)
      ply.positions_m.push_back({mesh.vertices_m(0, v) * (f + 1), mesh.vertices_m(1, v), mesh.vertices_m(2, v)});
    ply.triangles = mesh.triangles;
    io::write_ply(folder / "ball" / ("frame_" + std::to_string(f) + ".ply"), ply);
    shape_of(points, f) = mesh.vertices_m.middleCols(48, 48);
    points.row(3 * f) *= f + 1;
  }
  points(4, 7) = std::nan("");
  Reconstruction tracks;
  tracks.name = "tracks", tracks.shapes = points;
  write_reconstruction(tracks, folder / "tracks.mat");
  const Motion motion = motion_of_scans(folder / "ball", folder / "tracks.mat", 1e-3);
  EXPECT_EQ(motion.kind, "ball");
  EXPECT_EQ(motion.points_m.cols(), 47);
  ASSERT_EQ(motion.notes.size(), 1u);
  EXPECT_NE(motion.notes[0].find("1 of 48 points"), std::string::npos);
  EXPECT_NEAR(motion.points_m.cwiseAbs().maxCoeff(), 2e-3 * points.row(0).cwiseAbs().maxCoeff(), 1e-9);
  const auto cameras = camera_path("tricky", 2, {0.02, 0.002, Eigen::Vector3d::Zero()});
  const Visible visible = visible_points(motion, cameras, Projection::perspective);
  EXPECT_GT(visible.count(), 20);
  EXPECT_LT(visible.count(), 74);
  std::filesystem::remove(folder / "ball" / "frame_1.ply");
  EXPECT_THROW(motion_of_scans(folder / "ball", folder / "tracks.mat", 1e-3), Error);
}

}  // namespace
}  // namespace gonio::nrsfm
