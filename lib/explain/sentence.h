// What was found, in plain English, and the cheapest measurement that would say more.
#pragma once
#include "explain/explanation.h"

namespace gonio::explain {

// Fills `sentence` and `next_measurement`.
void write_sentence(const Problem& problem, Explanation& explanation);
std::string printed(double value, int digits = 3);  // significant digits, no trailing zeros

}  // namespace gonio::explain
