// What was found, in plain English with the units that people use, and the cheapest measurement that would say more.
#pragma once
#include "explain/explanation.h"
#include "explain/wording.h"

namespace gonio::explain {

// Fills `sentence` and `next_measurement`.
void write_sentence(const Problem& problem, Explanation& explanation);

}  // namespace gonio::explain
