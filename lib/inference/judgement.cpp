// See judgement.h.
#include "inference/judgement.h"

#include <algorithm>
#include <cmath>

#include "inference/wording.h"

namespace gonio::inference {
namespace {

using Set = std::vector<std::size_t>;

// Of 11 answers "unknown" to the development seeds of scripts/prove wild and to the sealed pictures, 6 were outside.
constexpr double where_it_errs_outside = 0.55;
constexpr double nearly_one = 0.99;  // of what the plainer form repairs
constexpr double equal_errors = 2;   // of the paired difference: what is within them was not told apart by recordings
constexpr std::size_t most_listed_beside = 2;

bool contains(const Set& set, std::size_t c) {
  return std::find(set.begin(), set.end(), c) != set.end();
}
bool within(const Set& some, const Set& all) {
  return std::all_of(some.begin(), some.end(), [&](std::size_t c) { return contains(all, c); });
}

// The place in `a` of the only one that is another in `b`; nothing where they differ otherwise.
std::optional<std::size_t> only_exchange(const Set& a, const Set& b) {
  if (a.size() != b.size()) return std::nullopt;
  std::optional<std::size_t> place;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (contains(b, a[k])) continue;
    if (place) return std::nullopt;
    place = k;
  }
  return place;
}
std::size_t the_other(const Set& a, const Set& b) {
  return *std::find_if(b.begin(), b.end(), [&](std::size_t c) { return !contains(a, c); });
}

// One mechanism on the same things, in another form (a power law and a spline of one response), or on some of them.
bool same_physics(const Problem& problem, std::size_t a, std::size_t b) {
  const Candidate &one = problem.candidates()[a], &other = problem.candidates()[b];
  return is_within(one, other) || is_within(other, one);
}

// Is `f` the likeliest set in another form of one of its mechanisms? Two forms of one thing are no two explanations.
bool is_form(const Problem& problem, const Finalist& top, const Finalist& f) {
  const std::optional<std::size_t> place = only_exchange(top.model.candidates, f.model.candidates);
  if (!place || !f.refused.empty()) return false;
  const std::size_t other = the_other(top.model.candidates, f.model.candidates);
  if (same_physics(problem, top.model.candidates[*place], other)) return true;
  return problem.candidates()[other].finer && !problem.candidates()[top.model.candidates[*place]].finer &&
         f.gained >= nearly_one * top.gained;
}

// What speaks most against a set beside the likeliest one.
std::string objection(const Finalist& f, const Finalist& top) {
  if (!f.refused.empty()) return f.refused;
  const Member own{Member::Kind::set, f.statistics}, best{Member::Kind::set, top.statistics};
  std::string_view worst;
  double most = 0;
  for (const LogitTerm& t : logit_terms()) {
    const double against = t.weight * (t.of(best) - t.of(own));
    if (against > most) most = against, worst = t.name;
  }
  const Statistics& s = f.statistics;
  if (worst == "clean" || (worst == "short" && s.own >= std::max(s.missed, s.any)))
    return "leaves structure over " + f.left.own_over + ", its own condition: it only imitates in part";
  if (worst == "short" && s.any >= s.missed) return "leaves structure " + f.left.any_over;
  if (worst == "curve")
    return "a free curve over " + f.curve + " repairs more on unseen groups: it only imitates in part";
  if (worst == "behind" || worst == "short") return "another repairs more on unseen groups";
  if (worst == "numbers") return "needs more numbers";
  if (worst == "size") return "larger than such an effect is";
  if (worst == "controls") return "negative controls without physics do better";
  if (worst == "weakest" || worst == "times" || worst == "more") return "one of its mechanisms does too little";
  return "less likely";
}

void mark(const Selection& s, const Explanation& e, const Finalist& top, Hypothesis& h) {
  if (!h.refused.empty() || h.kind != Hypothesis::Kind::mechanisms || h.candidates.empty()) return;
  const Finalist* own = nullptr;  // the likeliest set that holds it
  for (const Finalist& f : s.finalists->list()) {
    if (!within(h.candidates, f.model.candidates)) continue;
    if (own == nullptr || f.probability > own->probability) own = &f;
  }
  if (own == nullptr) return;
  for (const auto& listed : {e.not_told_apart, e.instead})
    for (const Set& set : listed)
      if (within(h.candidates, set)) return;
  if (e.named.empty() || !within(h.candidates, e.named))
    h.refused =
        (own == &top ? std::string("unlikely") : objection(*own, top)) + " (" + share_in_words(own->probability) + ")";
}

Explanation::Weighed weighed_as(Explanation::Weighed::Kind kind, const Set& candidates, double probability,
                                const Statistics& of) {
  Explanation::Weighed w{kind, candidates, std::min(1.0, probability), {}, {}};
  for (const Statistic& s : statistics())
    if (of.*s.value != 0) w.statistics.emplace_back(s.name, of.*s.value);
  return w;
}

void list_weighed(const Finalists& finalists, Explanation& e) {
  using Kind = Explanation::Weighed::Kind;
  const std::vector<Member> members = finalists.members();
  e.weighed = {weighed_as(Kind::nothing, {}, finalists.nothing(), members[0].statistics),
               weighed_as(Kind::outside, {}, finalists.outside(), members[1].statistics)};
  for (const Finalist& f : finalists.list())
    if (f.refused.empty()) {
      e.weighed.push_back(weighed_as(Kind::set, f.model.candidates, f.probability, f.statistics));
      e.weighed.back().values = f.model.fit.values;
    }
  std::stable_sort(e.weighed.begin(), e.weighed.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
}

void begin_outside(const Problem& problem, const LeftOver& left, const ResidualStructure& before, bool unknown,
                   Explanation& e) {
  std::optional<std::size_t> condition = left.condition;
  if (!condition && unknown && !matter(before.outliers, e.smallest_effect) && !before.curves.empty())
    condition = before.curves[0].condition;
  if (!condition) return;
  Outside outside;
  outside.condition = problem.observations().conditions[*condition].name;
  outside.stage = problem.observations().conditions[*condition].stage;
  e.outside = outside;
}

// The sets that are listed, by how they differ from the first.
void name_listed(const Problem& problem, const std::vector<Finalist>& list, const std::vector<std::size_t>& listed,
                 Explanation& e) {
  const Finalist& top = list[listed[0]];
  e.named = top.model.candidates;
  std::vector<Set> beside(e.named.size());
  const auto stand_in = [&](std::size_t place, std::size_t other) {
    if (same_physics(problem, e.named[place], other)) return;
    if (!contains(beside[place], other)) beside[place].push_back(other);
  };
  for (std::size_t k = 1; k < listed.size(); ++k) {
    const Set& other = list[listed[k]].model.candidates;
    if (const std::optional<std::size_t> place = only_exchange(e.named, other))
      stand_in(*place, the_other(e.named, other));
    else
      e.instead.push_back(other);
  }
  e.verdict = listed.size() == 1 ? Verdict::named : Verdict::ambiguous;
  for (const Finalist& f : list)
    if (is_form(problem, top, f))
      stand_in(*only_exchange(e.named, f.model.candidates), the_other(e.named, f.model.candidates));
  for (std::size_t place = 0; place < beside.size(); ++place) {
    if (beside[place].empty()) continue;
    beside[place].insert(beside[place].begin(), e.named[place]);
    e.not_told_apart.push_back(beside[place]);
  }
}

// Place of a set among the members, behind nothing and outside.
std::size_t member_of(const std::vector<std::size_t>& places, const std::vector<Finalist>& list, const Finalist& f) {
  const auto own = static_cast<std::size_t>(&f - list.data());
  return static_cast<std::size_t>(std::ranges::find(places, own) - places.begin()) + 2;
}

// Forms of the likeliest set count for it.
std::vector<double> by_physics(const Problem& problem, const std::vector<Finalist>& list, const Finalist& top,
                               const std::vector<std::size_t>& places, std::vector<double> p) {
  const std::size_t at = member_of(places, list, top);
  for (std::size_t k = 0; k < places.size(); ++k)
    if (is_form(problem, top, list[places[k]])) p[at] += p[k + 2], p[k + 2] = 0;
  return p;
}

// What was named alone by its plausible sizes or its few numbers, while unseen groups cannot tell another, no larger
// set from it that repairs as much: the recordings decide what is told apart, priors only what comes first.
void add_equals(const Problem& problem, const std::vector<Finalist>& list, std::vector<std::size_t>& listed,
                double& probability) {
  if (listed.size() != 1) return;
  const Finalist& top = list[listed[0]];
  std::vector<std::size_t> equal;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Finalist& f = list[k];
    if (k == listed[0] || !f.refused.empty() || f.statistics.times < 0 || is_form(problem, top, f)) continue;
    if (f.model.candidates.size() > top.model.candidates.size() || f.statistics.numbers > top.statistics.numbers)
      continue;
    if (f.statistics.behind <= equal_errors && f.gained >= nearly_one * top.gained) equal.push_back(k);
  }
  std::stable_sort(equal.begin(), equal.end(),
                   [&](std::size_t a, std::size_t b) { return list[a].probability > list[b].probability; });
  equal.resize(std::min(equal.size(), most_listed_beside));
  for (const std::size_t k : equal) {
    listed.push_back(k);
    probability = std::min(1.0, probability + list[k].probability);
  }
}

// Of many sets that differ in what else there is, what all of them hold is sure: that is the answer, alone where
// nothing else is likelier than something, else beside the likeliest of the sets that hold more.
Answer part_in_common(const Finalists& finalists, const Finalist& top, const std::vector<std::size_t>& places,
                      const std::vector<double>& p) {
  const std::vector<Finalist>& list = finalists.list();
  const std::size_t own = member_of(places, list, top);
  Answer found{Answer::Kind::sets, {own}, finalists.inclusion(top)};
  if (p[own] >= likelier_than_not * found.probability) return found;
  std::vector<std::size_t> larger;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Finalist& f = list[places[k]];
    if (matters(f) && f.model.candidates.size() > top.model.candidates.size() && finalists.holds(f, top))
      larger.push_back(k + 2);
  }
  std::ranges::stable_sort(larger, [&](std::size_t a, std::size_t b) { return p[a] > p[b]; });
  std::vector<const Finalist*> told;
  found.probability = p[own];
  for (const std::size_t k : larger) {
    const Finalist& f = list[places[k - 2]];
    const bool again =
        std::ranges::any_of(told, [&](const Finalist* t) { return finalists.holds(*t, f) && finalists.holds(f, *t); });
    if (again) {  // another form
      found.probability += p[k];
    } else if (told.size() + 1 < most_listed) {
      told.push_back(&f);
      found.sets.push_back(k);
      found.probability += p[k];
    }
  }
  return found;
}

