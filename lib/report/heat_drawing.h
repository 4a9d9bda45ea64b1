// A strip of heat as a drawing that stands alone: cells with their numbers, the rows' names at the left, the columns'
// above. In pages it is a table (report/plot.h).
#pragma once
#include <string>

#include "report/plot.h"

namespace gonio::report {

// SVG with colours and fonts of its own.
std::string standalone_svg(const HeatStrip& strip);

}  // namespace gonio::report
