// Walks ways in steps of a millimetre and looks for solids that meet, by points on surfaces and signed distances: no
// code of lib/acquisition/motion is asked, but for where joints take the links.
#pragma once
#include <string>

#include "acquisition/motion/way.h"

namespace gonio::tests {

struct WayCheck {
  double nearest_m = 1e300;  // of any point of one solid to another; negative: inside
  std::string first, second;
  std::size_t steps = 0;
};
// Points are `spacing_m` apart, steps such that no point travels by more than `step_m`. Links next to each other, what
// a link carries, and what stands still on both sides may meet. Meshes are not looked at.
WayCheck check_way(const acquisition::Laboratory& laboratory, const acquisition::Way& way, double step_m,
                   double spacing_m);

}  // namespace gonio::tests
