// By how much patches of a colour chart differ from what a chart of their reference colours would read, beside noise.
//
// Printed charts deviate from their stated colours by 0.5 to 1 dE from batch to batch and patch to patch, and no camera
// is a mixture of the observer's functions. Neither is physics that was left out of light or sensor; both belong to a
// patch, whatever the exposure. One standard deviation of a reading v in a channel in which a perfect white reads w is
//   greys     s dv/dL*,   L* = 116 (v/w)^(1/3) - 16: a step of lightness, since ink scatters in density
//   colours   k hypot(0.06 v, 0.008 w), at least that of a grey: what a matrix misses of a real camera
// s and k are estimated about the most flexible fit that is worth a question: a matrix, offsets, a response of two
// numbers, light that changes along the chart; so that what may be left out does not count as scatter. Few patches say
// little of their scatter: the estimate is joined with what is usual (as `prior_freedom` patches of that).
// Channels of one patch share its error, and so do pictures of it: the mean over channels is what is estimated, and a
// reading's variance is that times the number of readings of the patch.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::explain::tables {

using Channels = std::array<double, 3>;  // R, G, B

struct ChartPatch {
  Vec3 xyz;                     // under D50, Y of the perfect diffuser 1
  Channels read{};              // mean over pictures, brought to the first one's level
  double across = 0, down = 0;  // place on the chart about its middle, in chart widths; 0: not known
  std::size_t pictures = 1;
};
struct ChartScatter {
  double lightness = 0, colours = 0;  // s, k
  Channels white{};                   // what a perfect white reads
  std::vector<Channels> sigma;        // of one reading of each patch, by channel
};
bool is_grey(Vec3 xyz);  // C*ab below 6
ChartScatter chart_scatter(std::span<const ChartPatch> patches);

}  // namespace gonio::explain::tables
