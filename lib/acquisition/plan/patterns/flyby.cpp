// The camera past the target and over it. (geom/view_path.h)
#include "acquisition/plan/view_steps.h"

namespace gonio::acquisition::patterns {
namespace {

std::vector<manifest::PlanStep> flyby_steps(const PatternScene& scene, const PatternNumbers& numbers) {
  return path_steps("flyby", scene, numbers);
}

}  // namespace

const ViewPattern& flyby() {
  static const ViewPattern pattern{"flyby", "The camera past the target and over it.", "Jensen et al. 2018, figure 4",
                                   path_parameters(), flyby_steps};
  return pattern;
}

}  // namespace gonio::acquisition::patterns
