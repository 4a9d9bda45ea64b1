// See forward_step.h.
#include "inference/forward_step.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/progress.h"
#include "inference/left_over.h"

namespace gonio::inference {
namespace {

// A fit inside the simulator may reach further than the linear form of its mechanism did; beyond this factor it never
// overtook in the tests of strongly nonlinear mechanisms.
constexpr double allowance = 3;
constexpr std::size_t most_pairs_fitted = 4;
constexpr std::size_t most_overlooked = 4;  // times the fits of a round
constexpr std::size_t most_leaders = 4;
constexpr double leading_share = 0.6;  // of the best gain: may be the winner once fitted to the end

bool passes(const Runner& r) {
  return r.hypothesis.refused.empty();
}

std::size_t numbers_of(const Race& race, const std::vector<std::size_t>& candidates) {
  std::size_t count = 0;
  for (const std::size_t c : candidates) count += race.system().problem().candidates()[c].parameters.size();
  return count;
}

std::size_t finer_ones(const Race& race, const std::vector<std::size_t>& candidates) {
  return static_cast<std::size_t>(std::count_if(candidates.begin(), candidates.end(), [&](std::size_t c) {
    return race.system().problem().candidates()[c].finer;
  }));
}

void sort_runners(std::vector<Runner>& runners) {
  std::stable_sort(runners.begin(), runners.end(),
                   [](const Runner& a, const Runner& b) { return a.hypothesis.gain > b.hypothesis.gain; });
}

}  // namespace

ForwardStep::ForwardStep(const Race& race, const Effort& effort, const Model& model, const ResidualStructure& left)
    : race_(race), effort_(effort), model_(model), left_(left), screening_(race, left) {
  if (screening_.singles().empty()) return;
  kept_ = race.slopes_at(model);
  for (const double rows : left.evidence->folds->own().rows) rows_ += rows;
  run_singles();
  run_pairs();
  run_overlooked();
  polish_leaders();
}

std::vector<Hypothesis> ForwardStep::screened_out() const {
  std::vector<Hypothesis> list;
  for (std::size_t k = fitted_; k < screening_.singles().size(); ++k) {
    if (std::ranges::find(overlooked_, k) != overlooked_.end()) continue;
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

bool ForwardStep::plainer(const Runner& a, const Runner& b) const {
  const std::vector<std::size_t>&of_a = a.hypothesis.candidates, &of_b = b.hypothesis.candidates;
  const std::size_t finer_a = finer_ones(race_, of_a), finer_b = finer_ones(race_, of_b);
  return finer_a != finer_b ? finer_a < finer_b : numbers_of(race_, of_a) < numbers_of(race_, of_b);
}

std::optional<std::size_t> ForwardStep::winner() const {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < runners_.size() && !best; ++k)
    if (passes(runners_[k]) && !runners_[k].taken) best = k;
  if (!best) return best;
  std::size_t plainest = *best;
  for (std::size_t k = *best + 1; k < runners_.size(); ++k) {
    if (!passes(runners_[k]) || runners_[k].taken || !plainer(runners_[k], runners_[plainest])) continue;
    const Model &first = runners_[*best].model, &other = runners_[k].model;
    const bool form = finer_ones(race_, runners_[k].hypothesis.candidates) <
                      finer_ones(race_, runners_[plainest].hypothesis.candidates);
    if (as_good(model_, first, other, 1, 0.9) || (form && nearly_all(model_, first, other))) plainest = k;
  }
  return plainest;
}

std::optional<Runner> ForwardStep::next() {
  while (const std::optional<std::size_t> k = winner()) {
    Runner& r = runners_[*k];
    r = polished(r);
    if (!passes(r)) continue;
    r.taken = true;
    return r;
  }
  return std::nullopt;
}

Runner ForwardStep::polished(const Runner& r) const {
  if (r.polished) return r;
  Runner result{race_.changed(r.model, r.model.candidates), {}, true, r.taken};
  const std::size_t looks = screening_.singles().size() + (r.hypothesis.candidates.size() > 1 ? pairs_ : 0);
  result.hypothesis = race_.judged(model_, result.model, r.hypothesis.candidates, left_.negative_controls, looks);
  return result;
}

// From where the screening says; a strongly nonlinear mechanism alone also from the point that promises most.
Runner ForwardStep::fitted(const Entrant& e, std::size_t looks) const {
  const Progress progress("weighing " + race_.name_of(e.candidates), std::max(effort_.fits, runners_.size() + 1),
                          runners_.size());
  std::vector<double> begun;
  for (const std::size_t c : model_.candidates)
    for (const std::size_t p : race_.system().problem().candidates()[c].parameters)
      begun.push_back(model_.fit.values[p]);
  const auto joined = [&](const std::vector<double>& point) {
    std::vector<double> start = begun;
    start.insert(start.end(), point.begin(), point.end());
    return start;
  };
  std::vector<std::size_t> candidates = model_.candidates;
  candidates.insert(candidates.end(), e.candidates.begin(), e.candidates.end());
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
  r.hypothesis = race_.judged(model_, r.model, e.candidates, left_.negative_controls, looks, &kept_);
  return r;
}

// Could it matter beside what has joined? Of what comes first linear forms say too little: a heating's time constant
// begins anywhere.
bool ForwardStep::may_matter(const Entrant& e) const {
  return model_.candidates.empty() || allowance * e.effect >= race_.options().smallest_effect;
}

void ForwardStep::run_singles() {
  const std::vector<Entrant>& singles = screening_.singles();
  double best = 0;
  const auto beyond = std::find_if(singles.rbegin(), singles.rend(), [&](const Entrant& e) { return may_matter(e); });
  const std::size_t worth_it = static_cast<std::size_t>(singles.rend() - beyond);
  for (; fitted_ < std::min(effort_.fits, worth_it); ++fitted_) {
    const double reach = singles[fitted_].reach;
    if (fitted_ >= effort_.least && !(allowance * reach > best && reach > 0)) break;
    runners_.push_back(fitted(singles[fitted_], singles.size()));
    // What is too small to matter is no answer, however much it gains where readings are precise.
    if (!too_small(runners_.back().hypothesis)) best = std::max(best, runners_.back().hypothesis.gain);
  }
  sort_runners(runners_);
}

// Two effects that cancel in the mean help only together; and one that imitates two may hide both. A pair is tried
// where no single one passes, or where it reaches clearly further than every pair that holds the best single one.
void ForwardStep::run_pairs() {
  pairs_ = std::min(screening_.pair_count(), effort_.pairs);
  const auto best = std::find_if(runners_.begin(), runners_.end(), passes);
  std::vector<Entrant> pairs = screening_.pairs(effort_.pairs, most_pairs_fitted);
  std::erase_if(pairs, [&](const Entrant& e) { return !may_matter(e) || !more_than_either(e); });
  std::optional<Model> rival;  // the best pair that the next round would come to
  if (best != runners_.end() && !pairs.empty()) {
    const std::size_t single = best->hypothesis.candidates[0];
    const std::vector<Entrant> own = screening_.pairs(effort_.pairs, 1, single);
    std::erase_if(pairs, [&](const Entrant& e) {
      if (e.candidates[0] == single || e.candidates[1] == single) return true;
      const Gain apart = own.empty() ? Gain{} : gain(own[0].held_out, e.held_out);
      if (apart.mean > apart.sigma) return false;
      passed_over_.push_back(e);
      return true;
    });
    if (!pairs.empty()) rival = fitted(own[0], screening_.singles().size() + pairs_).model;
  }
  for (const Entrant& e : pairs) {
    Runner r = fitted(e, screening_.singles().size() + pairs_);
    if (rival && passes(r) && as_good(model_, r.model, *rival, 1, 0.9)) {
      passed_over_.push_back(e);
      r.hypothesis.refused = "no better than what the best single one becomes with another";
    }
    runners_.push_back(std::move(r));
  }
}

// Where something that matters is there and none of those passes: a linear form is no word on what moves edges, of
// shadows above all. What it promises where it is fitted can be great, and its prediction of another group still be
// worse than none; so what was screened out is fitted as well, the most promising first.
void ForwardStep::run_overlooked() {
  if (!model_.candidates.empty() || std::any_of(runners_.begin(), runners_.end(), passes)) return;
  const Options& options = race_.options();
  const bool matters = left_over(race_.system().problem(), {}, left_, options).any > 0 ||
                       matter(left_.outliers, options.smallest_effect);
  if (left_.global_p > options.level || !matters) return;
  const std::vector<Entrant>& singles = screening_.singles();
  for (std::size_t k = fitted_; k < singles.size(); ++k)
    if (singles[k].promise > 0) overlooked_.push_back(k);
  std::ranges::stable_sort(overlooked_, std::greater<>(), [&](std::size_t k) { return singles[k].promise; });
  overlooked_.resize(std::min(overlooked_.size(), most_overlooked * effort_.fits));
  for (const std::size_t k : overlooked_) runners_.push_back(fitted(singles[k], singles.size()));
}

void ForwardStep::admit_pairs() {
  for (const Entrant& e : passed_over_) {
    std::erase_if(runners_, [&](const Runner& r) { return r.hypothesis.candidates == e.candidates; });
    runners_.push_back(fitted(e, screening_.singles().size() + pairs_));
  }
  passed_over_.clear();
  sort_runners(runners_);
}

// Who is near the best is fitted to the end before one is chosen: in a long valley chords stop short.
void ForwardStep::polish_leaders() {
  sort_runners(runners_);
  const double best = runners_.empty() ? 0 : runners_[0].hypothesis.gain;
  for (std::size_t k = 0; k < std::min(most_leaders, runners_.size()); ++k)
    if (best > 0 && runners_[k].hypothesis.gain > leading_share * best) runners_[k] = polished(runners_[k]);
  sort_runners(runners_);
}

// Does the pair promise more than the better of its two does alone?
bool ForwardStep::more_than_either(const Entrant& pair) const {
  return std::none_of(screening_.singles().begin(), screening_.singles().end(), [&](const Entrant& single) {
    if (single.candidates[0] != pair.candidates[0] && single.candidates[0] != pair.candidates[1]) return false;
    const Gain apart = gain(single.held_out, pair.held_out);
    return !(apart.mean > apart.sigma);
  });
}

}  // namespace gonio::inference
