// What a printer adds at random to everything that it makes, told from the instrument's noise: heights that no picture
// asks for, alike over some pixels, and others in every print.
//
// Where maps show the same pixels twice, differences between them say it: whatever is the same in every print is not in
// them. Otherwise pixels do, about which all layers are even for three pixels. Tiles of 8 x 8 such pixels, each freed
// of a plane, are a Gaussian process with covariance
//   noise^2 (of single pixels) + rms^2 exp(-distance^2 / (2 length^2))
// of which the restricted likelihood (Patterson & Thompson, Biometrika 58, 1971) is largest.
#pragma once
#include <optional>
#include <string>

#include "explain/prints/map_readings.h"

namespace gonio::explain::prints {

struct Ground {
  // Of the surface itself, at a point: means over pixels and the instrument's resolution blur it, which is undone.
  double rms_um = 0, length_px = 0;
  double log_rms_sigma = 0, log_length_sigma = 0;  // standard deviations of their logarithms
  double seen_rms_um = 0;                          // of means over pixels
  double noise_um = 0;                             // of single pixels, beside it
  // Chance that noise of single pixels looks as correlated at any of the lengths that were tried: the likelihood's
  // ratio, on one side of none, times the lengths (Bonferroni).
  double p = 1;
  std::size_t tiles = 0;
  bool between_maps = false;
};
// Nothing where fewer than four tiles can be asked.
std::optional<Ground> ground_of(const Sent& sent, const Readings& readings, double resolution_px);

}  // namespace gonio::explain::prints
