// The camera sideways past the target. (geom/view_path.h)
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> line_steps(const PatternScene& scene, const PatternNumbers& numbers) {
  return path_steps("line", scene, numbers);
}

}  // namespace

const ViewPattern& line() {
  static const ViewPattern pattern{"line", "The camera sideways past the target.", "Jensen et al. 2018, figure 4",
                                   path_parameters(), line_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
