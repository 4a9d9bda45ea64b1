// Optical flow in rendered pictures: it follows what turns slowly, loses what the surface hides, and its errors are
// measured against the points of the material.
#include "nrsfm/make/flow.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "nrsfm/make/animatronic_support.h"
#include "nrsfm/make/factorial.h"

namespace gonio::nrsfm {
namespace {

// A rigid wavy sheet, 0.2 m wide.
Motion wavy_sheet(Eigen::Index frames, double height_m = 0.01) {
  const Sheet sheet = flat_sheet(0.2, 0.2, 30);
  const auto mesh = std::make_shared<FrameMesh>(FrameMesh{sheet.rest, sheet.triangles});
  mesh->vertices_m.row(2) = height_m * (40 * sheet.rest.row(0).array()).cos() * (30 * sheet.rest.row(1).array()).cos();
  Motion motion;
  motion.kind = "sheet";
  motion.material_m = mesh->vertices_m;
  DeformingSurface one{
      sheet.triangles, mesh->vertices_m, spread_anchors(sheet.triangles, sheet.rest, {}, 80, 2), {}, {}, 0};
  motion.points_m = anchored(one).replicate(frames, 1);
  motion.mesh = [mesh](Eigen::Index) { return *mesh; };
  return motion;
}

// Cameras 0.6 m away, turning about the sheet by `step` a frame.
std::vector<CameraFromObject> turning(Eigen::Index frames, double step_rad) {
  std::vector<CameraFromObject> cameras;
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double angle = step_rad * static_cast<double>(f);
    CameraFromObject camera;
    camera.rotation =
        (Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.3 + angle, Eigen::Vector3d::UnitY()))
            .toRotationMatrix();
    camera.translation = {0, 0, 0.6};
    cameras.push_back(camera);
  }
  return cameras;
}

PictureView small_view() {
  PictureView view;
  view.width = 320, view.height = 240;
  view.pinhole = {600, 600, 160, 120};
  return view;
}

std::vector<double> errors_in(const Tracks& tracks, const Tracks& truth, Eigen::Index frame) {
  std::vector<double> errors;
  for (Eigen::Index p = 0; p < tracks.cols(); ++p)
    if (!std::isnan(tracks(2 * frame, p))) errors.push_back((tracks - truth).block<2, 1>(2 * frame, p).norm());
  std::sort(errors.begin(), errors.end());
  return errors;
}

Visible everywhere(const Motion& motion) {
  return Visible::Constant(motion.frames(), motion.points_m.cols(), true);
}

TEST(Flow, FollowsARigidTurnWithinAQuarterOfAPixel) {
  const Motion motion = wavy_sheet(10);
  const auto cameras = turning(10, 0.01);
  const PictureView view = small_view();
  const Tracks tracks = flow_tracks(motion, motion.points_m, everywhere(motion), cameras, view, 1);
  const Tracks truth = project(motion.points_m, cameras, view.projection, view.pinhole);
  const auto first = errors_in(tracks, truth, 0), last = errors_in(tracks, truth, 9);
  ASSERT_GT(first.size(), 50u);
  EXPECT_LT(first.back(), 1e-3);  // tracks begin on their points
  ASSERT_GT(last.size(), first.size() * 9 / 10);
  EXPECT_LT(last[last.size() / 2], 0.1);
  EXPECT_LT(last[last.size() * 9 / 10], 0.25);
  EXPECT_GT(last[last.size() / 2], 1e-3);  // they do drift
  EXPECT_GT((truth.topRows<2>() - truth.bottomRows<2>()).cwiseAbs().maxCoeff(), 4);
}

