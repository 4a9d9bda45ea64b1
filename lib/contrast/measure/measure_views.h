// Contrast of single views from the means of their cells. Private to contrast measure.
#pragma once
#include <array>
#include <vector>

#include "contrast/measure/cell_classes.h"
#include "contrast/measure/measure.h"
#include "contrast/measure/measure_input.h"

namespace gonio::contrast {

using Members = std::array<std::vector<std::size_t>, 2>;  // cells of bit 0 and of bit 1
Members members_of(const CellPattern& pattern);

struct ViewFit {
  std::array<ClassFit, 2> of;  // bit
};
ViewFit fit_view(const CellPattern& pattern, const Members& members, const CellMeans& means);

// s1, s2, difference, michelson, right, ratio of the view from its fit.
void enter_contrast(const CellPattern& pattern, const ViewFit& fit, MeasuredView& view);

// Relative deviation of each cell from its class over the class's scatter of it; NaN where it does not count.
std::vector<double> deviations(const CellPattern& pattern, const ViewFit& fit, const CellMeans& means);

// Michelson contrast of two signals with independent errors.
metric::Estimate michelson_of(metric::Estimate a, metric::Estimate b);

// Directions of the cameras: tilt and azimuth in the pattern's frame, and the signed tilt along their main direction in
// the world. NaN for views without a pose; these are told apart by their order alone.
void enter_directions(const Input& input, std::vector<MeasuredView>& views, const std::vector<std::size_t>& of_input);

// Views of both placements that were taken from the same place within a degree; without poses, in the order in which
// they stand, where both placements have as many.
std::vector<std::pair<std::size_t, std::size_t>> partners(const Input& input, const std::vector<MeasuredView>& views,
                                                          const std::vector<std::size_t>& of_input);

}  // namespace gonio::contrast
