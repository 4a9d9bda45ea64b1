// See apart.h.
#include "inference/apart.h"

#include <algorithm>

namespace gonio::inference {

void join(const Problem& problem, const Apart& apart, Explanation& e) {
  const Candidate& c = problem.candidates()[apart.candidate];
  Hypothesis h;
  h.name = c.id();
  h.candidates = {apart.candidate};
  h.held_out = apart.without;
  h.effect = apart.effect;
  h.wald_p = apart.p;
  h.parameters = apart.estimates;
  const bool important = h.effect >= e.smallest_effect;
  if (!important) h.refused = "smaller than what matters";
  if (!apart.refused.empty()) h.refused = apart.refused;
  e.scoreboard.push_back(h);
  if (!apart.refused.empty()) return;
  e.global_p = std::min(e.global_p, apart.p);
  e.significant = true;
  if (!important) {
    e.minor.push_back(e.scoreboard.size() - 1);
    return;
  }
  e.important = true;
  e.estimates.insert(e.estimates.end(), h.parameters.begin(), h.parameters.end());
  if (e.verdict == Verdict::unknown) return;
  if (e.verdict == Verdict::null) {
    e.verdict = Verdict::named;
    e.conditions.clear();
    e.stage = c.mechanism->stage;
    e.held_out_before = apart.with;
    e.held_out_after = apart.without;
  }
  e.named.push_back(apart.candidate);
}

}  // namespace gonio::inference
