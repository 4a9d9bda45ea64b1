// What align can be told, and what that asks of lib/alignment.
#pragma once
#include <vector>

#include "alignment/alignment_document.h"
#include "cli/program.h"

namespace gonio::tools::align {

std::vector<cli::Option> options();
alignment::AlignmentRequest request_of(cli::Invocation& call);

}  // namespace gonio::tools::align
