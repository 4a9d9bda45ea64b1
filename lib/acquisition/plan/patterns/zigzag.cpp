// The camera to and fro past the target, nearer and farther by turns. (geom/view_path.h)
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> zigzag_steps(const PatternScene& scene, const PatternNumbers& numbers) {
  return path_steps("zigzag", scene, numbers);
}

}  // namespace

const ViewPattern& zigzag() {
  static const ViewPattern pattern{"zigzag", "The camera to and fro past the target, nearer and farther by turns.",
                                   "Jensen et al. 2018, figure 4", path_parameters(), zigzag_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
