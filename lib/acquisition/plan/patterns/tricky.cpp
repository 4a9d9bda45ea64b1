// The camera a little towards the target and back, mostly along its axis. (geom/view_path.h)
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> tricky_steps(const PatternScene& scene, const PatternNumbers& numbers) {
  return path_steps("tricky", scene, numbers);
}

}  // namespace

const ViewPattern& tricky() {
  static const ViewPattern pattern{"tricky", "The camera a little towards the target and back, mostly along its axis.",
                                   "Jensen et al. 2018, figure 4", path_parameters(), tricky_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
