// Photographs of a run, with what was found in them.
#pragma once
#include <string>
#include <vector>

#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {

enum class Look { paired, bundled, refracted, reflected, alone };
std::vector<Look> looks_of(const Work& work, std::size_t view);  // of each outline

// The photograph, reduced, with outlines by what became of them and crosses where placed markers should be; for
// report::Figure::svg.
std::string drawing_of(const Work& work, std::size_t view);

}  // namespace gonio::tools::reassemble
