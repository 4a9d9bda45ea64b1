// See race.h: forward selection while effects pay, backward elimination, and the search for equals.
#include <algorithm>
#include <cmath>

#include "explain/race.h"

namespace gonio::explain {
namespace {

constexpr std::size_t most_effects = 4;   // more at once than these recordings could carry
constexpr std::size_t pair_partners = 4;  // the best singles, from which pairs are formed where no single one passes

struct Runner {
  Model model;
  Hypothesis hypothesis;
};

std::vector<std::size_t> with(std::vector<std::size_t> set, std::size_t c) {
  set.push_back(c);
  return set;
}
std::vector<std::size_t> without(std::vector<std::size_t> set, std::size_t c) {
  std::erase(set, c);
  return set;
}

std::vector<std::size_t> visible_candidates(const Remainder& r) {
  std::vector<std::size_t> result;
  for (const Isolability& i : r.isolability)
    if (i.visible) result.push_back(i.candidate);
  return result;
}

void sort_runners(std::vector<Runner>& runners) {
  std::stable_sort(runners.begin(), runners.end(),
                   [](const Runner& a, const Runner& b) { return a.hypothesis.gain > b.hypothesis.gain; });
}

// Where no single mechanism can be named, two together might.
void add_pairs(const Race& race, const Model& model, const Remainder& left, std::size_t looks,
               std::vector<Runner>& runners) {
  const std::size_t singles = std::min(runners.size(), pair_partners);
  std::vector<std::vector<std::size_t>> pairs;
  for (std::size_t a = 0; a < singles; ++a)
    for (std::size_t b = a + 1; b < singles; ++b)
      pairs.push_back({runners[a].hypothesis.candidates[0], runners[b].hypothesis.candidates[0]});
  for (const std::vector<std::size_t>& pair : pairs) {
    std::vector<std::size_t> candidates = model.candidates;
    candidates.insert(candidates.end(), pair.begin(), pair.end());
    Model extended = race.changed(model, candidates);
    Hypothesis h = race.judged(model, extended, pair, left.dummies, looks + pairs.size());
    runners.push_back({std::move(extended), std::move(h)});
  }
}

// One round: everything that may join `model`, best first.
std::vector<Runner> run_round(const Race& race, const Model& model, const Remainder& left) {
  const std::vector<std::size_t> starters = visible_candidates(left);
  std::vector<Runner> runners;
  for (const std::size_t c : starters) {
    Model extended = race.changed(model, with(model.candidates, c));
    Hypothesis h = race.judged(model, extended, {c}, left.dummies, starters.size());
    runners.push_back({std::move(extended), std::move(h)});
  }
  sort_runners(runners);
  const auto passes = [](const Runner& r) { return r.hypothesis.refused.empty(); };
  if (std::none_of(runners.begin(), runners.end(), passes)) add_pairs(race, model, left, starters.size(), runners);
  sort_runners(runners);
  return runners;
}

// Effects that another one, found later, has made superfluous.
void eliminate(const Race& race, const Options& options, Model& model) {
  for (bool again = true; again && model.candidates.size() > 1;) {
    again = false;
    for (const std::size_t c : model.candidates) {
      Model smaller = race.changed(model, without(model.candidates, c));
      const Gain g = gain(smaller.held_out, model.held_out);
      if (g.mean > g.sigma && race.effect(smaller, model) >= options.matters) continue;
      model = std::move(smaller);
      again = true;
      break;
    }
  }
}

// Is `other` as good as `best`? Within two standard errors of the paired difference over groups, and not by the groups'
// spread alone: it must also reach half of what the best one gained over `before`.
bool as_good(const Model& before, const Model& best, const Model& other) {
  const Gain apart = gain(other.held_out, best.held_out);
  const Gain of_best = gain(before.held_out, best.held_out), of_other = gain(before.held_out, other.held_out);
  // Twins differ by rounding alone, and by hardly more than its spread.
  return apart.mean <= 2 * apart.sigma + 1e-6 * of_best.mean && of_other.mean >= 0.5 * of_best.mean;
}

// For each named effect, what could stand in its place. A better one takes it.
void find_equals(const Race& race, Selection& s) {
  for (std::size_t place = 0; place < s.model.candidates.size(); ++place) {
    const std::size_t named = s.model.candidates[place];
    Model rest = race.changed(s.model, without(s.model.candidates, named));
    std::vector<std::size_t> equals;
    for (const std::size_t other : race.open_to(rest)) {
      if (other == named) continue;
      std::vector<std::size_t> candidates = s.model.candidates;
      if (std::find(candidates.begin(), candidates.end(), other) != candidates.end()) continue;
      candidates[place] = other;
      const Model exchanged = race.changed(rest, candidates);
      const Hypothesis h = race.judged(rest, exchanged, {other}, {}, 1);
      if (h.refused.empty() && as_good(rest, s.model, exchanged)) equals.push_back(other);
    }
    if (equals.empty()) continue;
    equals.insert(equals.begin(), named);
    s.not_told_apart.push_back(std::move(equals));
  }
}

}  // namespace

Selection select(const Race& race, const Options& options, const std::vector<double>& start, double mismatch_p) {
  Selection s;
  s.base = s.model = race.base(start);
  s.before = s.after = remainder(race, s.base, options);
  s.before.global_p = s.after.global_p = mismatch_p;
  while (s.after.global_p <= options.level && s.model.candidates.size() < most_effects) {
    std::vector<Runner> runners = run_round(race, s.model, s.after);
    for (const Runner& r : runners) {
      s.scoreboard.push_back(r.hypothesis);
      if (!s.model.candidates.empty())
        s.scoreboard.back().name = race.name_of(s.model.candidates) + " + " + r.hypothesis.name;
    }
    const auto winner =
        std::find_if(runners.begin(), runners.end(), [](const Runner& r) { return r.hypothesis.refused.empty(); });
    if (winner == runners.end()) break;
    s.model = std::move(winner->model);
    s.after = remainder(race, s.model, options);
  }
  if (s.model.candidates.size() > 1) {
    const std::size_t size = s.model.candidates.size();
    eliminate(race, options, s.model);
    if (s.model.candidates.size() != size) s.after = remainder(race, s.model, options);
  }
  find_equals(race, s);
  return s;
}

}  // namespace gonio::explain
