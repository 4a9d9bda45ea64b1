// ct.axis-tilt on walls and the widths of edges.
#include "volume/mechanisms/ct_axis_tilt.h"

#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_axis_tilt() {
  static const Term term{.mechanism = mechanism::ct_axis_tilt,
                         .order = 300,
                         .forms = {{{"tilt_rad", "first_rad"}, false}, {{"wobble_rad"}, false}},
                         .act = [](double value, const Row& row, const Observed& o, std::span<const double> p) {
                           if (row.reading != Reading::wall && row.reading != Reading::width) return value;
                           const double lever = equation::ct_axis_tilt_lever_m(row.at_m, row.normal) / o.voxel_m;
                           if (row.reading == Reading::width) return equation::ct_axis_tilt_width(value, p[2], lever);
                           return equation::ct_axis_tilt(value, p[0], p[1], std::atan2(row.normal.y, row.normal.x),
                                                         lever);
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