// A plate slides over the sheet: what it covers is lost, and stays so.
TEST(Flow, LosesWhatIsCovered) {
  Motion motion = wavy_sheet(8);
  const FrameMesh bare = motion.mesh(0);
  const auto offset = static_cast<std::uint32_t>(bare.vertices_m.cols());
  const auto covered = [bare, offset](Eigen::Index f) {
    FrameMesh mesh = bare;
    mesh.vertices_m.conservativeResize(3, offset + 4);
    const double edge = -0.12 + 0.015 * static_cast<double>(f);
    mesh.vertices_m.rightCols<4>() << -0.3, edge, edge, -0.3, -0.3, -0.3, 0.3, 0.3, 0.05, 0.05, 0.05, 0.05;
    mesh.triangles.push_back({offset, offset + 1, offset + 2});
    mesh.triangles.push_back({offset, offset + 2, offset + 3});
    return mesh;
  };
  motion.mesh = covered;
  motion.material_m = covered(0).vertices_m;
  const std::vector<CameraFromObject> cameras(8, turning(1, 0).front());
  const Tracks tracks = flow_tracks(motion, motion.points_m, everywhere(motion), cameras, small_view(), 1);
  int hidden = 0, kept_hidden = 0, open = 0, kept_open = 0;
  const auto visible = visible_in(covered(7), shape_of(motion.points_m, 7), cameras[7], Projection::perspective);
  for (Eigen::Index p = 0; p < tracks.cols(); ++p) {
    if (std::isnan(tracks(0, p))) continue;
    bool found = true;
    for (Eigen::Index f = 1; f < 8; ++f) {
      EXPECT_FALSE(!found && !std::isnan(tracks(2 * f, p)));  // never found again
      found = !std::isnan(tracks(2 * f, p));
    }
    // Some go on with the plate; the others shall not be found on it. Those beside its edge may go either way.
    if (visible(p))
      ++open, kept_open += found;
    else
      ++hidden, kept_hidden += found && (tracks.col(p).tail<2>() - tracks.col(p).head<2>()).norm() < 2;
  }
  ASSERT_GT(hidden, 15);
  ASSERT_GT(open, 15);
  EXPECT_GT(kept_open, 0.8 * open);
  EXPECT_LT(kept_hidden, 0.2 * hidden);
}

// A drum turns by a quarter: what goes behind is lost, and does not slip along the silhouette.
TEST(Flow, LosesWhatTurnsAway) {
  constexpr Eigen::Index frames = 13;
  const Sheet sheet = flat_sheet(0.3, 0.2, 40);
  Motion motion;
  motion.material_m = sheet.rest;
  DeformingSurface drum{sheet.triangles,
                        Shapes(3 * frames, sheet.rest.cols()),
                        spread_anchors(sheet.triangles, sheet.rest, {}, 120, 2),
                        {},
                        {},
                        0};
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index v = 0; v < sheet.rest.cols(); ++v) {
      constexpr double radius = 0.1;
      const double angle = sheet.rest(0, v) / radius + (static_cast<double>(f) / (frames - 1) - 0.5) * pi / 2;
      drum.vertices_m.block<3, 1>(3 * f, v) << radius * std::sin(angle), sheet.rest(1, v), radius * std::cos(angle);
    }
  motion.points_m = anchored(drum);
  motion.mesh = [&drum](Eigen::Index f) { return FrameMesh{shape_of(drum.vertices_m, f), drum.triangles}; };
  const std::vector<CameraFromObject> cameras(frames, [] {
    CameraFromObject camera = turning(1, 0).front();
    camera.rotation = Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return camera;
  }());
  const Visible seen = visible_points(motion, cameras, Projection::perspective);
  const Tracks tracks = flow_tracks(motion, motion.points_m, seen, cameras, small_view(), 1);
  const Tracks truth = project(motion.points_m, cameras, Projection::perspective, small_view().pinhole);
  int followed = 0, hidden = 0, slipped = 0;
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index p = 0; p < tracks.cols(); ++p) {
      if (std::isnan(tracks(2 * f, p))) continue;
      ++followed;
      hidden += !seen(f, p);
      slipped += (tracks - truth).block<2, 1>(2 * f, p).norm() > 1.5;
    }
  ASSERT_GT((!seen.row(0) && seen.row(frames - 1)).count(), 15);
  ASSERT_GT((seen.row(0) && !seen.row(frames - 1)).count(), 15);
  ASSERT_GT(followed, 500);
  EXPECT_LT(hidden, followed / 50);
  EXPECT_LT(slipped, followed / 50);
}

// Orthographic and perspective pictures have the same scale at the middle; errors are told in the sequence's unit.
TEST(Flow, SequencesHaveRealErrors) {
  const Motion motion = wavy_sheet(6, 0.003);
  for (const char* camera : {"orthographic", "perspective"}) {
    const Sequence s = film(motion, {"sheet", "tricky", camera, "with"}, 1, {.flow_width_px = 400});
    const TrackErrors errors = track_errors(s);
    const double radius = ball_around(motion.points_m).radius_m, unit = *camera == 'p' ? view_height_px / 3.0 : radius;
    EXPECT_GT(s.visible.row(0).count(), 30) << camera;
    EXPECT_GT(errors.median, 1e-5 * unit);
    EXPECT_LT(errors.median, 0.004 * unit);  // half a pixel of 400: 0.4 % of the radius
    EXPECT_GE(errors.upper, errors.median);
    const Sequence again = film(motion, {"sheet", "tricky", camera, "with"}, 1, {.flow_width_px = 400});
    EXPECT_TRUE((again.tracks.array() == s.tracks.array() || s.tracks.array().isNaN()).all());
  }
}

}  // namespace
}  // namespace gonio::nrsfm
