// Parameters and refusals that solvers share.
#include "nrsfm/solver_support.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "nrsfm/factorization.h"

namespace gonio::nrsfm {

SolverParameter free_scales_parameter() {
  return {
      "free_scales", -1, -1, 1, true, "1: a scale per frame; 0: one for all; -1: free where the camera is perspective"};
}

bool free_scales_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options) {
  const double value = values_in_force(info, options.values).at("free_scales");
  return value < 0 ? sequence.projection == Projection::perspective : value > 0;
}

SolverParameter rank_parameter(const std::string& meaning) {
  return {"rank", 0, 0, 100, true, meaning + "; 0: from the singular values of the tracks"};
}

Eigen::Index terms_of(const SolverInfo& info, const Sequence& sequence, const SolverOptions& options,
                      const std::string& name, double share, Eigen::Index most) {
  Eigen::Index terms = static_cast<Eigen::Index>(values_in_force(info, options.values).at(name));
  if (terms == 0) {
    const Eigen::MatrixXd w = interpolated(sequence);
    terms = rank_of(w.colwise() - w.rowwise().mean(), share, most);
    if (!sequence.complete()) {  // half of the equations that the least seen point and frame offer
      const Eigen::Index seen = std::min(2 * sequence.visible.colwise().count().minCoeff(),
                                         sequence.visible.rowwise().count().minCoeff() - 1);
      terms = std::clamp<Eigen::Index>(seen / 6, 1, terms);
    }
  }
  require_rank(sequence, terms);
  return terms;
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
