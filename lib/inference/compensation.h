// How far free parameters moved when the missing physics came in. Where an independent calibration says what they are
// (Problem::calibration: the prior of the fit, or a value that the manifest states and the fit did not use), the
// physics that was left out had bent them away from it, and they should come back.
#pragma once
#include <string>

#include "inference/explanation.h"

namespace gonio::inference {

// Completes `explanation.compensation` by what calibrations say.
void compare_with_calibration(const Problem& problem, Explanation& explanation);
// "fx_px of cameras/c moved from 533.1 to 540.2 px, by 9 standard errors, towards its calibration": empty: nothing
// moved by two standard errors.
std::string compensation_in_words(const Problem& problem, const Explanation& explanation);

}  // namespace gonio::inference
