// ct.axis-tilt on walls and the widths of edges. The view whose rays touch a wall is the one that places it; the tilt
// turns the place about these rays, by the lever
//   z |n_xy| - n_z x.m,  m = n_xy / |n_xy|,
// to one side for normals that the views of half a turn meet from the right, to the other for those met from the left.
// Over a whole turn both happen, and the edge is spread instead.
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_axis_tilt();
}

namespace gonio::explain::volumes::terms {

const Term& ct_axis_tilt() {
  static const Term term{.mechanism = mechanism::ct_axis_tilt,
                         .order = 300,
                         .forms = {{{"tilt_rad", "first_rad"}, false}, {{"wobble_rad"}, false}},
                         .act = [](double value, const Row& row, const Observed& o, std::span<const double> p) {
                           if (row.reading != Reading::wall && row.reading != Reading::width) return value;
                           const double level = std::hypot(row.normal.x, row.normal.y);
                           if (!(level > 1e-6)) return value;
                           const double across = (row.at_m.x * row.normal.x + row.at_m.y * row.normal.y) / level;
                           const double lever = (row.at_m.z * level - row.normal.z * across) / o.voxel_m;
                           if (row.reading == Reading::width) return std::hypot(value, p[2] * lever);
                           const double azimuth = std::atan2(row.normal.y, row.normal.x);
                           return value + p[0] * std::tanh(8 * std::sin(azimuth - p[1])) * lever;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
