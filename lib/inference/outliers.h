// Readings far beyond the noise, too few for a curve over any condition: an object that the manifest leaves out, a
// highlight elsewhere, light from a card. What curves average away is counted here, by its places.
//
// A reading stands out where its residual is more than five times the bulk's width: 1.48 times the median of the
// absolute residuals over sigma, and at least one (Hampel, J. Am. Stat. Assoc. 69, 1974). A few may do so whatever
// there is, as renderers and sensors have tails heavier than Gauss's: it takes eight blocks. Beside an edge a reading
// counts by what is left of its residual when the edge may stand a little elsewhere (Observations::place_error).
#pragma once
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace gonio::inference {

class System;

struct Outliers {
  std::size_t readings = 0, places = 0;                        // places: their blocks
  double power = 0;                                            // their mean square in noise units, over all readings
  double effect = 0;                                           // what --smallest-effect is held against
  std::vector<std::pair<std::size_t, std::size_t>> of_groups;  // group and readings in it, the most first
};
inline bool matter(const std::optional<Outliers>& found, double smallest_effect) {
  return found && found->effect >= smallest_effect;
}

// Of the base model at `values`. Nothing where they are fewer, or where they are no effects to the domain.
std::optional<Outliers> outliers(const System& system, const std::vector<double>& values);

}  // namespace gonio::inference
