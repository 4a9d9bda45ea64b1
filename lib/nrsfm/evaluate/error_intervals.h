// How far an error may be from that of a longer sequence of the same kind: block bootstrap over frames (Kuensch 1989;
// circular blocks, Politis & Romano 1992). Neighbouring frames err alike, so that blocks of them are drawn together;
// the alignment is held, which to first order changes nothing where it minimizes the measure. The interval is
// value * exp(+- t s / value), t Student's with frames / block - 1 degrees, s^2 the variance of the draws over
// (1 - c / block) (1 - block / frames): blocks cut correlations at their ends, by c = 2 sum k rho_k / tau frames'
// worth, for a first-order autoregression of memory tau (tau^2 - 1) / (2 tau), and they vary about their own mean.
// Blocks are long and few, 3 to 8, as six times tau would have it: what few degrees of freedom cost in width they give
// back in coverage (batch means: Conway 1963; fixed-b asymptotics: Kiefer & Vogelsang 2005).
// Measured on 400 sequences (scripts/prove nrsfm-intervals; to 2 %), intervals of 90 %, robust-rms / e3d, the sizes of
// errors an autoregression of coefficient a, of memory tau = (1 + a) / (1 - a):
//   a              0         0.6       0.8       0.9       0.95
//   100 frames    92/92 %   90/90 %   93/93 %   91/91 %   87/88 %
//   300 frames                                  94/93 %   93/94 %
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "nrsfm/evaluate/errors.h"

namespace gonio::nrsfm {

enum class Measure { robust_rms, robust_printed, e3d, nrmse, rms, mean_distance };
const std::vector<std::string>& measure_names();  // in the enum's order: "robust-rms", ...

struct IntervalOptions {
  int draws = 200;
  Eigen::Index block = 0;  // frames; 0: from the time over which the frames' errors are correlated
  double confidence = 0.95;
  std::uint64_t seed = 1;
};
struct ErrorInterval {
  double value = 0;  // of the measure
  double sigma = 0, lower = 0, upper = 0;
  Eigen::Index block = 1;
};
// Of shapes that lie on the truth (Aligned::shapes, Aligned::truth). Of fewer than 10 frames, or fewer than 3 blocks
// that were asked for, the interval is [0, infinity): it cannot be told.
ErrorInterval error_interval(const Aligned& aligned, Measure measure, const IntervalOptions& options = {});

// Frames whose errors are correlated: 1 + 2 sum of the autocorrelations, up to the first that is not positive.
double correlated_frames(const std::vector<double>& errors);

}  // namespace gonio::nrsfm
