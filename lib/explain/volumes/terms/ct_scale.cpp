// ct.scale on walls: they move with their distance from the middle, seen along the normal.
#include "volume/mechanisms/ct_scale.h"

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_scale() {
  static const Term term{.mechanism = mechanism::ct_scale,
                         .order = 100,
                         .forms = {{{"scale"}, false}, {{"scale", "axial"}, true}},
                         .act = [](double value, const Row& row, const Observed& o, std::span<const double> p) {
                           if (row.reading != Reading::wall) return value;
                           return equation::ct_scale(value, p[0], p[1], row.at_m, row.normal, o.voxel_m);
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
