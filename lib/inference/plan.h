// What to measure next: which of the measurements that a domain proposes would part the explanations that are not told
// apart, and which would show what these recordings cannot.
//
// Each proposal is predicted under both hypotheses, each with its own refit: d, in standard deviations of its noise.
// What the new group's own numbers could imitate is projected out of d, and what the free parameters' uncertainty
// leaves open counts as noise: z^2 = d' (1 + J C J')^-1 d with C their covariance. The one with the largest z separates
// best (T-optimality: Atkinson & Fedorov, Biometrika 62, 1975).
#pragma once
#include "inference/explanation.h"
#include "inference/system.h"

namespace gonio::inference {

// Fills `e.plan`, the most telling first. `separates` holds two candidates, or one that only became visible.
void make_plan(const System& system, Explanation& e);

}  // namespace gonio::inference
