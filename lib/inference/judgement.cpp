// See judgement.h.
#include "inference/judgement.h"

#include <algorithm>
#include <cmath>

namespace gonio::inference {
namespace {

// Of all that can be repaired: what an otherwise right model may leave over its own conditions (a facet is no
// Gaussian), and what may be left elsewhere beside a named effect.
constexpr double own_share = 0.35, other_share = 0.5;
// Where a free curve over its own condition takes away most of what is left above the noise, the recordings are clean
// enough to ask for more. While others wait: a law that is the right one leaves next to nothing. When no other is
// content: a law of the right kind in another form (a lobe that is no GGX, a lens that is no polynomial) repairs four
// fifths of what can be repaired over its condition, an imitator less; what it leaves is reported beside it.
constexpr double clean_share_first = 0.02, clean_share_last = 0.2, clean_part = 0.5;
constexpr double price_of_a_look = 10;  // as in the null test
constexpr double clearly_better = 0.1;  // by which a free curve must repair more, as a share of what it repairs

bool repairs(const Hypothesis& h, const Options& options) {
  return h.gain > 2 * h.gain_sigma && h.effect >= options.smallest_effect;
}

// Does any of the candidates declare the condition as a carrier of its signature?
bool declares(const Problem& problem, const std::vector<std::size_t>& candidates, const std::string& condition) {
  return std::any_of(candidates.begin(), candidates.end(), [&](std::size_t c) {
    const std::vector<std::string>& own = problem.candidates()[c].mechanism->conditions;
    return std::find(own.begin(), own.end(), condition) != own.end();
  });
}

struct Left {
  const Competitor* any = nullptr;                        // the free curve that repairs most of what is left
  const Competitor* own = nullptr;                        // the same over a condition that a named mechanism declares
  const SerialCorrelation* serial_correlation = nullptr;  // what no smooth curve follows
  const Interaction* interaction = nullptr;               // what turns round from one condition to another
};
Left structure_left(const Problem& problem, const Selection& s, const Options& options) {
  Left left;
  if (s.after.global_p > options.level) return left;
  const auto tells = [&](const auto& look) {
    return look && price_of_a_look * look->p <= options.level && look->effect >= options.smallest_effect;
  };
  if (tells(s.after.serial_correlation)) left.serial_correlation = &*s.after.serial_correlation;
  if (tells(s.after.interaction)) left.interaction = &*s.after.interaction;
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

std::string objection_to(const Problem& problem, const Selection& s, const Left& left, const Competitor* better,
                         double clean_share) {
  const double repaired = gain(s.base.held_out, s.model.held_out).mean;
  const auto too_much = [&](const Competitor* c, double share) {
    return c != nullptr && c->hypothesis.gain > share * (c->hypothesis.gain + std::max(0.0, repaired));
  };
  const bool clean =
      left.own != nullptr && left.own->hypothesis.gain > clean_part * std::max(0.0, excess(s.model.held_out));
  if (too_much(left.own, clean ? clean_share : own_share))
    return "leaves structure over " + left.own->hypothesis.name + ", its own condition: it only imitates in part";
  if (too_much(left.any, other_share)) return "leaves more than it repairs, over " + left.any->hypothesis.name;
  if (left.serial_correlation != nullptr && left.serial_correlation->power > std::max(0.0, repaired))
    return "leaves more than it repairs, a fine structure along " +
           problem.observations().conditions[left.serial_correlation->condition].name;
  if (left.interaction != nullptr && left.interaction->power > std::max(0.0, repaired))
    return "leaves more than it repairs, over the product of " +
           problem.observations().conditions[left.interaction->first].name + " and " +
           problem.observations().conditions[left.interaction->second].name;
  if (better != nullptr)
    return "a free curve over " + better->hypothesis.name + " repairs more on unseen groups: it only imitates in part";
  return "";
}

// Marks what is part of the set and of no set that stands.
void refuse(const std::vector<std::size_t>& set, const std::vector<std::size_t>& standing, const std::string& why,
            Explanation& e) {
  const auto within = [](const std::vector<std::size_t>& some, const std::vector<std::size_t>& all) {
    return std::all_of(some.begin(), some.end(),
                       [&](std::size_t c) { return std::find(all.begin(), all.end(), c) != all.end(); });
  };
  for (Hypothesis& h : e.scoreboard)
    if (h.refused.empty() && h.kind == Hypothesis::Kind::mechanisms && !h.candidates.empty() &&
        within(h.candidates, set) && !within(h.candidates, standing))
      h.refused = why;
}

}  // namespace

std::string objection(const Problem& problem, const Selection& s, const Options& options) {
  if (s.model.candidates.empty()) return "";
  return objection_to(problem, s, structure_left(problem, s, options), better_curve(s, options), clean_share_first);
}

void judge(const Problem& problem, Selection& s, const Options& options, Explanation& e) {
  e.significant = s.before.global_p <= options.level;
  const Left left = structure_left(problem, s, options);
  const bool remains = left.any != nullptr || left.serial_correlation != nullptr || left.interaction != nullptr;
  if (left.any != nullptr)
    e.outside = outside_of(problem, left.any->condition);
  else if (left.serial_correlation != nullptr)
    e.outside = outside_of(problem, left.serial_correlation->condition);
  else if (left.interaction != nullptr)
    e.outside = outside_of(problem, left.interaction->first);
  if (s.model.candidates.empty()) {
    e.verdict = remains ? Verdict::unknown : Verdict::null;
    e.important = remains;
    return;
  }
  e.important = true;
  const Competitor* better = better_curve(s, options);
  std::string why = objection_to(problem, s, left, better, clean_share_last);
  if (why.empty() && !(e.held_out_after < e.held_out_before))
    why = "the groups that no choice has seen are not the better for it";
  for (const PutAside& p : s.put_aside)
    refuse(p.candidates, why.empty() ? s.model.candidates : std::vector<std::size_t>{}, p.why, e);
  if (!why.empty()) {
    e.verdict = Verdict::unknown;
    if (!e.outside) e.outside = outside_of(problem, (better != nullptr ? *better : s.before.curves.at(0)).condition);
    refuse(s.model.candidates, {}, why, e);
    return;
  }
  e.named = s.model.candidates;
  e.not_told_apart = s.not_told_apart;
  e.instead = s.instead;
  // Finer forms of what is named stand beside it and are no other physics.
  const auto is_form = [&](std::size_t c) { return problem.candidates()[c].finer; };
  const bool only_forms = std::all_of(e.not_told_apart.begin(), e.not_told_apart.end(), [&](const auto& set) {
    return std::all_of(set.begin() + 1, set.end(), is_form);
  });
  e.verdict = only_forms && s.instead.empty() ? Verdict::named : Verdict::ambiguous;
}

}  // namespace gonio::inference
