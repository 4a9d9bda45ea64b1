// Parameters and refusals that solvers share.
#pragma once
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/shape_trajectory.h"
#include "nrsfm/solve/solver.h"

namespace gonio::nrsfm {

// "free_scales": 1 a scale per frame (weak perspective), 0 one for all (orthographic), -1 as the sequence says.
SolverParameter free_scales_parameter();
bool free_scales_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options);

// "rank": shapes of the basis; 0: as many as the tracks determine (shape_count.h), unless `chosen` says otherwise.
SolverParameter rank_parameter(const std::string& meaning,
                               const std::string& chosen = "as many as halves of the points agree on");
// The value of `name` where it is set, else the least K that leaves `share` of the tracks' root mean square, no more
// than `most`.
Eigen::Index terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                      const std::string& name, double share, Eigen::Index most);

// That K by itself; where tracks are missing, the one that predicts tracks which it has not seen (completion_rank).
Eigen::Index terms_from_tracks(const Sequence& sequence, double share, Eigen::Index most);

// "dct_terms": cosines of the trajectories in shape space; 0: a tenth of the frames, at least twice the rank.
SolverParameter dct_terms_parameter();
Eigen::Index dct_terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                          Eigen::Index rank);

// "camera_rank": rank K at which rotations are estimated (metric_upgrade); -1: those of a rigid shape with the least
// reprojection error (rigid_motion.h); 0: of all these the ones that let `rank` shapes reproject and be small together.
SolverParameter camera_rank_parameter();
// Rotations at that rank; records "camera_rank" and "free_scales" in solution.values.
Start start_for(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options, Eigen::Index rank,
                Solution& solution);

// C = Omega_d X, the tracks of `sequence` less the start's translation.
ShapeTrajectoryProblem linear_problem(const Sequence& sequence, const Start& start, Eigen::Index dct_terms);
// Shapes, rotations and convergence of a fit.
void fill(const Start& start, const ShapeTrajectory& fit, Solution& solution);

// One shape more than leaves 1 % of the tracks: smooth weights need not contain a constant. So many reproject; how many
// are determined is another question.
Eigen::Index shapes_from_tracks(const Sequence& sequence);
// "rank" where it is set, else as many as the tracks determine with the cameras that suit shapes_from_tracks().
Eigen::Index shapes_of_model(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options);

// Error(data, "tracks") where 3 K exceeds the rank that P points less their mean in F frames can have.
void require_rank(const Sequence& sequence, Eigen::Index terms);

}  // namespace gonio::nrsfm
