// The report page of compare: the pair under a slider, signed difference, log error, z-scores, histograms, numbers; one
// section per image. Every scale, floor and tone is stated where it is used.
#pragma once
#include <string>
#include <vector>

#include "metric/comparison.h"

namespace gonio::tools::compare {

struct Compared {
  metric::Overlay overlay;
  metric::Measures measures;
  std::vector<std::string> violations;
};
std::string comparison_page(const std::vector<Compared>& images, const metric::Limits& limits);

}  // namespace gonio::tools::compare
