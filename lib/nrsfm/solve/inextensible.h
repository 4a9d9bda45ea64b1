// The deepest surfaces that do not stretch: points on known lines of sight, as far away as distances allow that are the
// same in all frames.
//   max sum_fp z_fp   subject to   |z_fi q_fi - z_fj q_fj| <= d_ij for edges (i, j) whose ends frame f sees,
//   sum_ij d_ij = number of edges,   z >= 0
// A second-order cone program. Its logarithmic barrier (Boyd & Vandenberghe 2004, chapter 11)
//   -t sum z - sum log(d^2 - |z_i q_i - z_j q_j|^2) - sum log z
// is minimized by Newton steps for growing t. On its path the answer is (2 cones + depths) / t from the optimum, which
// is how it knows when to end. Frames meet only in d, so that a step eliminates their depths one frame at a time
// (P x P each) and factors one matrix of the size of the edges: a general solver knows nothing of that.
#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

struct InextensibleProblem {
  std::vector<Eigen::Matrix3Xd> sight;  // per frame: q, the depth of z q is z
  Visible visible;                      // F x P
  std::vector<std::pair<Eigen::Index, Eigen::Index>> edges;
};
struct InextensibleOptions {
  double gap = 1e-5;  // of the sum of depths
  int most_iterations = 300;
};
struct InextensibleDepths {
  Eigen::MatrixXd depths;     // F x P; NaN where no edge of that frame ends at the point
  Eigen::VectorXd distances;  // of the edges
  double sum = 0;             // of the depths: the objective
  double gap = 0;             // the optimum is below sum + gap
  int iterations = 0;
  bool converged = false;
};
InextensibleDepths deepest(const InextensibleProblem& problem, const InextensibleOptions& options = {});

// Each point's `neighbours` nearest by the largest distance that any frame shows, among points that at least half of
// the frames of the less seen one show together; an edge where either is near the other.
std::vector<std::pair<Eigen::Index, Eigen::Index>> neighbour_edges(const std::vector<Eigen::Matrix3Xd>& sight,
                                                                   const Visible& visible, Eigen::Index neighbours);

}  // namespace gonio::nrsfm
