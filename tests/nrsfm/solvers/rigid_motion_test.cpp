// One rigid shape by least reprojection error, and cameras that solvers choose by themselves.
#include "nrsfm/solve/rigid_motion.h"

#include <gtest/gtest.h>

#include "made.h"

namespace gonio::nrsfm::testing {
namespace {

std::vector<WeakCamera> start_of(const Sequence& s, bool free_scales) {
  const Start start = start_from(s, 1, {free_scales, 0});
  std::vector<WeakCamera> cameras;
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    cameras.push_back(
        {start.upgrade.rotations[std::size_t(f)], start.upgrade.scales(f), start.translation.segment<2>(2 * f)});
  return cameras;
}

double largest_residual(const Sequence& s, const RigidMotion& motion) {
  double largest = 0;
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const WeakCamera& camera = motion.cameras[std::size_t(f)];
    const Eigen::Matrix2Xd at = (camera.scale * camera.rotation * motion.shape).colwise() + camera.translation;
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (s.visible(f, p))
        largest = std::max(largest, (s.tracks.block<2, 1>(2 * f, p) - at.col(p)).cwiseAbs().maxCoeff());
  }
  return largest;
}

// From cameras that are wrong by tens of degrees, with more frames than points and the other way about.
TEST(RigidMotion, gives_back_a_rigid_shape) {
  for (const Eigen::Index points : {20, 120}) {
    for (const bool free_scales : {false, true}) {
      Sequence s = low_rank_sequence(30, points, 1, 0);
      for (Eigen::Index f = 0; f < s.frames() && free_scales; ++f)
        s.tracks.middleRows<2>(2 * f) *= 1 + 0.3 * std::sin(0.4 * double(f));
      std::vector<WeakCamera> cameras = start_of(s, free_scales);
      Random random(7);
      for (WeakCamera& camera : cameras)
        camera.rotation = nearest_rows(camera.rotation + 0.15 * CameraRows(normals(2, 3, random)));
      hide_in_runs(s, 8);
      const RigidMotion found = refine_rigid(s, cameras, {.free_scales = free_scales});
      EXPECT_TRUE(found.converged);
      EXPECT_LT(largest_residual(s, found), 1e-6) << points << free_scales;
    }
  }
}

TEST(RigidMotion, leaves_no_more_than_it_started_with_and_lies_at_a_minimum) {
  const Sequence s = low_rank_sequence(25, 18, 2, 0.02);
  const std::vector<WeakCamera> start = start_of(s, false);
  const RigidMotion found = refine_rigid(s, start, {});
  const auto cost_of = [&](const std::vector<WeakCamera>& cameras, const Eigen::Matrix3Xd& shape) {
    double cost = 0;
    for (Eigen::Index f = 0; f < s.frames(); ++f) {
      const WeakCamera& camera = cameras[std::size_t(f)];
      const Eigen::Matrix2Xd at = (camera.scale * camera.rotation * shape).colwise() + camera.translation;
      cost += (s.tracks.middleRows<2>(2 * f) - at).squaredNorm();
    }
    return cost;
  };
  EXPECT_NEAR(cost_of(found.cameras, found.shape), found.cost, 1e-9 * found.cost);
  EXPECT_LT(found.cost, cost_of(start, rigid_shape(s, start)));
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<WeakCamera> moved = found.cameras;
    for (WeakCamera& camera : moved) {
      camera.rotation = nearest_rows(camera.rotation + 1e-3 * CameraRows(normals(2, 3, random)));
      camera.translation += 1e-3 * Eigen::Vector2d(normals(2, 1, random));
    }
    const Eigen::Matrix3Xd shape = found.shape + 1e-3 * Eigen::Matrix3Xd(normals(3, s.points(), random));
    EXPECT_GE(cost_of(moved, shape), found.cost * (1 - 1e-7));
  }
}

