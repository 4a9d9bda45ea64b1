// The camera once round the target, 20 degrees over its horizon. (geom/view_path.h)
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> circle_steps(const PatternScene& scene, const PatternNumbers& numbers) {
  return path_steps("circle", scene, numbers);
}

}  // namespace

const ViewPattern& circle() {
  static const ViewPattern pattern{"circle", "The camera once round the target, 20 degrees over its horizon.",
                                   "Jensen et al. 2018, figure 4", path_parameters(), circle_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
