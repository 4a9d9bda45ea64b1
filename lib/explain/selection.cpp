// See race.h: forward selection while effects pay, pairs where single effects cancel, backward elimination.
#include <algorithm>
#include <cmath>

#include "explain/screening.h"
#include "stats/distributions.h"

namespace gonio::explain {
namespace {

// A fit inside the simulator may reach further than the linear form of its mechanism did; beyond this factor it never
// overtook in the tests of strongly nonlinear mechanisms.
constexpr double allowance = 3;
constexpr std::size_t most_pairs_fitted = 4;
constexpr std::size_t most_leaders = 4;
constexpr double leading_share = 0.6;  // of the best gain: may be the winner once fitted to the end

struct Runner {
  Model model;
  Hypothesis hypothesis;
  bool polished = false;  // fitted to the end with derivatives of its own
};

std::vector<std::size_t> with(std::vector<std::size_t> set, const std::vector<std::size_t>& more) {
  set.insert(set.end(), more.begin(), more.end());
  return set;
}
std::vector<std::size_t> without(std::vector<std::size_t> set, std::size_t c) {
  std::erase(set, c);
  return set;
}

bool passes(const Runner& r) {
  return r.hypothesis.refused.empty();
}

std::size_t numbers_of(const Race& race, const std::vector<std::size_t>& candidates) {
  std::size_t count = 0;
  for (const std::size_t c : candidates) count += race.system().problem().candidates()[c].parameters.size();
  return count;
}

void sort_runners(std::vector<Runner>& runners) {
  std::stable_sort(runners.begin(), runners.end(),
                   [](const Runner& a, const Runner& b) { return a.hypothesis.gain > b.hypothesis.gain; });
}

// One round: what may join `model`, screened linearly, the furthest-reaching fitted, best first.
class Round {
 public:
  Round(const Race& race, const Effort& effort, const Model& model, const Remainder& left)
      : race_(race), effort_(effort), model_(model), left_(left), screening_(race, left) {
    if (screening_.singles().empty()) return;
    kept_ = race.slopes_at(model);
    for (const double rows : left.evidence->folds->own().rows) rows_ += rows;
    run_singles();
    run_pairs();
    sort_runners(runners_);
    polish_leaders();
  }
  std::vector<Runner>& runners() { return runners_; }
  // Those that the screening left behind, as lines of the scoreboard.
  std::vector<Hypothesis> screened_out() const {
    std::vector<Hypothesis> list;
    for (std::size_t k = fitted_; k < screening_.singles().size(); ++k) {
      const Entrant& e = screening_.singles()[k];
      const Gain g = gain(left_.evidence->folds->own(), e.held_out);
      Hypothesis h;
      h.name = race_.name_of(e.candidates);
      h.candidates = e.candidates;
      h.gain = g.mean;
      h.gain_sigma = g.sigma;
      double before = 0, after = 0;
      for (std::size_t i = 0; i < e.held_out.whitened.size(); ++i)
        before += left_.evidence->folds->own().whitened[i], after += e.held_out.whitened[i];
      h.held_out = model_.held_out.score() * (before > 0 ? std::sqrt(after / before) : 1);
      h.refused = "out of reach of the best: screened, not fitted";
      list.push_back(std::move(h));
    }
    return list;
  }

  // The best that passes; among those that the data cannot part from it, the one with the fewest numbers.
  std::optional<std::size_t> winner() const {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < runners_.size() && !best; ++k)
      if (passes(runners_[k])) best = k;
    if (!best) return best;
    std::size_t simplest = *best;
    for (std::size_t k = *best + 1; k < runners_.size(); ++k) {
      if (!passes(runners_[k]) || !as_good(model_, runners_[*best].model, runners_[k].model, 1, 0.9)) continue;
      if (numbers_of(race_, runners_[k].hypothesis.candidates) <
          numbers_of(race_, runners_[simplest].hypothesis.candidates))
        simplest = k;
    }
    return simplest;
  }

  // Fitted with derivatives of its own, and judged again.
  Runner polished(const Runner& r) const {
    if (r.polished) return r;
    Runner result{race_.changed(r.model, r.model.candidates), {}, true};
    const std::size_t looks = screening_.singles().size() + (r.hypothesis.candidates.size() > 1 ? pairs_ : 0);
    result.hypothesis = race_.judged(model_, result.model, r.hypothesis.candidates, left_.dummies, looks);
    return result;
  }

