// The contrast experiment on ridges as geometry: paths traced over a relief of saw-toothed ridges with rounded edges
// and burrs (relief/ridges.h, relief/lobe.h), whose facets and walls are rough like those of the model `ridged`, so
// that without burrs the two agree at walls = 1, up to what is reflected three times and more.
//
// Sigmas: the standard error over patches, each with burrs of its own and paths of its own. They hold both the
// tracing's noise and what another piece of the same surface would give.
#pragma once
#include <cstdint>
#include <vector>

#include "contrast/predict/predict.h"
#include "relief/ridges.h"

namespace gonio::contrast {

struct TracedRidges {
  relief::RidgeShape shape;               // `ridge_rad`, `seed` and `ridges` are set by the experiment
  double alpha_u = 0.05, alpha_v = 0.05;  // Beckmann roughness of the facets
  double eta = 1.5;
  double rho_d = 0;              // of light from beneath, as in `ridged`
  int ridges = 4;                // of one patch
  int patches = 8;               // 2 at least
  std::int64_t paths = 1 << 12;  // per patch and direction
  std::uint64_t seed = 0;
};

// Signals of one ridge angle per setting.
struct TracedSignals {
  std::vector<double> value, sigma;  // laid out as Signals
};
TracedSignals traced_signals(const Experiment& experiment, const std::vector<double>& ridge_rad,
                             const TracedRidges& ridges);
// ... and the experiment's contrasts and means of them. Magnitudes of differences of noise are positive: where the
// signals' errors are as large as the contrast, a mean is biased upwards by up to 0.8 of a difference's sigma.
Prediction traced_prediction(const Experiment& experiment, const std::vector<double>& ridge_rad,
                             const TracedRidges& ridges);

// f with its standard error for each pair of directions, over the patches.
std::vector<Estimate> traced_lobe(const TracedRidges& ridges, double ridge_rad, const std::vector<View>& views);

// The share of the plane that burrs cover, over the patches.
Estimate covered_share(const TracedRidges& ridges, double ridge_rad);

}  // namespace gonio::contrast
