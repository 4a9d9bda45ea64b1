// Films of shapes that deform with a known camera, solved by the project's own solvers; what they leave out is known.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>

#include "base/random.h"
#include "explain/engine.h"
#include "explain/nrsfm/tracks_problem.h"
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/follow.h"
#include "nrsfm/solve/solver.h"

namespace gonio::explain::testing {

using gonio::nrsfm::Sequence;

struct Film {
  Eigen::Index frames = 20, points = 20, shapes = 2;
  double deformation = 0.25;  // of the mean shape's size
  double size_px = 100;       // root mean square of a coordinate
  double noise_px = 0.3;
  double inverse_focal = 0;  // 1 / px, at a scale of one
  double zoom = 0;           // sigma of the frames' log scales
  double flat = 1;           // factor on the shape's depth where the camera does not turn about it
  double turn_rad = 0.8;
  std::uint64_t seed = 1;
};

inline Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, Random& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal(); });
}

inline Eigen::Matrix3d turned(double x, double y, double z) {
  return (Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

// Weights are the first cosines over time, so that a trajectory basis of that rank is the right model.
inline Sequence film(const Film& f) {
  Random random(f.seed);
  Eigen::MatrixXd basis = f.size_px * normals(3 * f.shapes, f.points, random);
  basis.bottomRows(3 * (f.shapes - 1)) *= f.deformation;
  for (Eigen::Index k = 0; k < f.shapes; ++k) basis.row(3 * k + 2) *= f.flat;
  basis.colwise() -= basis.rowwise().mean().eval();
  const Eigen::MatrixXd weights = std::sqrt(double(f.frames)) * gonio::nrsfm::dct_basis(f.frames, f.shapes);
  Sequence s;
  s.name = "film";
  s.truth = gonio::nrsfm::shapes_of(weights, basis);
  s.tracks.resize(2 * f.frames, f.points);
  for (Eigen::Index k = 0; k < f.frames; ++k) {
    const double t = 2 * M_PI * double(k) / double(f.frames), scale = std::exp(f.zoom * random.normal());
    const Eigen::Matrix3d r =
        turned(f.turn_rad * std::sin(3 * t), f.turn_rad * std::cos(4.3 * t + 0.4), 0.5 * std::sin(0.6 * t));
    const Eigen::Matrix3Xd q = r * gonio::nrsfm::shape_of(*s.truth, k);
    const Eigen::Vector2d shift(40 * std::sin(t), 20 * std::cos(2 * t));
    const Eigen::RowVectorXd near = (1 + f.inverse_focal * scale * q.row(2).array()).inverse().matrix();
    s.tracks.middleRows<2>(2 * k) = ((scale * q.topRows<2>()).colwise() + shift).array().rowwise() * near.array();
    s.cameras.push_back({r, Eigen::Vector3d(shift.x(), shift.y(), 0)});
  }
  s.tracks += f.noise_px * normals(2 * f.frames, f.points, random);
  s.visible = gonio::nrsfm::Visible::Constant(f.frames, f.points, true);
  return s;
}

// The truth itself in the place of a solver's answer: an orthographic model of exactly that shape.
inline gonio::nrsfm::Solved known(const Sequence& s, bool free_scales = false) {
  gonio::nrsfm::Reconstruction r;
  r.name = "truth", r.sequence = s.name, r.shapes = *s.truth;
  for (const gonio::nrsfm::CameraFromObject& c : s.cameras) r.rotations.emplace_back(c.rotation.topRows<2>());
  return {s, r, free_scales, "film"};
}

inline gonio::nrsfm::Solved solved(const Sequence& s, const std::string& solver,
                                   const gonio::nrsfm::SolverValues& values) {
  gonio::nrsfm::SolverOptions options;
  options.values = values;
  const gonio::nrsfm::Solution solution = gonio::nrsfm::solve(*gonio::nrsfm::find_solver(solver), s, options);
  const auto scales = solution.values.find("free_scales");
  return {s, solution.reconstruction, scales != solution.values.end() && scales->second > 0, "film"};
}

// As the manifest's entries name it.
inline std::unique_ptr<Problem> problem_of(const gonio::nrsfm::Solved& solved) {
  gonio::nrsfm::Followed followed = gonio::nrsfm::follow(solved, false_alarm_of_outliers);
  followed.sequence = "film", followed.reconstruction = "film-" + solved.reconstruction.name;
  return tracks_problem(std::move(followed));
}

struct Answer {
  std::unique_ptr<Problem> problem;
  Explanation e;
  std::vector<std::string> named;
  const Estimate* estimate(const std::string& ending) const {
    for (const Estimate& x : e.estimates)
      if (problem->parameters()[x.parameter].name.ends_with(ending)) return &x;
    return nullptr;
  }
};
// Fewer negative controls than the program has: a third of the time.
inline Options quick() {
  Options options;
  options.negative_controls = 6;
  return options;
}
inline Answer explained(const gonio::nrsfm::Solved& solved, const Options& options = quick()) {
  Answer a;
  a.problem = problem_of(solved);
  a.e = explain::explain(*a.problem, options);
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  return a;
}

}  // namespace gonio::explain::testing
