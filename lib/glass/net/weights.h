// A network that scripts/glass-net/train made: its folder holds network.onnx and run.json, the record.
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::glass {

// How far a head's answers err, in units of the scale that the network gives them (1 where it gives none): share
// levels[k] of what nothing was learnt from erred by less than quantiles[k] of these.
struct Calibration {
  std::vector<double> levels, quantiles;  // both ascending
  double quantile(double level) const;    // linear between levels; beyond them the last
};

struct Weights {
  std::filesystem::path folder;
  std::vector<char> network;                       // ONNX
  std::string input, light;                        // "rgb", "stokes" or "intensities"; "bare" or "lit"
  std::vector<std::string> heads;                  // in the order of the answer's channels: mask, depth, front, back
  bool scales = false;                             // depth, front, back have one more channel: log of the scale
  int levels = 1;                                  // of the U-Net: sides are multiples of 2^(levels - 1)
  int width_px = 0, height_px = 0;                 // of the pictures that it learnt from
  double temperature = 1;                          // divisor of the mask's logit
  std::map<std::string, Calibration> calibration;  // of heads but the mask; none: nothing is known of their errors
};

// Error(no_input) where there is no such folder or no record, Error(data) where the two do not fit together.
Weights read_weights(const std::filesystem::path& folder);

// Pixels that a step of the network halves and doubles again: tiles begin at multiples of it. How far beyond a pixel it
// looks: tiles overlap by that.
inline int step_of(const Weights& weights) {
  return 1 << (weights.levels - 1);
}
inline int reach_of(const Weights& weights) {
  // Two convolutions of 3 x 3 at each level, down and up, and the interpolation from the level below.
  return 4 * (1 << weights.levels);
}

}  // namespace gonio::glass
