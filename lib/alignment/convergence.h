// How each start of an alignment came down to its end, as a plot and a table. Private to alignment/.
#pragma once
#include "alignment/align.h"
#include "report/page.h"

namespace gonio::alignment {

// Offsets of rims against iterations, one line for each start: faint where its end was dropped.
report::Plot convergence_plot(const std::string& body, const std::vector<Tried>& tried);
report::TableText table_of_starts(const std::string& body, const std::vector<Tried>& tried);

}  // namespace gonio::alignment
