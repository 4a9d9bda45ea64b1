// The camera half round the target, on one side. (geom/view_path.h)
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> half_circle_steps(const PatternScene& scene, const PatternNumbers& numbers) {
  return path_steps("half-circle", scene, numbers);
}

}  // namespace

const ViewPattern& half_circle() {
  static const ViewPattern pattern{"half-circle", "The camera half round the target, on one side.",
                                   "Jensen et al. 2018, figure 4", path_parameters(), half_circle_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
