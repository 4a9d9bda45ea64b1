// What was found, in plain English with the units that people use, and the cheapest measurement that would say more.
#pragma once
#include "inference/explanation.h"
#include "inference/wording.h"

namespace gonio::inference {

// Fills `sentence` and `next_measurement`.
void write_sentence(const Problem& problem, Explanation& explanation);

}  // namespace gonio::inference