 private:
  // From where the screening says; a strongly nonlinear mechanism alone also from the point that promises most.
  Runner fitted(const Entrant& e, std::size_t looks) const {
    std::vector<double> begun;
    for (const std::size_t c : model_.candidates)
      for (const std::size_t p : race_.system().problem().candidates()[c].parameters)
        begun.push_back(model_.fit.values[p]);
    const auto joined = [&](const std::vector<double>& point) {
      std::vector<double> start = begun;
      start.insert(start.end(), point.begin(), point.end());
      return start;
    };
    const std::vector<std::size_t> candidates = with(model_.candidates, e.candidates);
    Runner r{race_.started(model_, candidates, joined(e.start), &kept_, e.reach * rows_), {}, false};
    if (e.candidates.size() == 1) {
      double least = race_.promised_cost(model_, candidates, joined(e.start), kept_);
      std::vector<double> best;
      for (const std::vector<double>& point : screening_.points(e.candidates[0])) {
        const double cost = race_.promised_cost(model_, candidates, joined(point), kept_);
        if (cost < least) least = cost, best = point;
      }
      if (!best.empty()) {
        Model other = race_.started(model_, candidates, joined(best), &kept_);
        if (other.fit.cost < r.model.fit.cost) r.model = std::move(other);
      }
    }
    r.hypothesis = race_.judged(model_, r.model, e.candidates, left_.dummies, looks, &kept_);
    return r;
  }

  void run_singles() {
    const std::vector<Entrant>& singles = screening_.singles();
    double best = 0;
    for (; fitted_ < std::min(effort_.fits, singles.size()); ++fitted_) {
      const double reach = singles[fitted_].reach;
      if (fitted_ >= effort_.least && !(allowance * reach > best && reach > 0)) break;
      runners_.push_back(fitted(singles[fitted_], singles.size()));
      best = std::max(best, runners_.back().hypothesis.gain);
    }
    sort_runners(runners_);
  }

  // Who is near the best is fitted to the end before one is chosen: in a long valley chords stop short.
  void polish_leaders() {
    const std::vector<Runner>& all = runners_;
    const double best = all.empty() ? 0 : all[0].hypothesis.gain;
    for (std::size_t k = 0; k < std::min(most_leaders, all.size()); ++k)
      if (best > 0 && all[k].hypothesis.gain > leading_share * best) runners_[k] = polished(all[k]);
    sort_runners(runners_);
  }

  // Two effects that cancel in the mean help only together; and one that imitates two may hide both. A pair is tried
  // where no single one passes, or where it reaches clearly further than every pair that holds the best single one.
  void run_pairs() {
    pairs_ = std::min(screening_.pair_count(), effort_.pairs);
    const auto best = std::find_if(runners_.begin(), runners_.end(), passes);
    std::vector<Entrant> pairs = screening_.pairs(effort_.pairs, most_pairs_fitted);
    std::optional<Model> rival;  // the best pair that the next round would come to
    if (best != runners_.end() && !pairs.empty()) {
      const std::size_t single = best->hypothesis.candidates[0];
      const auto holds = [&](const Entrant& e) { return e.candidates[0] == single || e.candidates[1] == single; };
      const std::vector<Entrant> own = screening_.pairs(effort_.pairs, 1, single);
      std::erase_if(pairs, [&](const Entrant& e) {
        if (holds(e) || own.empty()) return true;
        const Gain apart = gain(own[0].held_out, e.held_out);
        return !(apart.mean > apart.sigma);
      });
      if (!pairs.empty()) rival = fitted(own[0], screening_.singles().size() + pairs_).model;
    }
    for (const Entrant& e : pairs) {
      if (!more_than_either(e)) continue;
      Runner r = fitted(e, screening_.singles().size() + pairs_);
      if (rival && passes(r) && as_good(model_, r.model, *rival, 1, 0.9))
        r.hypothesis.refused = "no better than what the best single one becomes with another";
      runners_.push_back(std::move(r));
    }
  }

  // Does the pair promise more than the better of its two does alone?
  bool more_than_either(const Entrant& pair) const {
    return std::none_of(screening_.singles().begin(), screening_.singles().end(), [&](const Entrant& single) {
      if (single.candidates[0] != pair.candidates[0] && single.candidates[0] != pair.candidates[1]) return false;
      const Gain apart = gain(single.held_out, pair.held_out);
      return !(apart.mean > apart.sigma);
    });
  }

