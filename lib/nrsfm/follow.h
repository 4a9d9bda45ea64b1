// Making what followed.h offers of matrices in memory.
#pragma once
#include <optional>
#include <string>

#include "nrsfm/deforming_model.h"
#include "nrsfm/followed.h"
#include "nrsfm/solved_model.h"

namespace gonio::nrsfm {

struct Followed::Parts {
  Sequence sequence;  // less what does not follow
  DeformingModel model;
  Outlying outlying;
  bool free_scales = false;
  std::vector<std::vector<std::size_t>> seen;     // of every point that takes part: places of frames
  std::vector<std::vector<Eigen::Index>> places;  // the same
};
// The truth, if there is any, is not looked at.
Followed follow(const Solved& solved, double false_alarm);

}  // namespace gonio::nrsfm
