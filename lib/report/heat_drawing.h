// A strip of heat as a drawing that stands alone: cells with their numbers, the rows' names at the left, the columns'
// above. In pages it is a table (report/plot.h).
#pragma once
#include <string>

#include "report/plot.h"

namespace gonio::report {

// What full colour stands for: the strip's limit, else the largest magnitude, else 1.
double full_colour(const HeatStrip& strip);
// A cell's number with as many decimals as `full` needs for two digits, two at least; never "-0.00".
std::string cell_text(double value, double full);
// SVG with colours and fonts of its own.
std::string standalone_svg(const HeatStrip& strip);

}  // namespace gonio::report
