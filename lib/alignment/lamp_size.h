// How large lamps are, by how wide the edges of shadows are (edge_spread.h).
//
// A place of the lamp that is off its middle by l throws the rim elsewhere by g . l, g the slope of the rim's normal
// offset by the lamp's place (setting.h). Over the disc that a sphere of radius r looks like, which stands across the
// way of the light, l varies by r^2 / 4 along each axis, and the way of the light moves no shadow; so the edge's
// variance is
//   spread^2 = blur^2 + |g|^2 r^2 / 4,
// a line whose slope is the lamp's and whose start is the lens'. Where an edge is bent, or another one is near, it is
// not as wide as that: of a lamp that is no point the shadow of the size found first is simulated (model_region.h), its
// edges are measured in the same way, and stand for |g|^2. All lamps and lenses are found together, by weighted
// least squares with Cauchy's loss; errors are those of stretches of rim (White 1980; Liang & Zeger 1986).
#pragma once
#include <vector>

#include "alignment/alignment_input.h"

namespace gonio::alignment {

struct LampSize {
  double radius_m = 0, sigma_m = 0;                                    // 0: no wider than the lens makes them
  std::size_t edges = 0;                                               // places that were measured; 0: nothing is known
  bool told() const { return radius_m > 3 * sigma_m && sigma_m > 0; }  // from a point
};
// One for each lamp of the setting.
std::vector<LampSize> lamp_sizes(const AlignmentInput& in, const Setting& setting);

// |g|^2 at the points of sighting k, px^2 / m^2, by the simulated shadow of a lamp of `radius_m`, or for 0 of a
// straight edge; NaN where nobody can tell.
std::vector<double> edge_levers(const AlignmentInput& in, const Setting& setting, std::size_t k, double radius_m);

}  // namespace gonio::alignment
