// The page of `contrast predict --optimize`: the optimum, what holds it, how much each number matters there, and the
// mean contrasts of the surface found.
#pragma once
#include <string>

#include "contrast/predict/optimize.h"

namespace gonio::tools::contrast {

std::string optimize_page(const gonio::contrast::Optimum& optimum, const gonio::contrast::Wish& wish,
                          const gonio::contrast::Prediction& at_optimum);

}  // namespace gonio::tools::contrast
