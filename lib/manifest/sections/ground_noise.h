// "ground_noises": what a process adds to the surfaces that it makes.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct GroundNoisePart {
  double sq_m = 0, cell_m = 0;
  Sigmas sigma;
  std::optional<double> weight;  // of the published form, over layer_m
};
struct GroundNoiseFit {              // "ground_noises"
  std::vector<std::string> reliefs;  // that it was fitted to
  std::vector<GroundNoisePart> parts;
  std::optional<double> white_m;
  Sigmas sigma;
  std::optional<double> layer_m, misfit, log_rms;
  std::optional<std::int64_t> tiles;
  std::vector<double> criterion;  // Schwarz's, for 1, 2, ... parts, less the least
  std::string example;            // name in reliefs of a map made with it
};

}  // namespace gonio::manifest
