// The ground noise of a printer: what a process adds to every surface that it makes, as a sum of sparse convolution
// noises of different grain, the form of Luongo et al. 2020, section 5,
//   ground(x) = sum_i w_i noise(x / l_i),
// fitted to measured maps together with the instrument's own white noise.
//
// The data are the periodograms of tiles of n x n points, half overlapping, each levelled by a plane and seen through
// Hann's window w; the model is their exact expectation,
//   E P(k) = (dx dy / sum w^2) sum_d C(d) A(d) exp(-2 pi i k.d / n),  A(d) = sum_i w_i w_(i+d),
//   C(d) = sum_i Sq_i^2 C_noise(|d| / l_i) + white^2 [d = 0],
// so that aliasing and leakage are in it (Sykulski et al. 2019, "The debiased Whittle likelihood"). Minimised by Fisher
// scoring: sum over ordinates of ln E P + P / E P, Whittle 1953, in the logarithms of Sq_i^2, l_i and white^2, over the
// frequencies from three cycles a tile on, which levelling hardly touches.
//
// Sigmas: the larger of two. The model's: inverse information, times 3.78 because Hann's window correlates neighbouring
// ordinates (power by 4 / 9 and 1 / 36 at one and two steps, along both axes), times 1.11 for the tiles' overlap (1 /
// 36 each side). And a sandwich about the scatter of the tiles' scores, which knows nothing of the form. The number of
// parts is the one of least Schwarz criterion, its likelihood divided by the same 4.2.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/height_map.h"
#include "relief/noise.h"

namespace gonio::relief {

struct GroundPart {
  double sq_m = 0, cell_m = 0, sigma_sq_m = 0, sigma_cell_m = 0;
  // w_i of the published form, for noise of the standard deviation noise_sigma(), over the printer's layer thickness
  double weight(double layer_m) const { return sq_m / (noise_sigma() * layer_m); }
};
struct GroundNoise {
  std::vector<GroundPart> parts;  // coarse to fine
  double white_m = 0, sigma_white_m = 0;
  double misfit = 0;   // variance of mean P / E P about 1, over that of exponential P: 1 where the form is right
  double log_rms = 0;  // root mean square of ln(mean P / E P) over bands of frequency
  std::vector<double> criterion;  // Schwarz's, for 1, 2, ... parts, less the least
  std::size_t tiles = 0;
  std::vector<double> band_per_m, measured_m4, modelled_m4;  // spectrum by bands of |f|, for a plot
};
struct GroundOptions {
  int parts = 0;  // 0: chosen from 1 to most_parts
  int most_parts = 3;
};
// Maps as measured, gaps of at most 2 % a tile. Error(data) at the map's place where there are fewer than eight tiles.
GroundNoise fit_ground_noise(const std::vector<io::HeightMap>& maps, const std::vector<std::string>& places,
                             const GroundOptions& options = {});

}  // namespace gonio::relief
