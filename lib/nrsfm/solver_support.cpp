// Parameters and refusals that solvers share.
#include "nrsfm/solver_support.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace gonio::nrsfm {

SolverParameter free_scales_parameter() {
  const char* meaning = "1: a scale per frame; 0: one for all; -1: free where the camera is perspective";
  return {"free_scales", -1, -1, 1, true, meaning};
}

bool free_scales_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options) {
  const double value = values_in_force(info, options.values).at("free_scales");
  return value < 0 ? sequence.projection == Projection::perspective : value > 0;
}

SolverParameter rank_parameter(const std::string& meaning) {
  return {"rank", 0, 0, 100, true, meaning + "; 0: from the singular values of the tracks"};
}

Eigen::Index terms_from_tracks(const Sequence& sequence, double share, Eigen::Index most) {
  if (!sequence.complete()) return completion_rank(sequence, share, most);
  return rank_of(sequence.tracks.colwise() - sequence.tracks.rowwise().mean(), share, most);
}

Eigen::Index terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                      const std::string& name, double share, Eigen::Index most) {
  const Eigen::Index given = static_cast<Eigen::Index>(values_in_force(info, options.values).at(name));
  const Eigen::Index terms = given > 0 ? given : terms_from_tracks(sequence, share, most);
  require_rank(sequence, terms);
  return terms;
}

SolverParameter dct_terms_parameter() {
  return {"dct_terms", 0, 0, 2000, true, "cosines over time, d; 0: a tenth of the frames, at least twice the rank"};
}

Eigen::Index dct_terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                          Eigen::Index rank) {
  const Eigen::Index frames = sequence.frames();
  const Eigen::Index given = static_cast<Eigen::Index>(values_in_force(info, options.values).at("dct_terms"));
  if (given == 0) return std::min(frames, std::max((frames + 5) / 10, 2 * rank));
  if (given >= rank && given <= frames) return given;
  throw Error(Exit::data, "tracks",
              "dct_terms=" + std::to_string(given) + " with rank " + std::to_string(rank) + " and " +
                  std::to_string(frames) + " frames",
              "set it between the rank and the number of frames");
}

SolverParameter camera_rank_parameter() {
  const char* meaning = "rank at which rotations are estimated; 0: the one that lets the model reproject";
  return {"camera_rank", 0, 0, 100, true, meaning};
}

namespace {

// Of the cameras of each rank those of the highest rank with which a model of `rank` shapes reprojects
// (after a few steps) within 10 % of the best. Cameras of a rank that the sequence's rotation does not support are
// wrong by far, and show in this.
Eigen::Index best_cameras(const Sequence& sequence, Start& start, const std::vector<Upgrade>& upgrades,
                          Eigen::Index rank) {
  const Eigen::Index d = std::min(sequence.frames(), 4 * rank), most = static_cast<Eigen::Index>(upgrades.size());
  std::vector<double> costs;
  for (Eigen::Index k = 1; k <= most; ++k) {
    take_cameras(start, upgrades[static_cast<std::size_t>(k - 1)]);
    ShapeTrajectoryProblem problem = linear_problem(sequence, start, d);
    problem.most_iterations = 4;
    costs.push_back(fit_shape_trajectory(problem, Eigen::MatrixXd::Identity(d, rank)).cost);
  }
  const double limit = 1.1 * 1.1 * *std::min_element(costs.begin(), costs.end());
  Eigen::Index chosen = most;
  while (costs[static_cast<std::size_t>(chosen - 1)] > limit) --chosen;
  return chosen;
}

}  // namespace

Start start_for(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options, Eigen::Index rank,
                Solution& solution) {
  const bool free_scales = free_scales_of(info, sequence, options);
  const bool given = values_in_force(info, options.values).at("camera_rank") > 0;
  const bool guess = !given && !sequence.complete();  // what completion adds supports no more than the model's rank
  Eigen::Index terms = guess ? rank : terms_of(info, sequence, options, "camera_rank", 1e-3, 15);
  Start start = centred_start(sequence, terms);
  const std::vector<Upgrade> upgrades = metric_upgrades(motion_rows(start.w, terms), {free_scales, options.seed});
  if (!given) terms = best_cameras(sequence, start, upgrades, rank);
  take_cameras(start, upgrades[static_cast<std::size_t>(terms - 1)]);
  solution.values["camera_rank"] = static_cast<double>(terms);
  solution.values["free_scales"] = free_scales ? 1 : 0;
  return start;
}

ShapeTrajectoryProblem linear_problem(const Sequence& sequence, const Start& start, Eigen::Index dct_terms) {
  ShapeTrajectoryProblem problem;
  problem.visible = sequence.visible;
  problem.tracks = sequence.tracks.colwise() - start.translation;
  for (Eigen::Index row = 0; row < problem.tracks.rows(); ++row) {
    for (Eigen::Index p = 0; p < problem.tracks.cols(); ++p) {
      if (!sequence.visible(row / 2, p)) problem.tracks(row, p) = 0;
    }
  }
  problem.rows = start.rows;
  problem.omega = dct_basis(sequence.frames(), dct_terms);
  problem.coefficients = [](const Eigen::VectorXd& x) { return x; };
  problem.slope = [](const Eigen::VectorXd& x) { return Eigen::MatrixXd::Identity(x.size(), x.size()); };
  return problem;
}

void fill(const Start& start, const ShapeTrajectory& fit, Solution& solution) {
  solution.reconstruction.shapes = shapes_of(fit.coefficients, fit.basis);
  solution.reconstruction.rotations = start.upgrade.rotations;
  solution.iterations = fit.iterations;
  solution.converged = fit.converged;
  turn_to_first_camera(solution.reconstruction);
}

Eigen::Index shapes_from_tracks(const Sequence& sequence) {
  const Eigen::Index most = std::min(sequence.points() - 1, 2 * sequence.frames()) / 3;
  return std::clamp<Eigen::Index>(terms_from_tracks(sequence, 1e-2, 11) + 1, 1, std::max<Eigen::Index>(most, 1));
}

Eigen::Index shapes_of_model(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options) {
  const Eigen::Index given = static_cast<Eigen::Index>(values_in_force(info, options.values).at("rank"));
  const Eigen::Index rank = given > 0 ? given : shapes_from_tracks(sequence);
  require_rank(sequence, rank);
  return rank;
}

void require_rank(const Sequence& sequence, Eigen::Index terms) {
  const Eigen::Index most = std::min(sequence.points() - 1, 2 * sequence.frames());
  if (3 * terms <= most) return;
  throw Error(Exit::data, "tracks",
              std::to_string(sequence.points()) + " points in " + std::to_string(sequence.frames()) +
                  " frames have no rank of 3 x " + std::to_string(terms),
              "set it to " + std::to_string(most / 3) + " or less");
}

}  // namespace gonio::nrsfm
