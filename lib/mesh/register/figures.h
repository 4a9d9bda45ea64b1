// What overlaps say: residuals over what is predicted, what of them motions of whole views would explain, and what
// would be left, each with its uncertainty. For register.cpp.
//
// Sum of squares = explained + left, exactly, by least squares of all pairs together. The sigma of what is left comes
// from patches. What is explained has no more independent parts than there are directions, each the square of one draw
// of a pose's error: it would vary by sqrt(2) of itself if the poses were measured again, and so does the figure.
#pragma once
#include <span>

#include "mesh/register/joint_system.h"

namespace gonio::mesh {

struct Split {
  double mean_square = 0, variance = 0;  // of residuals over their sigma
  double explained = 0;                  // of the mean square
  double left = 0, left_variance = 0;
  double p = 1;       // of explaining as much by chance
  Eigen::VectorXd x;  // the motions that explain it
  int held = 0;       // directions
};
Split split_of(std::span<const PairSums> pairs, std::size_t views, std::size_t fixed);

// `pairs`: of `overlaps`, by squares.
std::vector<PairFigures> pair_figures(const std::vector<ViewOverlap>& overlaps, const std::vector<PairSums>& pairs,
                                      const MotionScale& scale);
Consistency consistency_of(const std::vector<ViewOverlap>& overlaps, const std::vector<PairSums>& pairs,
                           std::size_t views, std::size_t fixed);

}  // namespace gonio::mesh