// What is likeliest as a whole need not be the likeliest single set.
void put_first(const std::vector<Finalist>& list, std::size_t top, std::vector<std::size_t>& listed,
               double& probability) {
  const auto place = std::find(listed.begin(), listed.end(), top);
  if (place != listed.end()) {
    std::rotate(listed.begin(), place, place + 1);
    return;
  }
  listed.insert(listed.begin(), top);
  probability = std::min(1.0, probability + list[top].probability);
}

// Of several that the first set shares no mechanism with, and that unseen groups cannot tell from it, one stands beside
// it: exchanges of single members do not say that the whole may be something else.
void add_unlike(const std::vector<Finalist>& list, std::vector<std::size_t>& listed, double& probability) {
  const Finalist& top = list[listed[0]];
  const auto unlike = [&](const Finalist& f) {
    return std::none_of(f.model.candidates.begin(), f.model.candidates.end(),
                        [&](std::size_t c) { return contains(top.model.candidates, c); });
  };
  if (top.model.candidates.size() < 2) return;
  for (const std::size_t k : listed)
    if (unlike(list[k])) return;
  std::optional<std::size_t> likeliest;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Finalist& f = list[k];
    if (!f.refused.empty() || f.statistics.times < 0 || !unlike(f)) continue;
    if (f.statistics.behind > equal_errors || f.gained < nearly_one * top.gained) continue;
    if (!likeliest || f.probability > list[*likeliest].probability) likeliest = k;
  }
  if (!likeliest) return;
  listed.push_back(*likeliest);
  probability = std::min(1.0, probability + list[*likeliest].probability);
}

}  // namespace

