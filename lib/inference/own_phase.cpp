// See own_phase.h.
#include "inference/own_phase.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "base/parallel.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr double least_periods = 3, most_periods = 60;  // in the range
constexpr double values_of_a_period = 3;                // that differ, at least
constexpr double steps = 2;                             // of a resolved frequency
constexpr int fine_steps = 6;                           // on either side of the best, one of those wide
constexpr std::size_t least_blocks = 10;                // of a group that is asked

struct Witness {  // of one row: place, whitened direction and residual
  double x = 0, a = 0, r = 0;
  std::size_t block = 0;  // within the group, ascending
};
struct Place {  // rows of one block at one place: sums of a^2 and of a r
  double x = 0, aa = 0, ar = 0;
  std::size_t block = 0;
};
struct GroupRows {
  std::vector<Place> places;
  std::size_t blocks = 0;
};

// r less what a (c + d x) takes of it.
void level(std::vector<Witness>& rows) {
  double mean = 0, weight = 0;
  for (const Witness& w : rows) mean += w.a * w.a * w.x, weight += w.a * w.a;
  if (!(weight > 0)) return;
  mean /= weight;
  double on = 0, slope = 0, spread = 0;
  for (const Witness& w : rows) {
    const double x = w.x - mean;
    on += w.a * w.r, slope += w.a * x * w.r, spread += w.a * w.a * x * x;
  }
  for (Witness& w : rows) w.r -= w.a * (on / weight + (spread > 0 ? slope / spread * (w.x - mean) : 0));
}

std::vector<GroupRows> witnesses(const System& system, const Condition& c, const std::vector<double>& residual) {
  const Observations& o = system.observations();
  std::vector<GroupRows> groups;
  for (const std::size_t g : system.groups) {
    std::vector<Witness> rows;
    std::map<std::uint32_t, std::size_t> blocks;
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      const double weight = system.weight(i), a = (c.direction.empty() ? 1 : c.direction[i]) * weight;
      if (!(weight > 0) || !std::isfinite(c.values[i]) || a == 0) continue;
      const std::size_t block = blocks.try_emplace(o.block[i], blocks.size()).first->second;
      rows.push_back({c.values[i], a, residual[i] * weight, block});
    }
    if (blocks.size() < least_blocks) continue;
    level(rows);
    std::map<std::pair<std::size_t, double>, std::pair<double, double>> sums;
    for (const Witness& w : rows) {
      auto& [aa, ar] = sums[{w.block, w.x}];
      aa += w.a * w.a, ar += w.a * w.r;
    }
    groups.push_back({{}, blocks.size()});
    for (const auto& [at, sum] : sums) groups.back().places.push_back({at.second, sum.first, sum.second, at.first});
  }
  return groups;
}

struct Answer {
  double fall = 0, wald = 0;  // of chi-square by least squares; robust
};
// 2 x 2: u' M^-1 u.
double form(double u, double v, double uu, double uv, double vv) {
  const double determinant = uu * vv - uv * uv;
  return determinant > 1e-9 * uu * vv ? (u * u * vv - 2 * u * v * uv + v * v * uu) / determinant : 0;
}

Answer answer(const GroupRows& group, double frequency) {
  std::vector<double> cosine(group.blocks), sine(group.blocks);
  double cc = 0, cs = 0, ss = 0;
  for (const Place& p : group.places) {
    const double turn = 2 * std::numbers::pi * frequency * p.x, c = std::cos(turn), s = std::sin(turn);
    cc += p.aa * c * c, cs += p.aa * c * s, ss += p.aa * s * s;
    cosine[p.block] += c * p.ar, sine[p.block] += s * p.ar;
  }
  double u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  for (std::size_t b = 0; b < group.blocks; ++b) {
    u += cosine[b], v += sine[b];
    uu += cosine[b] * cosine[b], uv += cosine[b] * sine[b], vv += sine[b] * sine[b];
  }
  const double blocks = static_cast<double>(group.blocks);
  return {form(u, v, cc, cs, ss), form(u, v, uu, uv, vv) * (blocks - 2) / blocks};
}

struct Best {
  double frequency = 0, fall = 0, wald = 0;
  std::size_t groups = 0, looks = 0;
};

Best best_of(const System& system, std::size_t condition, const std::vector<double>& residual) {
  const Condition& c = system.observations().conditions[condition];
  const std::vector<GroupRows> groups = witnesses(system, c, residual);
  std::set<double> values;
  for (const GroupRows& g : groups)
    for (const Place& p : g.places) values.insert(p.x);
  Best best;
  best.groups = groups.size();
  if (groups.empty() || values.size() < 2) return best;
  const double range = *values.rbegin() - *values.begin();
  const double most = std::min(most_periods, static_cast<double>(values.size()) / values_of_a_period);
  const auto look = [&](double n) {
    Answer all;
    for (const GroupRows& g : groups) {
      const Answer one = answer(g, n / range);
      all.fall += one.fall, all.wald += one.wald;
    }
    if (all.fall > best.fall) best.frequency = n / range, best.fall = all.fall, best.wald = all.wald;
    ++best.looks;
  };
  for (double n = least_periods; n <= most; n += 1 / steps) look(n);
  const double near = best.frequency * range;
  for (int k = -fine_steps; near > 0 && k <= fine_steps; ++k) look(near + k / (steps * fine_steps));
  return best;
}

}  // namespace

std::vector<OwnPhase> own_phases(const System& system, const std::vector<double>& values) {
  std::vector<std::size_t> asked;
  const std::vector<Condition>& conditions = system.observations().conditions;
  for (std::size_t c = 0; c < conditions.size(); ++c)
    if (conditions[c].within_groups) asked.push_back(c);
  if (asked.empty()) return {};
  const std::vector<double> residual = system.raw_residual(values);
  std::vector<Best> best(asked.size());
  parallel_for(0, asked.size(), [&](std::size_t k) { best[k] = best_of(system, asked[k], residual); });
  std::size_t looks = 0;
  for (const Best& b : best) looks += b.looks;
  std::vector<OwnPhase> found;
  for (std::size_t k = 0; k < asked.size(); ++k)
    if (best[k].frequency > 0)
      found.push_back({asked[k], 1 / best[k].frequency,
                       stats::sidak(stats::chi2_upper(best[k].wald, 2 * static_cast<double>(best[k].groups)),
                                    static_cast<double>(looks))});
  return found;
}

}  // namespace gonio::inference
