// "contrasts": of two signals, predicted or measured.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct Contrast {                      // "contrasts": of two signals, as `contrast` predicts or measures it
  std::string action, surface, image;  // "predict" | "measure"; name of the surface, id of the image
  std::vector<double> pair_rad;        // rotations of the sample about its normal that are compared
  std::optional<double> tilt_rad, light_rad;
  std::map<std::string, double> parameters;     // of the surface
  std::vector<double> signals;                  // [s1, s2]
  std::optional<double> difference, michelson;  // s1 - s2, (s1 - s2) / (s1 + s2); signed
  Sigmas sigma;
  std::string pattern, placement, partner;  // measure: names of both; id of the image after the turn
  std::optional<double> right;              // measure: share of cells on the right side of the threshold
  std::optional<std::int64_t> cells;        // measure: that counted
};

}  // namespace gonio::manifest
