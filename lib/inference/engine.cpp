// See engine.h: the order of the steps, and the last judgement.
#include "inference/engine.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/random.h"
#include "inference/compensation.h"
#include "inference/judgement.h"
#include "inference/law.h"
#include "inference/left_over.h"
#include "inference/noise.h"
#include "inference/odd_group.h"
#include "inference/plan.h"
#include "inference/profile.h"
#include "inference/race.h"
#include "inference/refinement.h"
#include "inference/sentence.h"
#include "stats/intervals.h"

namespace gonio::inference {
namespace {

constexpr std::size_t groups_for_a_test_set = 16;
constexpr std::size_t most_profiles = 4;  // of one mechanism

// A quarter of the groups, drawn by the seed, is opened once at the end; with few groups every one takes turns instead.
std::vector<std::size_t> draw_test_groups(const std::vector<std::size_t>& groups, std::uint64_t seed) {
  if (groups.size() < groups_for_a_test_set) return {};
  std::vector<std::size_t> order = groups;
  Random random(seed, 0x74657374u);
  for (std::size_t k = order.size() - 1; k > 0; --k)
    std::swap(order[k], order[random.below(static_cast<std::uint32_t>(k + 1))]);
  order.resize(std::max<std::size_t>(2, groups.size() / 4));
  std::sort(order.begin(), order.end());
  return order;
}

void set_aside_groups(const std::vector<std::size_t>& groups, System& system) {  // ascending
  std::erase_if(system.groups, [&](std::size_t g) { return std::binary_search(groups.begin(), groups.end(), g); });
}

// Whether there is a mismatch is asked of all groups: it chooses nothing, and the groups set aside judge names, not
// this.
double mismatch_p(const System& all, const std::vector<double>& start, Options options) {
  options.negative_controls = 0;
  const Race race(all, options);
  return residual_structure(race, race.base(start), options).global_p;
}

System in_play(const Problem& problem, const Options& options, const std::vector<std::size_t>& without = {}) {
  System system(problem, options.seed);
  set_aside_groups(without, system);
  if (system.groups.empty())
    throw Error(Exit::data, problem.domain(),
                "not one of the observations of " + std::to_string(problem.observations().groups()) + " " +
                    problem.group_noun() + "s counts",
                "look for masks, clipping and missing values that take all of them away");
  return system;
}

std::vector<double> starting_values(const Problem& problem) {
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  for (const std::size_t p : problem.base()) values[p] = problem.parameters()[p].start;
  return values;
}

double in_sample_score(const System& system, const std::vector<double>& residual) {
  const Observations& o = system.observations();
  double sum = 0, norm = 0;
  for (std::size_t i = 0; i < o.rows(); ++i) {
    if (!(system.weight(i) > 0)) continue;
    sum += residual[i] * residual[i];
    norm += o.norm[i];
  }
  return norm > 0 ? std::sqrt(sum / norm) : 0;
}

void locate_groups(const System& system, Explanation& e) {
  const Observations& o = system.observations();
  double total = 0;
  for (std::size_t g = 0; g < o.groups(); ++g) {
    if (system.used_rows(g) == 0) continue;
    LocatedGroup located{o.group[g], 0, 0, 0};
    double norm = 0;
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) {
      if (!(system.weight(i) > 0)) continue;
      const double z = e.residual_before[i] * system.weight(i);
      located.share += z * z - 1;
      located.before += e.residual_before[i] * e.residual_before[i];
      located.after += e.residual_after[i] * e.residual_after[i];
      norm += o.norm[i];
    }
    located.share = std::max(0.0, located.share);
    located.before = norm > 0 ? std::sqrt(located.before / norm) : 0;
    located.after = norm > 0 ? std::sqrt(located.after / norm) : 0;
    total += located.share;
    e.groups.push_back(located);
  }
  for (LocatedGroup& g : e.groups) g.share = total > 0 ? g.share / total : 0;
  std::stable_sort(e.groups.begin(), e.groups.end(),
                   [](const LocatedGroup& a, const LocatedGroup& b) { return a.share > b.share; });
}

// A bound that the domain itself begins at (no noise of rows), or that its prior reaches (half a code of rounding), is
// no limit of what is plausible.
bool is_far_from_start(const Parameter& p, double value) {
  const double away = std::abs(value - p.start);
  return away > 0 && !(p.prior_sigma && away <= 3 * *p.prior_sigma);
}

void final_fit(const System& system, const Race& race, const Selection& selection, Explanation& e) {
  Model base = selection.base, model = selection.model;
  if (!e.test_groups.empty()) {  // what was set aside joins
    base = race.base(selection.base.fit.values);
    model = selection.model.candidates.empty() ? base : race.changed(selection.model, selection.model.candidates);
  }
  e.converged = base.fit.converged && model.fit.converged;
  e.base_values = base.fit.values;
  e.residual_before = system.raw_residual(e.base_values);
  e.residual_after = system.raw_residual(model.fit.values);
  e.left_beyond_noise = beyond_noise(system, e.residual_after);
  // At a bound under the base model, and not freed of it by what is named: a mismatch that is explained pressed it
  // there.
  const auto inside = [](const Fit& f, std::size_t p) { return std::ranges::find(f.inner, p) != f.inner.end(); };
  for (const std::size_t p : base.fit.active)
    if (!inside(base.fit, p) && (model.candidates.empty() || !inside(model.fit, p)) &&
        is_far_from_start(system.problem().parameters()[p], base.fit.values[p]))
      e.at_limits.push_back(p);
  e.fitted_before = in_sample_score(system, e.residual_before);
  e.fitted_after = in_sample_score(system, e.residual_after);
  // What is reported by numbers is fitted to the exact simulation, where there is one.
  const std::optional<Refined> better = model.candidates.empty() ? std::nullopt : refined(system, model);
  const System& exact = better ? better->system : system;
  const Fit& best = better ? better->fit : model.fit;
  e.values = best.values;
  const Uncertainty u = uncertainty(exact, best);
  e.active = u.parameters;
  e.sigma.assign(e.values.size(), 0.0);
  for (Eigen::Index c = 0; c < u.covariance.rows(); ++c) {
    e.sigma[u.parameters[static_cast<std::size_t>(c)]] = std::sqrt(std::max(0.0, u.covariance(c, c)));
    for (Eigen::Index d = 0; d < u.covariance.cols(); ++d) e.covariance.push_back(u.covariance(c, d));
  }
  for (const std::size_t c : selection.model.candidates) {
    std::vector<Estimate> own = estimates(exact, best, u, system.problem().candidates()[c].parameters);
    std::size_t profiles = 0;
    for (Estimate& estimate : own)
      if (needs_profile(system.problem().parameters()[estimate.parameter], estimate) && profiles++ < most_profiles)
        set_profile_interval(exact, best, estimate);
    e.estimates.insert(e.estimates.end(), own.begin(), own.end());
  }
  for (const std::size_t p : race.free()) {
    if (model.candidates.empty() || !(e.sigma[p] > 0)) continue;
    if (system.problem().parameters()[p].groups.size() == 1) continue;
    e.compensation.push_back({p, e.base_values[p], model.fit.values[p], e.sigma[p]});
  }
  const auto shift = [](const Compensation& c) { return std::abs(c.after - c.before) / c.sigma; };
  std::stable_sort(e.compensation.begin(), e.compensation.end(),
                   [&](const Compensation& a, const Compensation& b) { return shift(a) > shift(b); });
}

// The scores on groups that no choice has seen; with few groups, the cross-validation that the choice was made with, by
// full refits.
void final_scores(const System& all, const System& chosen_on, const Selection& s, Explanation& e) {
  const auto score = [&](const Model& m) {
    return (e.test_groups.empty() ? held_out_by_refit(all, m.fit) : unseen_groups(chosen_on, m.fit, e.test_groups))
        .score();
  };
  e.held_out_before = score(s.base);
  e.held_out_after = s.model.candidates.empty() ? e.held_out_before : score(s.model);
}

void fill_scoreboard(const Selection& s, Explanation& e) {
  e.scoreboard = s.scoreboard;
  const auto append = [&](const Hypothesis& h, const char* prefix) {
    e.scoreboard.push_back(h);
    e.scoreboard.back().name = prefix + h.name;
  };
  for (std::size_t k = 0; k < std::min<std::size_t>(2, s.before.curves.size()); ++k)
    append(s.before.curves[k].hypothesis, "a free curve over ");
  if (!s.before.negative_controls.empty()) append(s.before.negative_controls[0], "best ");
}

// Best first, with the places of minor effects following.
void sort_scoreboard(const Selection& s, Explanation& e) {
  std::vector<std::size_t> order(e.scoreboard.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return e.scoreboard[a].held_out < e.scoreboard[b].held_out; });
  std::vector<Hypothesis> sorted;
  for (const std::size_t k : order) {
    if (std::find(s.minor.begin(), s.minor.end(), k) != s.minor.end()) e.minor.push_back(sorted.size());
    sorted.push_back(e.scoreboard[k]);
  }
  e.scoreboard = std::move(sorted);
}