  const Race& race_;
  const Effort& effort_;
  const Model& model_;
  const Remainder& left_;
  Screening screening_;
  Slopes kept_;
  std::vector<Runner> runners_;
  std::size_t fitted_ = 0, pairs_ = 0;
  double rows_ = 0;
};

// Effects that another one, found later, has made superfluous.
void eliminate(const Race& race, const Options& options, Model& model) {
  for (bool again = true; again && model.candidates.size() > 1;) {
    again = false;
    const Slopes kept = race.slopes_at(model);
    for (const std::size_t c : model.candidates) {
      Model smaller = race.changed(model, without(model.candidates, c), &kept);
      const Gain g = gain(smaller.held_out, model.held_out);
      if (g.mean > g.sigma && race.effect(smaller, model) >= options.matters) continue;
      model = race.changed(smaller, smaller.candidates);
      again = true;
      break;
    }
  }
}

// Significant beside all the looks of its round, better on unseen groups, and too small to matter.
bool is_minor(const Hypothesis& h) {
  return h.refused == "smaller than what matters" && h.gain > 2 * h.gain_sigma;
}

void enter_lines(const Race& race, Round& round, Selection& s) {
  s.minor.clear();  // what is minor beside an effect that has since been found may be its imitation
  const auto enter = [&](Hypothesis h) {
    if (!s.model.candidates.empty()) h.name = race.name_of(s.model.candidates) + " + " + h.name;
    if (is_minor(h)) s.minor.push_back(s.scoreboard.size());
    s.scoreboard.push_back(std::move(h));
  };
  for (const Runner& r : round.runners()) enter(r.hypothesis);
  for (Hypothesis& h : round.screened_out()) enter(std::move(h));
}

}  // namespace

Effort effort_for(const Race& race, const Options& options) {
  Effort effort;
  if (!(options.budget_s > 0)) return effort;
  // A million values of one prediction and some twenty predictions for a hypothesis take about a second each.
  double rows = 0;
  for (const std::size_t g : race.system().groups) rows += static_cast<double>(race.system().used_rows(g));
  const double fits = options.budget_s / (20 * rows * 1e-6 + 1e-3);
  const std::size_t most = effort.fits, pairs = effort.pairs;
  effort.fits = static_cast<std::size_t>(std::clamp(fits / 4, 2.0, static_cast<double>(most)));
  effort.least = std::min(effort.least, effort.fits);
  effort.pairs = static_cast<std::size_t>(std::clamp(100 * fits, 10.0, static_cast<double>(pairs)));
  if (fits < 20) effort.effects = 2;
  if (effort.fits < most || effort.pairs < pairs || effort.effects < 5)
    effort.shortened = "The budget allowed " + std::to_string(effort.fits) + " fits and " +
                       std::to_string(effort.pairs) + " pairs a round, and at most " + std::to_string(effort.effects) +
                       " effects at once.";
  return effort;
}

Selection select(const Race& race, const Options& options, const std::vector<double>& start,
                 std::optional<double> mismatch_p) {
  const Effort effort = effort_for(race, options);
  Selection s;
  s.shortened = effort.shortened;
  s.base = s.model = race.base(start);
  s.before = s.after = remainder(race, s.base, options);
  if (mismatch_p) s.before.global_p = s.after.global_p = *mismatch_p;
  while (s.after.global_p <= options.level && s.model.candidates.size() < effort.effects) {
    Round round(race, effort, s.model, s.after);
    enter_lines(race, round, s);
    std::optional<Runner> joined;
    while (!joined) {
      const std::optional<std::size_t> k = round.winner();
      if (!k) break;
      Runner& r = round.runners()[*k];
      Runner polished = round.polished(r);
      if (passes(polished))
        joined = std::move(polished);
      else
        r.hypothesis.refused = polished.hypothesis.refused;
    }
    if (!joined) break;
    for (Hypothesis& h : s.scoreboard)
      if (h.candidates == joined->hypothesis.candidates && h.refused.empty() && s.model.candidates.empty())
        h = joined->hypothesis;
    s.model = std::move(joined->model);
    s.after = remainder(race, s.model, options);
  }
  if (s.model.candidates.size() > 1) {
    const std::size_t size = s.model.candidates.size();
    eliminate(race, options, s.model);
    if (s.model.candidates.size() != size) s.after = remainder(race, s.model, options);
  }
  find_equals(race, effort, s);
  return s;
}

}  // namespace gonio::explain
