// The interval of one number by profile likelihood: all values at which the rest of the model, fitted anew, is not
// worse by more than the noise allows. Right at a bound and along a flat or bent likelihood, where value plus or minus
// some standard errors is not (Venzon & Moolgavkar, Appl. Stat. 37, 1988).
#pragma once
#include "inference/fit.h"

namespace gonio::inference {

// Needed where the linear interval passes a bound or the neutral value, or where there is none.
bool needs_profile(const Parameter& parameter, const Estimate& linear);
// 95 %, within the parameter's bounds. The fall of the cost that counts as noise is widened by what correlation within
// blocks widens the parameter's variance by (sandwich over model; Rotnitzky & Jewell, Biometrika 77, 1990).
void set_profile_interval(const System& system, const Fit& fit, Estimate& estimate);

}  // namespace gonio::inference
