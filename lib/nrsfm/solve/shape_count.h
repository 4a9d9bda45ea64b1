// How many basis shapes tracks determine.
//
// More shapes always reproject better; what suffers is what no camera sees. Where cameras turn slowly, the weights of
// many shapes let depth follow the noise and whatever else the model lacks, and reprojection, even of tracks left out,
// does not tell. Halves of the points do: each half alone determines the weights C (shape_trajectory.h), and with
// either all points have shapes S_A, S_B. The error that the next observer would find with K shapes is estimated as
//
//   e^2 = 3/2 r^2 + |S_A - S_B|^2 / n
//
// per coordinate: r^2 what the weights of one half leave of the tracks of the other, over two of the three coordinates;
// the distance of the halves (split-half reliability, Spearman 1910, Brown 1910) stands for the scatter, depth
// included. It is four times the variance of weights found from all points; what both halves share, cameras and frames,
// it does not show. The count with the least e wins; two counts in a row that are worse end the search.
#pragma once
#include "nrsfm/sequence.h"
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {

// Cosines over time where nobody sets them: a tenth of the frames, at least twice the shapes.
Eigen::Index usual_cosines(Eigen::Index frames, Eigen::Index shapes);

// From 1 to `most`; `otherwise` where there are too few points for halves. `start`: cameras and translation.
Eigen::Index determined_shapes(const Sequence& sequence, const Start& start, Eigen::Index most, Eigen::Index otherwise);

}  // namespace gonio::nrsfm