// Limits as they stand once what was found no longer counts as noise within blocks.
std::vector<Isolability> final_isolability(const System& system, const Selection& s, const Options& options) {
  std::vector<double> inflation = s.before.inflation, known;
  for (const double v : s.after.inflation)
    if (v > 0) known.push_back(v);
  const double typical = known.empty() ? 0 : stats::median(known);
  for (std::size_t c = 0; c < inflation.size(); ++c) {
    const double after = s.after.inflation[c] > 0 ? s.after.inflation[c] : typical;
    if (after > 0) inflation[c] = std::min(inflation[c], after);
  }
  const Evidence& e = *s.before.evidence;
  return isolability(system, e.projection, e.structures, e.scores, inflation, options);
}

}  // namespace

std::string verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::null: return "null";
    case Verdict::named: return "named";
    case Verdict::ambiguous: return "ambiguous";
    case Verdict::unknown: return "unknown";
  }
  return "null";
}

double null_test(const Problem& problem, const Options& options) {
  System system = in_play(problem, options);
  const std::vector<double> start = starting_values(problem);
  settle_noise(system, start);
  return mismatch_p(system, start, options);
}

namespace {

void place_stage(const Problem& problem, Explanation& e) {
  if (!e.named.empty())
    e.stage = problem.candidates()[e.named[0]].mechanism->stage;
  else if (e.verdict == Verdict::unknown)
    e.stage = e.outside ? e.outside->stage : e.conditions.empty() ? "" : e.conditions[0].stage;
}

}  // namespace

