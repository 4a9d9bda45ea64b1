// The report of an alignment: photographs with the model's rims on them, figures, what is left along the rims. Private
// to alignment/.
#pragma once
#include <string>
#include <vector>

#include "alignment/align.h"
#include "alignment/alignment_input.h"

namespace gonio::alignment {

std::string alignment_page(const manifest::Document& document, const AlignmentInput& in,
                           const std::vector<Aligned>& all);

}  // namespace gonio::alignment