double share_outside(Simulator simulator) {
  return simulator == Simulator::exact ? 1 : where_it_errs_outside;
}

void judge(const Problem& problem, const Selection& s, const Options& options, Explanation& e) {
  const Finalists& finalists = *s.finalists;
  const std::vector<Finalist>& list = finalists.list();
  e.significant = s.before.global_p <= options.level;
  e.outliers = s.before.outliers;
  list_weighed(finalists, e);
  const Finalist* top = finalists.likeliest();
  const LeftOver at_first = left_over(problem, {}, s.before, options);
  std::vector<std::size_t> places;
  const std::vector<Member> members = finalists.members(&places);
  std::vector<double> p = probabilities(members, problem.simulator());
  if (top != nullptr) p = by_physics(problem, list, *top, places, std::move(p));
  Answer found = answer(members, p, options.sure);
  if (top != nullptr && found.probability < options.sure && finalists.inclusion(*top) >= options.sure)
    found = part_in_common(finalists, *top, places, p);
  if (!e.significant) found = {Answer::Kind::nothing, {}, finalists.nothing()};
  // The groups that no choice has seen speak last.
  const bool no_better = found.kind == Answer::Kind::sets && !(e.held_out_after < e.held_out_before);
  if (no_better) found = {Answer::Kind::outside, {}, finalists.outside()};
  e.probability = std::min(1.0, found.probability);
  if (found.kind == Answer::Kind::nothing) {
    e.verdict = Verdict::null;
  } else if (found.kind == Answer::Kind::outside) {
    e.verdict = Verdict::unknown;
    e.probability *= share_outside(problem.simulator());
  } else {
    std::vector<std::size_t> listed;
    for (const std::size_t k : found.sets) listed.push_back(places[k - 2]);
    put_first(list, static_cast<std::size_t>(top - list.data()), listed, e.probability);
    add_equals(problem, list, listed, e.probability);
    add_unlike(list, listed, e.probability);
    name_listed(problem, list, listed, e);
  }
  e.important = e.verdict != Verdict::null;
  if (e.verdict != Verdict::null)
    begin_outside(problem, e.named.empty() ? at_first : top->left, s.before, e.verdict == Verdict::unknown, e);
  if (top != nullptr)
    for (Hypothesis& h : e.scoreboard) mark(s, e, *top, h);
  if (no_better)
    for (Hypothesis& h : e.scoreboard)
      if (top != nullptr && within(h.candidates, top->model.candidates) && !h.candidates.empty())
        h.refused = "the groups that no choice has seen are not the better for it";
}

}  // namespace gonio::inference
