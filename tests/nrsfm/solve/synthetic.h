// Sequences whose truth is known: a rank-K model with smooth weights, seen by a camera that turns about all axes.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/random.h"
#include "nrsfm/evaluate/alignment.h"
#include "nrsfm/evaluate/errors.h"
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/solver.h"

namespace gonio::nrsfm::testing {

struct Recipe {
  Eigen::Index frames = 60, points = 40;
  Eigen::Index shapes = 1;   // K with the mean shape
  Eigen::Index cosines = 1;  // d >= K; d == K: the weights are the first cosines themselves
  double deformation = 0.3;  // of the mean shape's size
  double noise = 0;          // sigma of the tracks, of the shape's size
  double turn_rad = 1.2;     // amplitude of the camera's rotations
  std::uint64_t seed = 1;
};

inline Eigen::Matrix3d turned(double x, double y, double z) {
  return (Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

inline Eigen::MatrixXd normal_matrix(Eigen::Index rows, Eigen::Index columns, Random& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal(); });
}

inline Sequence made(const Recipe& r) {
  Random random(r.seed);
  Eigen::MatrixXd basis = normal_matrix(3 * r.shapes, r.points, random);
  basis.bottomRows(3 * (r.shapes - 1)) *= r.deformation;
  basis.colwise() -= basis.rowwise().mean().eval();
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Identity(r.cosines, r.shapes);
  if (r.cosines > r.shapes && r.shapes > 1) {
    mixed.bottomRightCorner(r.cosines - 1, r.shapes - 1) = normal_matrix(r.cosines - 1, r.shapes - 1, random);
    mixed.rightCols(r.shapes - 1).colwise().normalize();
  }
  const Eigen::MatrixXd weights = std::sqrt(double(r.frames)) * dct_basis(r.frames, r.cosines) * mixed;
  Sequence s;
  s.name = "made";
  s.truth = shapes_of(weights, basis);
  s.tracks.resize(2 * r.frames, r.points);
  for (Eigen::Index f = 0; f < r.frames; ++f) {
    const double t = 2 * M_PI * double(f) / double(r.frames);
    CameraFromObject camera;
    camera.rotation =
        turned(r.turn_rad * std::sin(5 * t), r.turn_rad * std::cos(6.7 * t + 0.4), 0.5 * std::sin(0.6 * t));
    camera.translation << 3 * std::sin(t), std::cos(2 * t), 0;
    s.tracks.middleRows<2>(2 * f) =
        (camera.rotation * shape_of(*s.truth, f)).colwise().operator+(camera.translation).topRows<2>();
    s.cameras.push_back(camera);
  }
  s.tracks += r.noise * normal_matrix(2 * r.frames, r.points, random);
  s.visible = Visible::Constant(r.frames, r.points, true);
  return s;
}

inline void hide(Sequence& s, Eigen::Index f, Eigen::Index p) {
  s.visible(f, p) = false;
  s.tracks.block<2, 1>(2 * f, p).setConstant(std::numeric_limits<double>::quiet_NaN());
}
inline void hide_at_random(Sequence& s, double share, std::uint64_t seed = 5) {
  Random random(seed);
  for (Eigen::Index f = 0; f < s.frames(); ++f)
    for (Eigen::Index p = 0; p < s.points(); ++p)
      if (random.uniform() < share) hide(s, f, p);
}
// Each point is hidden for one run of frames, as behind something: runs of neighbours overlap.
inline void hide_in_runs(Sequence& s, Eigen::Index length) {
  for (Eigen::Index p = 0; p < s.points(); ++p) {
    const Eigen::Index first = p * s.frames() / s.points();
    for (Eigen::Index k = 0; k < length; ++k) hide(s, (first + k) % s.frames(), p);
  }
}

inline Solution answer(const std::string& solver, const Sequence& s, const SolverValues& values = {}) {
  SolverOptions options;
  options.values = values;
  return solve(*find_solver(solver), s, options);
}

// e3D with either hand: orthographic tracks do not tell them apart. Shapes in the truth's kind of frame.
inline double error_of(const Solution& solution, const Sequence& s, Alignment alignment) {
  Shapes x = solution.reconstruction.shapes;
  if (s.truth_frame == ShapeFrame::camera && solution.reconstruction.frame == ShapeFrame::object)
    for (Eigen::Index f = 0; f < s.frames(); ++f)
      shape_of(x, f) = (completed(solution.reconstruction.rotations[f]) * shape_of(x, f)).eval();
  Shapes other = x;
  if (s.truth_frame == ShapeFrame::camera)
    for (Eigen::Index f = 0; f < s.frames(); ++f) other.row(3 * f + 2) *= -1;
  else
    other *= -1;
  return std::min(e3d(x, *s.truth, alignment), e3d(other, *s.truth, alignment));
}

}  // namespace gonio::nrsfm::testing
