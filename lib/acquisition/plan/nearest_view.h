// The reachable view that is nearest to one that is not.
#pragma once
#include <optional>

#include "acquisition/plan/candidates.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {

// The camera is moved towards what it looks at and away from it, and about it to neighbouring directions, still
// looking at it; where only the lamp's place cannot be taken, the lamp is moved in that way. The first of them by the
// way that it is moved; nothing within 45 degrees and a third of the distance. With the joints of the candidate nearest
// to home; `robot`: the arm that holds the camera.
std::optional<manifest::PlanStep> nearest_reachable(const CandidateSearch& search, const Configurations& configurations,
                                                    const manifest::PlanStep& step, const std::string& why,
                                                    Vec3 target_m, const std::string& robot);

}  // namespace gonio::acquisition
