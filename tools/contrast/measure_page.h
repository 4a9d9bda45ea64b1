// The page of `contrast measure`: how strong the contrast is and whether it turns, over camera angles; cells and
// defects as maps; the data matrix; where the sample lay.
#pragma once
#include <string>

#include "contrast/measure/measure.h"

namespace gonio::tools::contrast {

std::string measure_page(const gonio::contrast::Measured& measured, const gonio::contrast::MeasureOptions& options);
// The one sentence that a reader takes away; also printed.
std::string measure_headline(const gonio::contrast::Measured& measured);

}  // namespace gonio::tools::contrast
