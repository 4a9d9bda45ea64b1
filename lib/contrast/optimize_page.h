// The page of `contrast predict --optimize`: the optimum, what holds it, how much each number matters there, and the
// mean contrasts of the surface found.
#pragma once
#include <string>

#include "contrast/optimize.h"

namespace gonio::contrast {

std::string optimize_page(const Optimum& optimum, const Wish& wish, const Prediction& at_optimum);

}  // namespace gonio::contrast
