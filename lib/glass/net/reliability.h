// Are a network's uncertainties honest? On cells of a set of glass-make(1) with their truth.
//
// Calibration error of depth and normals: the mean over the levels 5, 10 ... 95 % of |share of pixels within the glass
// whose error is below what the network says of that level - level| (Kuleshov, Fenner & Ermon 2018, equation 9,
// absolute instead of squared). Of the mask: pixels in ten bins of the probability, the mean over pixels of |share that
// is glass - mean probability| of their bin (Guo et al. 2017, equation 3).
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "glass/net/weights.h"

namespace gonio::glass {

struct Reliability {
  struct Bin {
    double stated = 0, observed = 0;
    std::size_t pixels = 0;
  };
  std::vector<Bin> bins;       // levels; of the mask: probabilities
  std::vector<Bin> by_fifths;  // pixels by their stated uncertainty, its mean (m, rad) and the share within it
  double calibration_error = 0;
  double mean_error = 0;  // m, rad; of the mask the share of pixels on the wrong side
};
struct SetAnswers {
  std::size_t cells = 0;
  std::map<std::string, Reliability> heads;  // mask; depth, front, back
};

// `share`: "training", "validation", "test". Error(no_input) where the set has none.
SetAnswers answers_of_set(const Weights& weights, const std::filesystem::path& set, const std::string& share);

// As a table of text.
std::string reliability_text(const Weights& weights, const SetAnswers& answers);

}  // namespace gonio::glass
