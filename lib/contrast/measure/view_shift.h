// Refinement of one view: the displacements of the pattern's corners in the picture that lay the pattern onto it best,
// within what its pose, or its marks, leave open.
//
// A picture M of the pattern is drawn: cells of their mean brightness, which goes from one to the next linearly over a
// width W about their border. The photograph I is softened by n passes of [1 2 1] / 4, and W = sqrt(1 + 6 n) px has the
// variance of a pixel and of these passes; n grows with how far the place is still open, so that borders that lie
// beside each other touch. With d the eight coordinates of the displacements (contrast/measure/view_map.h) and C their
// prior covariance, minimise over the pixels
//     sum (I - M(d))^2 / (r^2 N) + d' C^-1 d
// by Gauss and Newton. Slopes are those of the drawing, not of the photograph, whose noise has slopes, too. r^2 is the
// mean square of what remains, weighted with the squared slopes: as large as it is at the borders. N pixels share one
// error by the softening. How far the lens blurs does not shift the borders and need not be known.
//
// A wrong place makes errors of cells in proportion to the contrast at their borders, and it is found in proportion to
// the same contrast: after the refinement what is left of such errors lies below the noise. Where there is no contrast,
// the prior stays, and does no harm.
#pragma once
#include <vector>

#include "contrast/measure/pattern.h"
#include "contrast/measure/segmentation.h"
#include "contrast/measure/view_map.h"

namespace gonio::contrast {

struct ViewShift {
  CornerShifts by_px{};
  CornerCovariance covariance{};
  double distance2 = 0;   // d' C^-1 d
  bool credible = false;  // which is not beyond what the prior allows
};
// `brightness[cell]`; NaN where it is not known. `prior`: of the map's corners; `start`: displacements from there, open
// by `sigma_px`.
ViewShift lay_onto(const GreyView& view, const CellPattern& pattern, const ViewMap& map,
                   const std::vector<double>& brightness, const CornerCovariance& prior, double sigma_px,
                   const CornerShifts& start = {});

}  // namespace gonio::contrast
