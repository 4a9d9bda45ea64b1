// The report page: what a person reads in a minute. One sentence; where; which curve; how sure; what to measure next.
#pragma once
#include <string>
#include <vector>

#include "inference/explanation.h"

namespace gonio::inference {

struct ReportPart {
  const Problem* problem = nullptr;
  const Explanation* explanation = nullptr;
  const Illustration* illustration = nullptr;
};
// One self-contained HTML page about all domains of a manifest. `name`: of the manifest, for the title.
std::string report_page(const std::string& name, const std::vector<ReportPart>& parts);

}  // namespace gonio::inference