namespace {

Explanation explain_without(const Problem& problem, const Options& options, const std::vector<std::size_t>& left_out,
                            const std::vector<std::size_t>& odd) {
  Explanation e;
  e.odd_groups = odd;
  e.smallest_effect = options.smallest_effect;
  e.sure = options.sure;
  System all = in_play(problem, options, left_out);
  set_aside_groups(odd, all);
  const std::vector<double> start = starting_values(problem);
  const NoiseFindings noise = settle_noise(all, start);
  e.noise_factor = noise.factor;
  e.outlier_blocks = noise.outlier_blocks;

  e.test_groups = draw_test_groups(all.groups, options.seed);
  System chosen_on = all;
  set_aside_groups(e.test_groups, chosen_on);
  const Race race(chosen_on, options);
  std::optional<double> mismatch;
  if (!e.test_groups.empty()) mismatch = mismatch_p(all, start, options);
  Selection selection = select(race, options, start, mismatch);

  e.global_p = selection.before.global_p;
  e.isolability = final_isolability(chosen_on, selection, options);
  e.conditions = selection.before.conditions;
  e.false_alarm = selection.after.false_alarm;
  e.negative_controls = selection.after.negative_controls.size();
  e.shortened = selection.shortened;
  final_scores(all, chosen_on, selection, e);
  fill_scoreboard(selection, e);
  judge(problem, selection, options, e);
  sort_scoreboard(selection, e);
  Selection kept = selection;
  if (e.named.empty()) kept.model = kept.base;
  final_fit(all, Race(all, options), kept, e);
  if (e.named.empty()) e.held_out_after = e.held_out_before;
  if (!odd.empty()) e.odd_score = unseen_groups(chosen_on, kept.model.fit, odd).score();
  locate_groups(all, e);
  place_conditions(all, e);
  place_stage(problem, e);
  compare_with_calibration(problem, e);
  find_law(all, e);
  make_plan(all, e);
  const Verdict verdict = e.verdict;
  const std::vector<std::size_t> named = e.named;
  problem.conclude(e);
  if (e.verdict != verdict || e.named != named)
    e.weighed.clear();  // by a test of the domain's own, which has its level
  write_sentence(problem, e);
  return e;
}

}  // namespace

Explanation explain(const Problem& problem, const Options& options, const std::vector<std::size_t>& left_out) {
  Explanation e = explain_without(problem, options, left_out, {});
  if (!e.significant || !e.named.empty() || !e.misplaced.files.empty()) return e;
  System all = in_play(problem, options, left_out);
  if (!odd_group_can_be_asked(all)) return e;
  const std::vector<double> start = starting_values(problem);
  settle_noise(all, start);
  const std::optional<std::size_t> odd = odd_group(Race(all, options), start);
  if (!odd) return e;
  Explanation without = explain_without(problem, options, left_out, {*odd});
  return without.verdict == Verdict::unknown ? e : without;
}

}  // namespace gonio::inference
