// See judgement.h.
#include "explain/judgement.h"

#include <algorithm>
#include <cmath>

namespace gonio::explain {
namespace {

// Of all that can be repaired: what an otherwise right model may leave over its own conditions (a facet is no
// Gaussian), and what may be left elsewhere beside a named effect.
constexpr double own_share = 0.35, other_share = 0.5;
// Where a free curve over its own condition takes away most of what is left above the noise, the recordings are clean
// enough to say that the mechanism is not the law; a lens that is no polynomial leaves less than this share.
constexpr double clean_share = 0.02, clean_part = 0.5;
constexpr double price_of_a_trail = 10;  // as in the null test
constexpr double clearly_better = 0.1;   // by which a free curve must repair more, as a share of what it repairs

bool repairs(const Hypothesis& h, const Options& options) {
  return h.gain > 2 * h.gain_sigma && h.effect >= options.matters;
}

// Does any of the candidates declare the condition as a carrier of its signature?
bool declares(const Problem& problem, const std::vector<std::size_t>& candidates, const std::string& condition) {
  return std::any_of(candidates.begin(), candidates.end(), [&](std::size_t c) {
    const std::vector<std::string>& own = problem.candidates()[c].mechanism->conditions;
    return std::find(own.begin(), own.end(), condition) != own.end();
  });
}

struct Left {
  const Competitor* any = nullptr;  // the free curve that repairs most of what is left
  const Competitor* own = nullptr;  // the same over a condition that a named mechanism declares
  const Trail* trail = nullptr;     // what no smooth curve follows
};
Left structure_left(const Problem& problem, const Selection& s, const Options& options) {
  Left left;
  if (s.after.global_p > options.level) return left;
  if (s.after.trail && price_of_a_trail * s.after.trail->p <= options.level && s.after.trail->effect >= options.matters)
    left.trail = &*s.after.trail;
  for (const Competitor& c : s.after.curves) {
    if (!repairs(c.hypothesis, options)) continue;
    if (left.any == nullptr) left.any = &c;
    if (left.own == nullptr && declares(problem, s.model.candidates, c.hypothesis.name)) left.own = &c;
  }
  return left;
}

// Mean square of the held-out residual above the noise, per row.
double excess(const HeldOut& h) {
  double squares = 0, rows = 0;
  for (std::size_t g = 0; g < h.whitened.size(); ++g) squares += h.whitened[g], rows += h.rows[g];
  return rows > 0 ? squares / rows - 1 : 0;
}

// The free curve that repairs clearly more of the base model's misfit than the winner does.
const Competitor* better_curve(const Selection& s, const Options& options) {
  for (const Competitor& c : s.before.curves) {
    if (!repairs(c.hypothesis, options)) continue;
    // Curves are judged linearly: both as falls against the base model as it is judged in either way.
    HeldOut by_curve = s.base.held_out;
    const HeldOut& linear = s.before.evidence->folds->own();
    for (std::size_t g = 0; g < by_curve.whitened.size(); ++g)
      by_curve.whitened[g] -= linear.whitened[g] - c.held_out.whitened[g];
    const Gain apart = gain(s.model.held_out, by_curve);
    if (apart.mean > 2 * apart.sigma && apart.mean > clearly_better * c.hypothesis.gain) return &c;
  }
  return nullptr;
}

Outside outside_of(const Problem& problem, std::size_t condition) {
  Outside outside;
  outside.condition = problem.observations().conditions[condition].name;
  outside.stage = problem.observations().conditions[condition].stage;
  return outside;
}

void refuse(const Selection& s, const std::string& why, Explanation& e) {
  for (Hypothesis& h : e.scoreboard)
    if (h.refused.empty() && h.kind == Hypothesis::Kind::mechanisms && !h.candidates.empty() &&
        std::all_of(h.candidates.begin(), h.candidates.end(), [&](std::size_t c) {
          return std::find(s.model.candidates.begin(), s.model.candidates.end(), c) != s.model.candidates.end();
        }))
      h.refused = why;
}

}  // namespace

void judge(const Problem& problem, Selection& s, const Options& options, Explanation& e) {
  e.significant = s.before.global_p <= options.level;
  const Left left = structure_left(problem, s, options);
  const bool remains = left.any != nullptr || left.trail != nullptr;
  if (left.any != nullptr)
    e.outside = outside_of(problem, left.any->condition);
  else if (left.trail != nullptr)
    e.outside = outside_of(problem, left.trail->condition);
  if (s.model.candidates.empty()) {
    e.verdict = remains ? Verdict::unknown : Verdict::null;
    e.important = remains;
    return;
  }
  e.important = true;
  const double repaired = gain(s.base.held_out, s.model.held_out).mean;
  const auto too_much = [&](const Competitor* c, double share) {
    return c != nullptr && c->hypothesis.gain > share * (c->hypothesis.gain + std::max(0.0, repaired));
  };
  const Competitor* better = better_curve(s, options);
  std::string why;
  const bool clean =
      left.own != nullptr && left.own->hypothesis.gain > clean_part * std::max(0.0, excess(s.model.held_out));
  if (too_much(left.own, clean ? clean_share : own_share))
    why = "leaves structure over " + left.own->hypothesis.name + ", its own condition: it only imitates in part";
  else if (too_much(left.any, other_share))
    why = "leaves more than it repairs, over " + left.any->hypothesis.name;
  else if (left.trail != nullptr && left.trail->power > std::max(0.0, repaired))
    why = "leaves more than it repairs, a fine structure along " +
          problem.observations().conditions[left.trail->condition].name;
  else if (better != nullptr)
    why = "a free curve over " + better->hypothesis.name + " repairs more on unseen groups: it only imitates in part";
  else if (!(e.held_out_after < e.held_out_before))
    why = "the groups that no choice has seen are not the better for it";
  if (!why.empty()) {
    e.verdict = Verdict::unknown;
    if (!e.outside) e.outside = outside_of(problem, (better != nullptr ? *better : s.before.curves.at(0)).condition);
    refuse(s, why, e);
    return;
  }
  e.named = s.model.candidates;
  e.not_told_apart = s.not_told_apart;
  e.verdict = s.not_told_apart.empty() ? Verdict::named : Verdict::ambiguous;
}

}  // namespace gonio::explain
