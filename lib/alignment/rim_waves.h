// Is what is left along rims what masks make, or does the model not fit? Private to alignment/.
//
// Masks err by some tenths of a pixel, alike over some pixels: smoothing, pixels, the windows of a segmentation. A
// model of another shape or size, a wrong focal length or ground leave long waves, which survive a mean over a longer
// piece. Points of standard deviation s = 0.3 px (RimPoint::sigma_px; in proportion more, where the limit on their rms
// is not the usual 0.75 px), alike over up to 16 px, have means over 32 px of variance s^2 16 / 32; the weighted sum of
// the means' squares over that variance is chi-squared for masks that are as good as stated. It is held against what
// masks are said to be, not against the fit's own scatter, which waves make larger as well. Points that the loss counts
// for nothing (caustics, a spoilt piece of a mask) weigh nothing.
#pragma once
#include "alignment/fit.h"

namespace gonio::alignment {

struct RimWaves {
  double rms_px = 0;    // of the means over pieces
  double limit_px = 0;  // what masks as good as stated exceed in one of a thousand
  std::size_t pieces = 0;
  bool beyond() const { return pieces > 0 && rms_px > limit_px; }
};
// Along the rims of one body and of its shadows. `most_sigma_px`: the limit on the points' rms (AlignWish).
RimWaves rim_waves(const Question& question, const Fitted& fitted, std::size_t body, double most_sigma_px = 0.75);

}  // namespace gonio::alignment
