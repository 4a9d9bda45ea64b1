// The factor between rendering and photograph: photograph = scale * rendering, fitted by weighted least squares.
//
// Both have noise. Where variances are known the line through the origin is York's (York et al., Am. J. Phys. 72, 2004,
// eqs. 13 with the intercept held at zero), which noise in the rendering does not pull towards zero; otherwise every
// sample weighs the same. The standard error is the sandwich over blocks of pixels (Liang & Zeger 1986): honest also
// where the model is wrong, where noise depends on the signal, and where neighbours err together. Clipped pixels take
// no part.
#pragma once
#include <span>

#include "metric/overlay.h"

namespace gonio::metric {

struct Estimate {
  double value = 0, sigma = 0;  // one standard error
};

// One factor for all of `overlays`. Error(data) where the renderings are black.
Estimate fit_exposure(std::span<const Overlay* const> overlays);

}  // namespace gonio::metric
