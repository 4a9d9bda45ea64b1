// Rigid factorization: one shape for the whole sequence, seen by orthographic or weak-perspective cameras.
//   W = M S + t 1',  M = [s_f R_f] 2F x 3 (Tomasi & Kanade 1992; scales: Poelman & Kanade 1997)
// The rank-3 factors of W (missing entries completed at rank 3), their metric upgrade, and the shape that visible
// tracks then want. Rank 3 alone does not hold the rows of M to rotations: with refine=1 alternation between cameras
// (each a least squares problem of its own) and the shape goes on to the least reprojection error, the likeliest answer
// for independent normal errors. It is not the preset because tracks of a shape that deforms are not of that kind:
// there a smaller reprojection error buys rotations too small and depths too large (bas-relief).
#include <Eigen/Dense>
#include <cmath>

#include "nrsfm/factorization.h"
#include "nrsfm/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

struct RigidState {
  std::vector<WeakCamera> cameras;
  Eigen::Matrix3Xd shape;
};

void solve_shape(const Sequence& sequence, RigidState& state) {
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      if (!sequence.visible(f, p)) continue;
      const WeakCamera& camera = state.cameras[static_cast<std::size_t>(f)];
      const CameraRows rows = camera.scale * camera.rotation;
      normal += rows.transpose() * rows;
      right += rows.transpose() * (sequence.tracks.block<2, 1>(2 * f, p) - camera.translation);
    }
    state.shape.col(p) = normal.ldlt().solve(right);
  }
}

double solve_cameras(const Sequence& sequence, bool free_scales, RigidState& state) {
  double cost = 0, scale_sum = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const auto tracks = sequence.tracks.middleRows<2>(2 * f);
    WeakCamera& camera = state.cameras[static_cast<std::size_t>(f)];
    camera = fit_camera(tracks, sequence.visible.row(f), state.shape, camera, free_scales);
    scale_sum += camera.scale;
    const Eigen::Matrix2Xd residual =
        (tracks - camera.scale * camera.rotation * state.shape).colwise() - camera.translation;
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (sequence.visible(f, p)) cost += residual.col(p).squaredNorm();
    }
  }
  const double mean = scale_sum / static_cast<double>(sequence.frames());
  for (WeakCamera& camera : state.cameras) camera.scale /= mean;
  state.shape *= mean;
  return cost;
}

class Rigid : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "rigid",
        "rigid factorization",
        "One shape that does not deform; least reprojection error over rotations, scales and points.",
        "Tomasi & Kanade, IJCV 9 (1992), sections 3 and 4; Poelman & Kanade, PAMI 19 (1997)",
        Prior::rigid,
        true,
        true,
        false,
        {{"refine", 0, 0, 1, true, "1: go on to the least reprojection error; 0: factorization alone"},
         free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const bool free_scales = free_scales_of(info(), sequence, options);
    const Start start = start_from(sequence, 1, {free_scales, options.seed});
    Solution solution;
    RigidState state;
    state.shape = start.rows.colPivHouseholderQr().solve(start.w);
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      state.cameras.push_back({start.upgrade.rotations[static_cast<std::size_t>(f)], start.upgrade.scales(f),
                               start.translation.segment<2>(2 * f)});
    }
    const bool refine = values_in_force(info(), options.values).at("refine") > 0;
    const int most = options.most_iterations > 0 ? options.most_iterations : 200;
    const double floor = 1e-24 * start.w.squaredNorm();
    solve_shape(sequence, state);
    double cost = refine ? solve_cameras(sequence, free_scales, state) : 0;
    solution.converged = !refine || cost <= floor;
    while (!solution.converged && solution.iterations < most) {
      solve_shape(sequence, state);
      const double next = solve_cameras(sequence, free_scales, state);
      ++solution.iterations;
      solution.converged = cost - next <= 1e-10 * cost || next <= floor;
      cost = next;
    }
    solution.values = {{"refine", refine ? 1 : 0}, {"free_scales", free_scales ? 1 : 0}};
    fill(sequence, state, solution.reconstruction);
    return solution;
  }

 private:
  static void fill(const Sequence& sequence, const RigidState& state, Reconstruction& answer) {
    answer.shapes.resize(3 * sequence.frames(), sequence.points());
    const Eigen::Vector3d middle = state.shape.rowwise().mean();
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      shape_of(answer.shapes, f) = state.shape.colwise() - middle;
      answer.rotations.push_back(state.cameras[static_cast<std::size_t>(f)].rotation);
    }
    turn_to_first_camera(answer);
  }
};

}  // namespace

const Solver& rigid() {
  static const Rigid solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
