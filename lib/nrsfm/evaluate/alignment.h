// Laying a reconstruction onto the truth before their distance counts. What is aligned changes the answer by factors
// (pickup of Akhter et al. 2011: 0.24 without rotation, 0.06 with one per frame), so that it always has a name.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <string>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

enum class Alignment {
  none,                     // both centred per frame, nothing else
  global_rotation,          // centred per frame, one rotation for the sequence
  global_similarity,        // one similarity for the sequence, reflection allowed; no centring per frame
  frame_rotation,           // centred and rotated per frame
  frame_similarity,         // centred, rotated and scaled per frame; reflection allowed
  frame_rotation_one_scale  // centred and rotated per frame, one scale for the sequence: depths are known up to it
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

// Three finite numbers; of a fixed few, without a loop.
template <class V>
bool is_finite(const V& v) {
  const double x = v(0), y = v(1), z = v(2);
  return (x - x) + (y - y) + (z - z) == 0;
}

struct ProcrustesOptions {
  bool scale = true, reflection = true, translation = true;
};
// Least squares over columns that are finite in both (Umeyama 1991, equations 34 to 42; reflection: without his S).
Similarity procrustes(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& q, const ProcrustesOptions& options = {});

struct Aligned {
  Shapes shapes;                      // laid onto `truth`; NaN stays
  Shapes truth;                       // as given, or centred per frame over the points that count
  std::vector<Similarity> per_frame;  // from x as given to `shapes`: one for each frame
  std::vector<char> mirrored;         // frames that a reflection was used on
};
// Least squares over the points that are finite in both. `truth` and `x` are 3F x P in frames of reference of the same
// kind (see ShapeFrame). Error(data) where their sizes differ or fewer than half of the frames have 3 points to
// compare; frames with fewer have NaN in `shapes`.
Aligned align(const Shapes& x, const Shapes& truth, Alignment alignment);

// Columns that are finite in both, all frames one behind the other.
struct Matched {
  Eigen::Matrix3Xd x, q;
  std::vector<Eigen::Index> frame;  // of each column
};
Matched matched(const Shapes& x, const Shapes& truth);
// Error(data) at "reconstruction" unless both are 3F x P, with at least 4 points to compare.
void check_comparable(const Shapes& x, const Shapes& truth);

}  // namespace gonio::nrsfm
