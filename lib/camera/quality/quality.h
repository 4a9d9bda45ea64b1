// The answer to "how good is this calibration?": what it predicts within over the image, whether halves of the views
// agree, what part of the image they reach, and what to photograph next; numbers, one sentence, and the manifest's
// `quality`.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "camera/quality/coverage.h"
#include "camera/quality/halves.h"
#include "camera/quality/next_views.h"

namespace gonio::camera {

struct Quality {
  std::vector<ProjectionMap> maps;  // one a distance
  double within_px = 0;             // 95 % radius, not exceeded over 95 % of the image, at the worst of the distances
  Halves halves;
  Coverage coverage;
  std::vector<NextView> next;
  std::string verdict;  // one sentence
};

// Distances at which boards are judged where nobody says others: the views' median, and twice that.
std::vector<double> usual_distances(const CameraResult& camera);

// Nothing where the calibration has no covariance. `distances_m`: empty for the usual ones.
std::optional<Quality> judge_quality(const CameraResult& camera, std::vector<double> distances_m = {});

// What to say where the halves differ by more than their uncertainty.
std::string disagreement(const Halves& halves);

manifest::CameraQuality section_of(const Quality& quality);

}  // namespace gonio::camera