// A sheet that bends about changing axes: nearly flat, seen all around from 20 degrees above it.
Sequence bending_sheet(Eigen::Index frames, Eigen::Index side) {
  Sequence s;
  s.name = "bending";
  const Eigen::Index points = side * side;
  s.truth = Shapes(3 * frames, points);
  s.tracks.resize(2 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double t = double(f) / double(frames), curvature = 1.2 * std::sin(5 * t + 0.3);
    CameraFromObject camera;
    camera.rotation = (Eigen::AngleAxisd(-(90 - 20) * M_PI / 180, Eigen::Vector3d::UnitX()) *
                       Eigen::AngleAxisd(2 * M_PI * t, Eigen::Vector3d::UnitZ()))
                          .toRotationMatrix();
    const Eigen::Vector2d across(std::cos(2 * t), std::sin(2 * t)), along(-across(1), across(0));
    for (Eigen::Index p = 0; p < points; ++p) {
      const Eigen::Vector2d at(double(p % side) / double(side - 1) - 0.5, double(p / side) / double(side - 1) - 0.5);
      const double u = curvature * at.dot(across);
      const Eigen::Vector2d flat = std::sin(u) / curvature * across + at.dot(along) * along;
      s.truth->block<3, 1>(3 * f, p) << flat, (1 - std::cos(u)) / curvature + 0.2 * at(0) * at(1);
    }
    s.tracks.middleRows<2>(2 * f) = (camera.rotation * shape_of(*s.truth, f)).topRows<2>();
    s.cameras.push_back(camera);
  }
  s.visible = Visible::Constant(frames, points, true);
  return s;
}

TEST(CameraChoice, takes_the_cameras_of_a_rigid_shape_where_orthonormality_does_not_tell) {
  const Sequence s = bending_sheet(40, 8);
  for (const char* solver : {"csf", "spfm"}) {
    const Solution chosen = answer(solver, s);
    EXPECT_EQ(chosen.values.at("camera_rank"), -1) << solver;
    const double error = error_of(chosen, s, Alignment::frame_rotation);
    RecordProperty(solver, std::to_string(error));
    EXPECT_LT(error, 0.15) << solver;
    for (const double rank : {1.0, 2.0})
      EXPECT_GT(error_of(answer(solver, s, {{"camera_rank", rank}}), s, Alignment::frame_rotation), 2 * error);
    EXPECT_NEAR(error_of(answer(solver, s, {{"camera_rank", -1}}), s, Alignment::frame_rotation), error, 1e-6);
  }
}

TEST(CameraChoice, takes_those_of_a_higher_rank_where_shapes_deform_much) {
  const Sequence s = low_rank_sequence(40, 40, 3, 0.002);
  const Solution chosen = answer("csf", s);
  EXPECT_GE(chosen.values.at("camera_rank"), 2);
  EXPECT_LT(error_of(chosen, s, Alignment::frame_rotation), 0.05);
}

// The likelihood's maximum is the same by plain and by extrapolated turns; the latter need fewer.
TEST(EmPpca, turns_faster_where_extrapolated) {
  const Sequence s = low_rank_sequence(30, 24, 2, 0.05);
  SolverOptions options;
  options.values = {{"rank", 1}, {"camera_rank", 2}};
  options.most_iterations = 3000;
  const Solution plain = solve(*find_solver("em_ppca"), s, options);
  options.values["extrapolate"] = 1;
  const Solution faster = solve(*find_solver("em_ppca"), s, options);
  ASSERT_TRUE(plain.converged);
  ASSERT_TRUE(faster.converged);
  EXPECT_LT(faster.iterations, plain.iterations);
  EXPECT_NEAR(faster.reprojection_rms, plain.reprojection_rms, 0.01 * plain.reprojection_rms);
  EXPECT_LT(e3d(faster.reconstruction.shapes, plain.reconstruction.shapes, Alignment::frame_rotation), 0.03);
}

TEST(EmPpca, says_where_it_ended_early) {
  const Sequence s = low_rank_sequence(30, 24, 3, 0.001);
  SolverOptions options;
  options.values = {{"rank", 2}, {"camera_rank", 2}};
  options.most_iterations = 5;
  const Solution early = solve(*find_solver("em_ppca"), s, options);
  EXPECT_FALSE(early.converged);
  ASSERT_EQ(early.notes.size(), 1U);
  EXPECT_EQ(early.notes.front().find("ended early"), 0U);
}

TEST(Ksta, does_not_refuse_its_own_ranks) {
  for (const Eigen::Index frames : {2, 3, 4, 5, 8}) {
    const Sequence s = low_rank_sequence(frames, 20, 2, 0.01);
    EXPECT_TRUE(answer("ksta", s).reconstruction.shapes.allFinite()) << frames;
  }
}

}  // namespace
}  // namespace gonio::nrsfm::testing
