// Where the mismatch is, in the conditions: how much of the excess over noise a smooth curve over each one explains,
// and over which range.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "inference/scaling.h"
#include "inference/signature.h"
#include "inference/wording.h"
#include "linear/blocks.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr double least_survivor = 1e-4;  // of a direction's squared length, after projection
constexpr std::size_t bins_of_a_curve = 12, steps_of_an_effect = 48, least_rows_of_a_step = 8;
constexpr double tied_share = 0.8;   // of the first condition's share: not told apart by it
constexpr double same_share = 0.98;  // one condition in another's clothes (an angle and its half)

struct Explained {
  double squares = 0, rank = 0;
  Eigen::VectorXd coefficients;
};
// Fall of the sum of squares when the curve is added to the free parameters: b' G^-1 b on the range of G.
Explained explained_by(const Projection& p, const std::vector<Eigen::Index>& places) {
  const Eigen::MatrixXd g = p.surviving(places, places);
  const Eigen::VectorXd b = p.score(places);
  const Eigen::VectorXd length = p.full.diagonal()(places);
  const Eigen::VectorXd scale = unit_scale(length);
  const linear::EigenPairs eigen = linear::eigen_of(scale.asDiagonal() * g * scale.asDiagonal());
  Explained e;
  Eigen::VectorXd z = eigen.vectors.transpose() * (scale.asDiagonal() * b);
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    if (eigen.values[k] < least_survivor) {
      z[k] = 0;
      continue;
    }
    e.squares += z[k] * z[k] / eigen.values[k];
    e.rank += 1;
    z[k] /= eigen.values[k];
  }
  e.coefficients = scale.asDiagonal() * (eigen.vectors * z);
  return e;
}

// The shortest run of bins that holds 80 % of `power`.
void find_range(const Curve& curve, const std::vector<double>& power, LocatedCondition& located) {
  const std::size_t n = curve.centre.size();
  if (n == 0) return;
  const double wanted = 0.8 * std::accumulate(power.begin(), power.end(), 0.0);
  std::size_t best_first = 0, best_last = n - 1;
  double best_sum = 0;
  for (std::size_t first = 0; first < n; ++first) {
    double sum = 0;
    for (std::size_t last = first; last < n; ++last) {
      sum += power[last];
      if (sum < wanted) continue;
      const bool shorter = last - first < best_last - best_first;
      if (shorter || (last - first == best_last - best_first && sum > best_sum))
        best_first = first, best_last = last, best_sum = sum;
      break;
    }
  }
  located.lower =
      best_first == 0 ? curve.centre.front() : 0.5 * (curve.centre[best_first - 1] + curve.centre[best_first]);
  located.upper =
      best_last + 1 == n ? curve.centre.back() : 0.5 * (curve.centre[best_last] + curve.centre[best_last + 1]);
  double squares = 0;
  for (std::size_t k = best_first; k <= best_last; ++k) squares += power[k];
  located.effect = std::sqrt(squares / static_cast<double>(best_last - best_first + 1));
}

// Squared mean residual of each bin less its own noise.
std::vector<double> power_of(const Curve& curve) {
  std::vector<double> power(curve.centre.size());
  for (std::size_t k = 0; k < power.size(); ++k)
    power[k] = std::max(0.0, curve.before[k] * curve.before[k] - curve.sigma[k] * curve.sigma[k]);
  return power;
}

// What the named mechanisms themselves do in each bin: the prediction without them less that with them, everything else
// being as fitted. The fall of the residual is less telling: free parameters had spread the effect over all bins.
std::vector<double> power_of_effect(const Curve& without, std::size_t bins) {
  std::vector<double> power(bins);
  for (std::size_t k = 0; k < std::min(bins, without.centre.size()); ++k) {
    const double effect = without.before[k] - without.after[k];
    power[k] = effect * effect;
  }
  return power;
}

