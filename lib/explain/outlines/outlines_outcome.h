// What an explanation of rims says, writes and shows. Private to outlines/.
#pragma once
#include <string>

#include "explain/outlines/outline_parameters.h"

namespace gonio::explain {

// Root mean squares of what a named candidate changes: the rims' offsets, the edges' widths, px.
struct Change {
  double offset_px = 0, width_px = 0;
};
Change change_by(const Problem& problem, const OutlinesInput& input, const Explanation& e, std::size_t candidate);
std::string outlines_remarks(const Problem& problem, const OutlinesInput& input, const Explanation& e);
void upgrade_outlines(const Problem& problem, const OutlineModel& model, const OutlinesInput& input,
                      const Explanation& e, manifest::Document& document);
Illustration illustrate_outlines(const OutlinesInput& input, const Observations& o, const Explanation& e);
// mask.caustic: by how many stretches of the shadows' rims lie inside of the model's shadow, beside those outside of
// it.
void conclude_lit(const Problem& problem, const OutlinesInput& input, std::size_t candidate, Explanation& e);

}  // namespace gonio::explain
