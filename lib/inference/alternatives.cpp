// See race.h: which other mechanisms could stand in the place of the likeliest ones.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "inference/finalists.h"
#include "inference/screening.h"

namespace gonio::inference {
namespace {

constexpr double resemblance = 0.5;  // |cos| below which nothing stands in for another
constexpr double near_share = 0.3;   // of the winner's gain, by chords
constexpr std::size_t most_exchanges = 8;
constexpr double near_reach = 0.7;  // of the furthest-reaching pair, linearly, for another pair to be fitted
constexpr std::size_t most_pairs = 3;
constexpr double distinct_blocks = 3;
constexpr double distinct_share = 0.01;  // of the winner's gain: a difference that could be anyone's last digit

// Those that look most like `named` once the free parameters are projected out; and those that did as well alone.
std::vector<std::size_t> stand_ins(const Race& race, const Selection& s, std::size_t named) {
  const Evidence& e = *s.before.evidence;
  std::map<std::size_t, double> similar;
  std::vector<Eigen::Index> own;
  for (std::size_t k = 0; k < e.structures.list.size(); ++k)
    if (e.structures.list[k].kind == Structure::Kind::mechanism && e.structures.list[k].index == named)
      own = e.projection.foreign(e.structures, k);
  if (own.empty()) return {};
  const Subspace subspace(e.projection, own);
  for (std::size_t k = 0; k < e.structures.list.size(); ++k) {
    const Structure& other = e.structures.list[k];
    if ((other.kind != Structure::Kind::mechanism && other.kind != Structure::Kind::change) || other.index == named)
      continue;
    double& cosine = similar[other.index];
    cosine =
        std::max(cosine, look_alike(e.projection, subspace, {e.projection, e.projection.foreign(e.structures, k)}));
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

void exchange_member(const Race& race, const Effort& effort, const Selection& s, const Model& model, std::size_t place,
                     const Slopes& kept, Finalists& finalists) {
  const std::size_t named = model.candidates[place];
  std::vector<std::size_t> others = model.candidates;
  std::erase(others, named);
  const Model rest = race.changed(model, others, &kept);
  const std::vector<std::size_t> open = race.open_to(rest);
  const double wanted = gain(rest.held_out, model.held_out).mean;
  std::size_t tried = 0;
  for (const std::size_t other : stand_ins(race, s, named)) {
    if (std::find(open.begin(), open.end(), other) == open.end()) continue;
    if (std::find(others.begin(), others.end(), other) != others.end()) continue;
    std::vector<std::size_t> candidates = model.candidates;
    candidates[place] = other;
    if (finalists.knows(candidates)) continue;
    if (++tried > std::min(most_exchanges, effort.fits)) break;
    Model exchanged = race.changed(rest, candidates, &kept);
    if (gain(rest.held_out, exchanged.held_out).mean > near_share * wanted)
      exchanged = race.changed(exchanged, candidates);  // to the end: chords stop short in long valleys
    if (gain(rest.held_out, exchanged.held_out).mean > near_share * wanted) finalists.add(std::move(exchanged));
  }
}

// Pairs that share nothing with the two that won.
void add_other_pairs(const Race& race, const Effort& effort, const Selection& s, const Model& model,
                     Finalists& finalists) {
  const Screening screening(race, s.before);
  const Slopes kept = race.slopes_at(s.base);
  double rows = 0;
  for (const double r : s.before.evidence->folds->own().rows) rows += r;
  const std::vector<Entrant> pairs = screening.pairs(effort.pairs, 4 * most_pairs);
  std::size_t tried = 0;
  for (const Entrant& e : pairs) {
    if (e.reach < near_reach * pairs[0].reach || tried == std::min(most_pairs, effort.runners_up)) break;
    const auto related = [&](std::size_t c) {
      return std::any_of(model.candidates.begin(), model.candidates.end(),
                         [&](std::size_t w) { return race.relatives(c, w); });
    };
    if (std::any_of(e.candidates.begin(), e.candidates.end(), related) || finalists.knows(e.candidates)) continue;
    ++tried;
    const Model other = race.started(s.base, e.candidates, e.start, &kept, e.reach * rows);
    finalists.add(race.changed(other, e.candidates));
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

void add_alternatives(const Race& race, const Effort& effort, const Selection& s, const Model& model,
                      Finalists& finalists) {
  const Slopes kept = race.slopes_at(model);
  for (std::size_t place = 0; place < model.candidates.size(); ++place)
    exchange_member(race, effort, s, model, place, kept, finalists);
  if (model.candidates.size() == 2) add_other_pairs(race, effort, s, model, finalists);
}

}  // namespace gonio::inference
