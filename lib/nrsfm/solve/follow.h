// Making what followed.h offers of matrices in memory.
#pragma once
#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "nrsfm/solve/deforming_model.h"
#include "nrsfm/solve/followed.h"
#include "nrsfm/solve/solved_model.h"

namespace gonio::nrsfm {

struct Followed::Parts {
  Parts(Sequence s, DeformingModel m, Outliers o, bool free)
      : sequence(std::move(s)), model(std::move(m)), outliers(std::move(o)), free_scales(free) {}
  Sequence sequence;  // less what does not follow
  DeformingModel model;
  Outliers outliers;
  bool free_scales = false;
  std::vector<std::vector<std::size_t>> seen;     // of every point that takes part: places of frames
  std::vector<std::vector<Eigen::Index>> places;  // the same
  mutable std::once_flag near_camera_asked{};
  mutable NearCamera near_camera{};
  mutable std::atomic<bool> near_camera_known{false};
};
// The truth, if there is any, is not looked at.
Followed follow(const Solved& solved, double false_alarm);

}  // namespace gonio::nrsfm
