// See race.h: single models and the conditions of a name.
#include "explain/race.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

std::string family_of(const Candidate& c) {
  if (!c.family.empty()) return c.family;
  std::string family = c.id();
  for (const std::string& on : c.on) family += "/" + on;
  return family;
}

bool has_numbers_of_groups(const System& system, const std::vector<std::size_t>& candidates) {
  return std::any_of(candidates.begin(), candidates.end(), [&](std::size_t c) {
    const std::vector<std::size_t>& own = system.problem().candidates()[c].parameters;
    return std::all_of(own.begin(), own.end(),
                       [&](std::size_t p) { return system.problem().parameters()[p].groups.size() == 1; });
  });
}

bool is_protected(const std::string& name, const std::vector<std::string>& protect) {
  return std::any_of(protect.begin(), protect.end(),
                     [&](const std::string& p) { return name == p || name.starts_with(p + "/"); });
}

}  // namespace

Race::Race(const System& system, const Options& options) : system_(system), options_(options) {
  const Problem& problem = system.problem();
  for (std::size_t c = 0; c < problem.candidates().size(); ++c) {
    const std::string& id = problem.candidates()[c].id();
    if (options.hypotheses.empty() ||
        std::find(options.hypotheses.begin(), options.hypotheses.end(), id) != options.hypotheses.end())
      allowed_.push_back(c);
  }
  for (const std::size_t p : problem.base())
    if (!is_protected(problem.parameters()[p].name, options.protect)) free_.push_back(p);
}

Model Race::base(const std::vector<double>& start) const {
  Model m;
  m.fit = fit(system_, start, free_);
  m.held_out = held_out_by_step(system_, m.fit);
  return m;
}

Model Race::changed(const Model& from, std::vector<std::size_t> candidates) const {
  const Problem& problem = system_.problem();
  const auto has = [](const std::vector<std::size_t>& set, std::size_t c) {
    return std::find(set.begin(), set.end(), c) != set.end();
  };
  std::vector<double> start = from.fit.values;
  std::vector<std::size_t> active = free_;
  for (const std::size_t c : from.candidates)
    if (!has(candidates, c))
      for (const std::size_t p : problem.candidates()[c].parameters) start[p] = problem.parameters()[p].neutral;
  for (const std::size_t c : candidates)
    for (const std::size_t p : problem.candidates()[c].parameters) {
      if (!has(from.candidates, c)) start[p] = problem.parameters()[p].start;
      active.push_back(p);
    }
  Model m{std::move(candidates), {}, {}};
  m.fit = fit(system_, std::move(start), active);
  m.held_out = held_out_by_step(system_, m.fit);
  return m;
}

std::vector<std::size_t> Race::open_to(const Model& model) const {
  const std::vector<Candidate>& all = system_.problem().candidates();
  std::vector<std::size_t> result;
  for (const std::size_t c : allowed_) {
    const auto relative = [&](std::size_t other) { return family_of(all[other]) == family_of(all[c]); };
    if (std::none_of(model.candidates.begin(), model.candidates.end(), relative)) result.push_back(c);
  }
  return result;
}

std::string Race::name_of(const std::vector<std::size_t>& candidates) const {
  std::string name;
  for (const std::size_t c : candidates) {
    const Candidate& candidate = system_.problem().candidates()[c];
    name += (name.empty() ? "" : " + ") + candidate.id();
    if (candidate.on.empty()) continue;
    name += " (";
    for (std::size_t k = 0; k < candidate.on.size(); ++k) name += (k == 0 ? "" : ", ") + candidate.on[k];
    name += ")";
  }
  return name;
}

double Race::effect(const Model& before, const Model& after) const {
  if (system_.problem().importance() == Importance::share_of_residual) {
    const double score = before.held_out.score();
    return score > 0 ? 1 - after.held_out.score() / score : 0;
  }
  const Observations& o = system_.observations();
  std::vector<double> moved(system_.groups.size()), norm(system_.groups.size());
  parallel_for(0, moved.size(), [&](std::size_t k) {
    const std::size_t group = system_.groups[k], first = o.first[group];
    const Eigen::VectorXd change =
        system_.residual(before.fit.values, group) - system_.residual(after.fit.values, group);
    for (std::size_t i = first; i < o.first[group + 1]; ++i) {
      if (!(system_.weight(i) > 0)) continue;
      const double raw = change[static_cast<Eigen::Index>(i - first)] / system_.weight(i);
      moved[k] += raw * raw;
      norm[k] += o.norm[i];
    }
  });
  double sum = 0, total = 0;
  for (std::size_t k = 0; k < moved.size(); ++k) sum += moved[k], total += norm[k];
  return total > 0 ? std::sqrt(sum / total) : 0;
}

Hypothesis Race::judged(const Model& before, const Model& after, const std::vector<std::size_t>& added,
                        const std::vector<Hypothesis>& dummies, std::size_t looks) const {
  Hypothesis h;
  h.kind = Hypothesis::Kind::mechanisms;
  h.candidates = added;
  h.name = name_of(added);
  h.held_out = after.held_out.score();
  const Gain g = gain(before.held_out, after.held_out);
  h.gain = g.mean;
  h.gain_sigma = g.sigma;
  h.effect = effect(before, after);
  std::vector<std::size_t> parameters;
  for (const std::size_t c : added) {
    const std::vector<std::size_t>& own = system_.problem().candidates()[c].parameters;
    parameters.insert(parameters.end(), own.begin(), own.end());
  }
  const Uncertainty u = uncertainty(system_, after.fit);
  h.parameters = estimates(system_, after.fit, u, parameters);
  // The least certain of several added mechanisms decides.
  h.wald_p = 0;
  for (const std::size_t c : added)
    h.wald_p = std::max(h.wald_p, neutral_p(system_, after.fit, u, system_.problem().candidates()[c].parameters));
  // A free hand in every group beats physics that all groups share: dummies are held against mechanisms of their own
  // kind.
  const bool grouped = has_numbers_of_groups(system_, added);
  std::ptrdiff_t peers = 0, rivals = 0;
  for (const Hypothesis& dummy : dummies) {
    if (has_numbers_of_groups(system_, dummy.candidates) != grouped) continue;
    ++peers;
    rivals += dummy.gain > h.gain + h.gain_sigma;
  }
  const auto at_bound =
      std::find_if(h.parameters.begin(), h.parameters.end(), [](const Estimate& e) { return e.at_bound; });
  // Numbers of single groups soak up any misfit, so that their being away from neutral proves nothing: held-out groups
  // alone speak.
  const double freedom = static_cast<double>(system_.groups.size()) - 1;
  const bool by_chance =
      grouped && !(h.gain_sigma > 0 && stats::student_upper(h.gain / h.gain_sigma, freedom) <= options_.level);
  if (!(h.gain > h.gain_sigma))
    h.refused = "does not lower the held-out score beyond its standard error";
  else if (by_chance)
    h.refused =
        "has a number for every " + system_.problem().group_noun() + ", and too few of them agree that it helps";
  else if (10 * rivals > peers)
    h.refused = "dummies without physics do better";
  else if (stats::sidak(h.wald_p, static_cast<double>(looks)) > options_.level)
    h.refused = "its parameters cannot be told from neutral";
  else if (at_bound != h.parameters.end())
    h.refused = system_.problem().parameters()[at_bound->parameter].name + " ends at the limit of what is plausible";
  else if (h.effect < options_.matters)
    h.refused = "smaller than what matters";
  return h;
}

}  // namespace gonio::explain
