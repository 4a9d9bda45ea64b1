// Parameters and refusals that solvers share.
#pragma once
#include "nrsfm/solver.h"

namespace gonio::nrsfm {

// "free_scales": 1 a scale per frame (weak perspective), 0 one for all (orthographic), -1 as the sequence says.
SolverParameter free_scales_parameter();
bool free_scales_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options);

// "rank": shapes of the basis; 0: from the singular values of the tracks.
SolverParameter rank_parameter(const std::string& meaning);
// The value of `name` where it is set, else the least K that leaves `share` of the tracks' root mean square (missing
// entries interpolated over time), no more than `most`.
Eigen::Index terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                      const std::string& name, double share, Eigen::Index most);

// Error(data, "tracks") where 3 K exceeds the rank that P points less their mean in F frames can have.
void require_rank(const Sequence& sequence, Eigen::Index terms);

}  // namespace gonio::nrsfm
