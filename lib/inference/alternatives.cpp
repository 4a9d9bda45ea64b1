// See race.h: which other mechanisms explain the recordings as well as the named ones do.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "inference/judgement.h"
#include "inference/screening.h"

namespace gonio::inference {
namespace {

constexpr double resemblance = 0.5;  // |cos| below which nothing stands in for another
constexpr double near_share = 0.3;   // of the winner's gain, by chords
constexpr std::size_t most_exchanges = 8;
constexpr std::size_t set_size = 3;  // sets beyond it are trimmed by what the noise of single blocks allows
constexpr double near_reach = 0.7;   // of the furthest-reaching pair, linearly, for another pair to be fitted
constexpr std::size_t most_pairs = 3;
constexpr double distinct_blocks = 3;
constexpr double distinct_share = 0.01;  // of the winner's gain: a difference that could be anyone's last digit
constexpr double distinct_squares = 1;   // over all rows, in noise widths squared: see indistinct()

// Those that look most like `named` once the free parameters are projected out; and those that did as well alone.
std::vector<std::size_t> stand_ins(const Race& race, const Selection& s, std::size_t named) {
  const Evidence& e = *s.before.evidence;
  std::map<std::size_t, double> similar;
  std::vector<Eigen::Index> own;
  for (std::size_t k = 0; k < e.structures.list.size(); ++k)
    if (e.structures.list[k].kind == Structure::Kind::mechanism && e.structures.list[k].index == named)
      own = e.projection.foreign(e.structures, k);
  if (own.empty()) return {};
  for (std::size_t k = 0; k < e.structures.list.size(); ++k) {
    const Structure& other = e.structures.list[k];
    if ((other.kind != Structure::Kind::mechanism && other.kind != Structure::Kind::change) || other.index == named)
      continue;
    double& cosine = similar[other.index];
    cosine = std::max(cosine, look_alike(e.projection, own, e.projection.foreign(e.structures, k)));
  }
  double best = 0;
  for (const Hypothesis& h : s.scoreboard)
    if (h.candidates == std::vector<std::size_t>{named}) best = std::max(best, h.gain);
  for (const Hypothesis& h : s.scoreboard)
    if (h.candidates.size() == 1 && h.candidates[0] != named && 2 * h.gain > best)
      similar[h.candidates[0]] = std::max(similar[h.candidates[0]], resemblance + 1e-6);
  std::vector<std::pair<double, std::size_t>> order;
  for (const auto& [candidate, cosine] : similar)
    if (cosine > resemblance && !race.relatives(candidate, named)) order.emplace_back(-cosine, candidate);
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> result;
  for (const auto& [cosine, candidate] : order) result.push_back(candidate);
  return result;
}

bool same_set(std::vector<std::size_t> a, std::vector<std::size_t> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}
bool was_put_aside(const Selection& s, const std::vector<std::size_t>& candidates) {
  return std::any_of(s.put_aside.begin(), s.put_aside.end(),
                     [&](const PutAside& p) { return same_set(p.candidates, candidates); });
}

// Twice the logarithm of a ratio of likelihoods below one: no test tells these apart (Neyman & Pearson 1933), however
// evenly the blocks share the difference. Two forms of one effect differ so, by what they make of its second order.
bool indistinct(const Model& best, const Model& other) {
  double rows = 0;
  for (const double r : best.held_out.rows) rows += r;
  const Gain apart = gain(other.held_out, best.held_out);
  return apart.sigma < std::numeric_limits<double>::max() && rows * apart.mean < distinct_squares;
}

struct Alternative {
  std::size_t candidate = 0;
  double gain = 0, apart = 0;  // held out; block z by which the winner is better
  bool form = false;           // a finer form of what is named
};

std::vector<Alternative> alternatives_of(const Race& race, const Effort& effort, const Selection& s, std::size_t place,
                                         const Slopes& kept) {
  const std::size_t named = s.model.candidates[place];
  std::vector<std::size_t> others = s.model.candidates;
  std::erase(others, named);
  const Model rest = race.changed(s.model, others, &kept);
  const std::vector<std::size_t> open = race.open_to(rest);
  std::vector<Alternative> alternatives;
  std::size_t tried = 0;
  for (const std::size_t other : stand_ins(race, s, named)) {
    if (std::find(open.begin(), open.end(), other) == open.end()) continue;
    if (std::find(others.begin(), others.end(), other) != others.end()) continue;
    std::vector<std::size_t> candidates = s.model.candidates;
    candidates[place] = other;
    if (was_put_aside(s, candidates)) continue;
    if (++tried > std::min(most_exchanges, effort.fits)) break;
    Model exchanged = race.changed(rest, candidates, &kept);
    if (gain(rest.held_out, exchanged.held_out).mean > near_share * gain(rest.held_out, s.model.held_out).mean)
      exchanged = race.changed(exchanged, candidates);  // to the end: chords stop short in long valleys
    const Hypothesis h = race.judged(rest, exchanged, {other}, {}, 1);
    if (!h.refused.empty()) continue;
    const bool form = race.system().problem().candidates()[other].finer && nearly_all(rest, s.model, exchanged);
    if (form || as_good(rest, s.model, exchanged, 2, 0.5) || indistinct(s.model, exchanged))
      alternatives.push_back({other, h.gain, block_z(exchanged.held_out, s.model.held_out), form});
  }
  std::stable_sort(alternatives.begin(), alternatives.end(),
                   [](const Alternative& a, const Alternative& b) { return a.gain > b.gain; });
  return alternatives;
}

// Pairs that share nothing with the two that won, and judge as well as they do.
void find_other_pairs(const Race& race, const Options& options, const Effort& effort, const Slopes& kept,
                      Selection& s) {
  const Screening screening(race, s.before);
  const std::vector<std::size_t>& won = s.model.candidates;
  double rows = 0;
  for (const double r : s.before.evidence->folds->own().rows) rows += r;
  const std::vector<Entrant> pairs = screening.pairs(effort.pairs, 4 * most_pairs);
  std::size_t tried = 0;
  for (const Entrant& e : pairs) {
    if (e.reach < near_reach * pairs[0].reach || tried == std::min(most_pairs, effort.runners_up)) break;
    const auto related = [&](std::size_t c) {
      return std::any_of(won.begin(), won.end(), [&](std::size_t w) { return race.relatives(c, w); });
    };
    if (std::any_of(e.candidates.begin(), e.candidates.end(), related) || was_put_aside(s, e.candidates)) continue;
    ++tried;
    Selection other = s;
    other.model = race.started(s.base, e.candidates, e.start, &kept, e.reach * rows);
    other.model = race.changed(other.model, e.candidates);
    if (!race.judged(s.base, other.model, e.candidates, {}, 1).refused.empty()) continue;
    if (!as_good(s.base, s.model, other.model, 2, 0.5)) continue;
    other.after = residual_structure(race, other.model, options);
    if (objection(race.system().problem(), other, options).empty()) s.instead.push_back(e.candidates);
  }
}

}  // namespace

bool as_good(const Model& before, const Model& best, const Model& other, double errors, double share) {
  const Gain apart = gain(other.held_out, best.held_out);
  const Gain of_best = gain(before.held_out, best.held_out), of_other = gain(before.held_out, other.held_out);
  // Twins differ by rounding alone, and by hardly more than its spread.
  if (apart.mean > errors * apart.sigma + 1e-6 * of_best.mean) return false;
  if (apart.mean > distinct_share * of_best.mean && block_z(other.held_out, best.held_out) > distinct_blocks)
    return false;
  return of_other.mean >= share * of_best.mean;
}

bool nearly_all(const Model& before, const Model& best, const Model& other) {
  return gain(before.held_out, other.held_out).mean >= (1 - distinct_share) * gain(before.held_out, best.held_out).mean;
}

void find_alternatives(const Race& race, const Options& options, const Effort& effort, Selection& s) {
  if (s.model.candidates.empty()) return;
  const Slopes kept = race.slopes_at(s.model);
  for (std::size_t place = 0; place < s.model.candidates.size(); ++place) {
    std::vector<Alternative> alternatives = alternatives_of(race, effort, s, place, kept);
    for (double limit = 2; alternatives.size() + 1 > set_size && limit >= 1; limit -= 0.5)
      std::erase_if(alternatives, [&](const Alternative& e) { return !e.form && e.apart > limit; });
    if (alternatives.empty()) continue;
    std::vector<std::size_t> set = {s.model.candidates[place]};
    for (const Alternative& e : alternatives) set.push_back(e.candidate);
    s.not_told_apart.push_back(std::move(set));
  }
  if (s.model.candidates.size() == 2) find_other_pairs(race, options, effort, race.slopes_at(s.base), s);
}

}  // namespace gonio::inference
