// Laying a reconstruction onto the truth before their distance counts. What is aligned changes the answer by factors
// (pickup of Akhter et al. 2011: 0.24 without rotation, 0.06 with one per frame), so that it always has a name.
#pragma once
#include <string>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

enum class Alignment {
  none,               // both centred per frame, nothing else
  global_rotation,    // centred per frame, one rotation for the sequence
  global_similarity,  // one similarity for the sequence, reflection allowed; no centring per frame
  frame_rotation,     // centred and rotated per frame
  frame_similarity    // centred, rotated and scaled per frame; reflection allowed
};
const std::vector<std::string>& alignment_names();  // in the enum's order: "none", "global-rotation", ...

// q ~ scale * rotation * x + translation; rotation may be a reflection (determinant -1) where that is allowed.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  bool mirrored() const { return rotation.determinant() < 0; }
};
Eigen::Matrix3Xd moved(const Similarity& s, const Eigen::Matrix3Xd& x);

struct ProcrustesOptions {
  bool scale = true, reflection = true, translation = true;
};
// Least squares over columns that are finite in both (Umeyama 1991, equations 34 to 42; reflection: without his S).
Similarity procrustes(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& q, const ProcrustesOptions& options = {});

struct Aligned {
  Shapes shapes;                      // in the truth's frame and unit; NaN stays
  std::vector<Similarity> per_frame;  // one, or one for each frame
  std::vector<char> mirrored;         // frames that only a reflection lays onto the truth
};
// Least squares. `truth` and `x` are 3F x P in frames of reference of the same kind (see ShapeFrame).
Aligned align(const Shapes& x, const Shapes& truth, Alignment alignment);

}  // namespace gonio::nrsfm