// Edges of steps over `rows` sorted rows: of equal counts, the outermost halved again and again towards either end,
// where what is narrow lies (a highlight, the edge of a shadow).
std::vector<std::size_t> edges_of_steps(std::size_t rows) {
  std::vector<std::size_t> edges;
  for (std::size_t b = 0; b <= steps_of_an_effect; ++b) edges.push_back(b * rows / steps_of_an_effect);
  for (std::size_t n = rows / steps_of_an_effect / 2; n >= least_rows_of_a_step; n /= 2)
    edges.insert(edges.end(), {n, rows - n});
  std::ranges::sort(edges);
  return edges;
}

// Share of what the named mechanisms do, beyond one level, that steps over the condition describe: a gloss is wholly a
// matter of the half angle even where it lies on few of the rows, and little of the excess is there.
double described(const System& system, const Condition& condition, const std::vector<double>& without,
                 const std::vector<double>& with) {
  struct Sums {
    double product = 0, square = 0;
    double explains() const { return square > 0 ? product * product / square : 0; }
  };
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < without.size(); ++i)
    if (system.weight(i) > 0 && std::isfinite(condition.values[i])) rows.push_back(i);
  std::ranges::stable_sort(rows, {}, [&](std::size_t i) { return condition.values[i]; });
  Sums level;
  double total = 0, steps = 0;
  const std::vector<std::size_t> edges = edges_of_steps(rows.size());
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    Sums step;
    for (std::size_t k = edges[b]; k < edges[b + 1]; ++k) {
      const std::size_t i = rows[k];
      const double d = condition.direction.empty() ? 1 : condition.direction[i];
      const double w = system.weight(i) * system.weight(i), effect = without[i] - with[i];
      step.product += d * w * effect, step.square += d * d * w;
      total += w * effect * effect;
    }
    level.product += step.product, level.square += step.square;
    steps += step.explains();
  }
  const double beyond = total - level.explains();
  return beyond > 1e-12 * total ? std::clamp((steps - level.explains()) / beyond, 0.0, 1.0) : 0;
}

}  // namespace

Curve residual_curve(const System& system, std::size_t condition, const std::vector<double>& before,
                     const std::vector<double>& after, std::size_t bins) {
  const Observations& o = system.observations();
  const Condition& c = o.conditions[condition];
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < o.rows(); ++i)
    if (system.weight(i) > 0 && std::isfinite(c.values[i]) && (c.direction.empty() || c.direction[i] != 0))
      rows.push_back(i);
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return c.values[a] < c.values[b]; });
  Curve curve{c.name, c.unit, c.curve_unit, {}, {}, {}, {}};
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = b * rows.size() / bins, last = (b + 1) * rows.size() / bins;
    if (first == last) continue;
    double weight = 0, sum_before = 0, sum_after = 0, x = 0;
    std::map<std::uint32_t, double> blocks;
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t i = rows[k];
      const double d = c.direction.empty() ? 1 : c.direction[i], w = system.weight(i) * system.weight(i);
      weight += d * d * w;
      sum_before += d * w * before[i];
      sum_after += d * w * after[i];
      x += c.values[i] / static_cast<double>(last - first);
    }
    if (!(weight > 0)) continue;
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t i = rows[k];
      const double d = c.direction.empty() ? 1 : c.direction[i], w = system.weight(i) * system.weight(i);
      blocks[o.block[i]] += d * w * (after[i] - d * sum_after / weight);
    }
    double variance = 0;
    for (const auto& [block, sum] : blocks) variance += sum * sum;
    curve.centre.push_back(x);
    curve.before.push_back(sum_before / weight);
    curve.after.push_back(sum_after / weight);
    curve.sigma.push_back(std::sqrt(variance) / weight);
  }
  return curve;
}

std::vector<LocatedCondition> locate(const System& system, const Projection& p, const Structures& structures) {
  const double degrees = p.rows - static_cast<double>(p.own.size());
  const double excess = std::max(p.squares - degrees, 1e-9 * p.squares);
  std::vector<LocatedCondition> result;
  for (std::size_t s = 0; s < structures.list.size(); ++s) {
    if (structures.list[s].kind != Structure::Kind::curve) continue;
    const Condition& condition = system.observations().conditions[structures.list[s].index];
    LocatedCondition located;
    located.name = condition.name, located.unit = condition.unit, located.stage = condition.stage;
    located.period = structures.list[s].period;
    const Explained e = explained_by(p, p.foreign(structures, s));
    located.share = excess > 0 ? std::clamp((e.squares - e.rank) / excess, 0.0, 1.0) : 0;
    result.push_back(std::move(located));
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const LocatedCondition& a, const LocatedCondition& b) { return a.share > b.share; });
  return result;
}

