// From what pixels say by themselves to regions: a random field, and watershed where pixels say nothing.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "reassembly/label_evidence.h"

namespace gonio::reassembly {

// Mean field of a Potts model on the eight neighbours, evidence in, log marginals out (greatest 0). `fixed`: a label
// per pixel that stays, or unlabelled; empty: none.
void smooth(Evidence& evidence, const std::vector<std::int32_t>& fixed);

// Meyer's watershed: labels grow from where they stand into the unlabelled pixels beside them, those first to which the
// way is cheapest. `cost(from, to, label)`: 0 to 1, of the step. Gives the length of the way, in steps.
std::vector<std::uint16_t> flood(int width, int height, std::vector<std::int32_t>& labels,
                                 const std::function<float(std::size_t, std::size_t, std::int32_t)>& cost);

}  // namespace gonio::reassembly
