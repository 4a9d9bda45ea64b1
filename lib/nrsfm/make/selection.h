// Parts of a sequence.
#pragma once
#include <string>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

// Points that at least this share of the frames sees, and two of them.
std::vector<Eigen::Index> often_seen(const Visible& visible, double least_seen);
// That number of frames, in words: "37".
std::string least_frames(const Visible& visible, double least_seen);
// The sequence of these points, of these frames alone.
void keep_points(Sequence& sequence, const std::vector<Eigen::Index>& points);
void keep_frames(Sequence& sequence, const std::vector<Eigen::Index>& frames);

}  // namespace gonio::nrsfm
