// Sequences whose truth is known: low-rank shapes seen by a turning orthographic camera, and a sheet that bends.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/random.h"
#include "nrsfm/evaluate/errors.h"
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/solver.h"

namespace gonio::nrsfm::testing {

inline Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, Random& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal(); });
}

// F frames of `shapes` basis shapes, the first of weight 1, the others of weights that vary as cosines.
inline Sequence low_rank_sequence(Eigen::Index frames, Eigen::Index points, Eigen::Index shapes, double noise,
                                  std::uint64_t seed = 1) {
  Random random(seed);
  Eigen::MatrixXd basis = normals(3 * shapes, points, random);
  basis.bottomRows(3 * (shapes - 1)) *= 0.3;
  basis.colwise() -= basis.rowwise().mean().eval();
  Sequence s;
  s.name = "made";
  s.truth = shapes_of(std::sqrt(double(frames)) * dct_basis(frames, shapes), basis);
  s.tracks.resize(2 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double t = 2 * M_PI * double(f) / double(frames);
    CameraFromObject camera;
    camera.rotation = (Eigen::AngleAxisd(0.5 * std::sin(0.6 * t), Eigen::Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(1.2 * std::cos(1.7 * t + 0.4), Eigen::Vector3d::UnitY()) *
                       Eigen::AngleAxisd(1.2 * std::sin(t), Eigen::Vector3d::UnitX()))
                          .toRotationMatrix();
    s.tracks.middleRows<2>(2 * f) = (camera.rotation * shape_of(*s.truth, f)).topRows<2>();
    s.tracks.middleRows<2>(2 * f).colwise() += Eigen::Vector2d(3 * std::sin(t), std::cos(2 * t));
    s.cameras.push_back(camera);
  }
  s.tracks += noise * normals(2 * frames, points, random);
  s.visible = Visible::Constant(frames, points, true);
  return s;
}

inline void hide(Sequence& s, Eigen::Index f, Eigen::Index p) {
  s.visible(f, p) = false;
  s.tracks.block<2, 1>(2 * f, p).setConstant(std::numeric_limits<double>::quiet_NaN());
}

// Each point is hidden for one run of frames, as behind something.
inline void hide_in_runs(Sequence& s, Eigen::Index length) {
  for (Eigen::Index p = 0; p < s.points(); ++p) {
    const Eigen::Index first = p * s.frames() / s.points();
    for (Eigen::Index k = 0; k < length; ++k) hide(s, (first + k) % s.frames(), p);
  }
}

// A sheet of 0.2 m, side x side points, rolled onto cylinders of changing radius and direction half a metre away: bent,
// never stretched. Truth in each frame's camera.
inline Sequence bent_sheet(Eigen::Index frames, Eigen::Index side, double noise_px = 0) {
  Random random(3);
  Sequence s;
  s.name = "sheet";
  s.projection = Projection::perspective;
  s.pinhole = Pinhole{800, 810, 320, 240};
  s.truth_frame = ShapeFrame::camera;
  const Eigen::Index points = side * side;
  s.truth = Shapes(3 * frames, points);
  s.tracks.resize(2 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double curvature = 12 * std::sin(1.3 * double(f) + 0.5), direction = 0.7 * double(f);
    const Eigen::Matrix3d pose = (Eigen::AngleAxisd(0.5 * std::sin(2.1 * double(f)), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.5 * std::cos(1.7 * double(f)), Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
    for (Eigen::Index p = 0; p < points; ++p) {
      const double u = 0.2 * (double(p % side) / double(side - 1) - 0.5);
      const double v = 0.2 * (double(p / side) / double(side - 1) - 0.5);
      const double across = std::cos(direction) * u + std::sin(direction) * v;
      const double along = -std::sin(direction) * u + std::cos(direction) * v;
      const double x = std::sin(curvature * across) / curvature, z = (1 - std::cos(curvature * across)) / curvature;
      const Eigen::Vector3d at = pose * Eigen::Vector3d(x, along, z) + Eigen::Vector3d(0, 0, 0.5);
      s.truth->block<3, 1>(3 * f, p) = at;
      s.tracks(2 * f, p) = 800 * at(0) / at(2) + 320 + noise_px * random.normal();
      s.tracks(2 * f + 1, p) = 810 * at(1) / at(2) + 240 + noise_px * random.normal();
    }
  }
  s.visible = Visible::Constant(frames, points, true);
  return s;
}

inline Solution answer(const std::string& solver, const Sequence& s, const SolverValues& values = {}) {
  SolverOptions options;
  options.values = values;
  return solve(*find_solver(solver), s, options);
}

// e3D of either hand: orthographic tracks do not tell them apart. Shapes in the truth's kind of frame.
inline double error_of(const Solution& solution, const Sequence& s, Alignment alignment) {
  Shapes x = solution.reconstruction.shapes;
  const bool in_cameras = s.truth_frame == ShapeFrame::camera && solution.reconstruction.frame == ShapeFrame::object;
  for (Eigen::Index f = 0; f < s.frames() && in_cameras; ++f)
    shape_of(x, f) = (completed(solution.reconstruction.rotations[std::size_t(f)]) * shape_of(x, f)).eval();
  Shapes other = s.truth_frame == ShapeFrame::camera ? x : Shapes(-x);
  for (Eigen::Index f = 0; f < s.frames() && s.truth_frame == ShapeFrame::camera; ++f) other.row(3 * f + 2) *= -1;
  return std::min(e3d(x, *s.truth, alignment), e3d(other, *s.truth, alignment));
}

// The same things seen by a turned, larger, shifted image, points in reverse and, with `frames`, frames too.
inline Sequence reordered(const Sequence& s, bool frames) {
  Sequence other = s;
  const Eigen::Matrix2d turn = 7.5 * Eigen::Rotation2Dd(0.8).toRotationMatrix();
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const Eigen::Index from = frames ? s.frames() - 1 - f : f;
    other.tracks.middleRows<2>(2 * f) =
        (turn * s.tracks.middleRows<2>(2 * from).rowwise().reverse()).colwise() + Eigen::Vector2d(100, -40);
    shape_of(*other.truth, f) = 7.5 * shape_of(*s.truth, from).rowwise().reverse();
  }
  return other;
}

// The error before and after that, relative to before.
inline double change_when_reordered(const std::string& solver, const Sequence& s, const SolverValues& values,
                                    bool frames) {
  const double before = error_of(answer(solver, s, values), s, Alignment::frame_rotation);
  const Sequence other = reordered(s, frames);
  return std::abs(error_of(answer(solver, other, values), other, Alignment::frame_rotation) - before) / before;
}

// What a solver says of a sequence that misses one track; empty where it does not refuse as bad data.
inline std::string refusal_of_a_missing_track(const std::string& solver) {
  Sequence s = low_rank_sequence(20, 15, 2, 0);
  hide(s, 3, 4);
  try {
    answer(solver, s);
  } catch (const Error& error) {
    return error.code() == Exit::data ? error.what() : "";
  }
  return "";
}

}  // namespace gonio::nrsfm::testing
