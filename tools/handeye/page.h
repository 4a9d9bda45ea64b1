// The report page of handeye: a verdict in millimetres, residuals of every pose before and after the refinement,
// methods side by side by their errors at poses left out, uncertainty and correlations, outliers, what to add.
#pragma once
#include <string>

#include "robot/handeye_document.h"

namespace gonio::tools::handeye {

std::string handeye_page(const robot::HandEyeInput& input, const robot::handeye::Analysis& analysis);

}  // namespace gonio::tools::handeye