namespace {

// Whose declarations order the conditions that tell equally much: the named mechanisms', the most important one's
// first; where nothing is named, those of the one that gained most.
std::vector<std::size_t> speakers(const Explanation& e) {
  if (!e.named.empty()) return e.named;
  const Hypothesis* best = nullptr;
  for (const Hypothesis& h : e.scoreboard)
    if (h.kind == Hypothesis::Kind::mechanisms && h.gain > (best == nullptr ? 0 : best->gain)) best = &h;
  return best == nullptr ? std::vector<std::size_t>{} : best->candidates;
}

// Place in those declarations; past the end: not declared.
std::size_t declared_place(const Problem& problem, const std::vector<std::size_t>& candidates,
                           const std::string& condition) {
  std::size_t place = 0;
  for (const std::size_t c : candidates)
    for (const std::string& own : problem.candidates()[c].mechanism->conditions) {
      if (own == condition) return place;
      ++place;
    }
  return place;
}

// Where no condition holds much of the excess, that of the named mechanisms' own which describes best what they do.
void put_described_first(const Problem& problem, Explanation& e) {
  if (e.conditions[0].share >= telling_share) return;
  std::size_t declarations = 0;
  for (const std::size_t c : e.named) declarations += problem.candidates()[c].mechanism->conditions.size();
  const auto declared = [&](const LocatedCondition& c) {
    return declared_place(problem, e.named, c.name) < declarations;
  };
  const auto rank = [&](const LocatedCondition& c) { return declared(c) ? c.of_effect : 0.0; };
  const auto best = std::ranges::max_element(e.conditions, {}, rank);
  if (rank(*best) >= telling_share_of_effect) std::rotate(e.conditions.begin(), best, best + 1);
}

}  // namespace

void place_conditions(const System& system, Explanation& e) {
  const std::vector<Condition>& conditions = system.observations().conditions;
  std::vector<double> neutral = e.values;
  for (const std::size_t c : e.named)
    for (const std::size_t p : system.problem().candidates()[c].parameters)
      neutral[p] = system.problem().parameters()[p].neutral;
  const std::vector<double> without = e.named.empty() ? std::vector<double>{} : system.raw_residual(neutral);
  for (LocatedCondition& located : e.conditions) {
    const auto found =
        std::find_if(conditions.begin(), conditions.end(), [&](const Condition& c) { return c.name == located.name; });
    const auto place = static_cast<std::size_t>(found - conditions.begin());
    located.curve = residual_curve(system, place, e.residual_before, e.residual_after, bins_of_a_curve);
    if (located.period > 0) {  // everywhere, and nowhere in the mean over the groups
      if (!located.curve.centre.empty())
        located.lower = located.curve.centre.front(), located.upper = located.curve.centre.back();
      continue;
    }
    if (e.named.empty()) {
      find_range(located.curve, power_of(located.curve), located);
      continue;
    }
    located.of_effect = described(system, conditions[place], without, e.residual_after);
    const Curve effect = residual_curve(system, place, without, e.residual_after, bins_of_a_curve);
    find_range(located.curve, power_of_effect(effect, located.curve.centre.size()), located);
  }
  if (e.conditions.empty()) return;
  const std::vector<std::size_t> order = speakers(e);
  const double tie = (e.named.empty() ? same_share : tied_share) * e.conditions[0].share;
  const auto end =
      std::find_if(e.conditions.begin(), e.conditions.end(), [&](const LocatedCondition& c) { return c.share < tie; });
  std::stable_sort(e.conditions.begin(), end, [&](const LocatedCondition& a, const LocatedCondition& b) {
    return declared_place(system.problem(), order, a.name) < declared_place(system.problem(), order, b.name);
  });
  put_described_first(system.problem(), e);
}

}  // namespace gonio::inference
