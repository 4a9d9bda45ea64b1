// See race.h: single models and the conditions of a name.
#include "inference/race.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/parallel.h"
#include "stats/distributions.h"
#include "stats/intervals.h"
#include "stats/signed_rank.h"

namespace gonio::inference {
namespace {

constexpr int chords = 25;                            // steps of a fit with kept slopes
constexpr int tangents = 20;                          // of a hypothesis in the race: leaders are fitted to the end
constexpr int turns = 3;                              // how often the slopes may be taken anew
constexpr double idle = 0.01;                         // of what a fit has gained: no number that costs less is held
constexpr double much = 0.1;                          // of the sum of whitened squares
constexpr double far_less = 0.75;                     // of what was gained or promised, on groups left out
constexpr double usual_reach = 3;                     // typical sizes: where a bound lies so near, it may be reached
constexpr double small_gain = 0.005, small_cost = 4;  // of the sum of whitened squares: not worth new slopes

constexpr double least_block_z = 5;  // of a claim about single groups

std::string family_of(const Candidate& c) {
  if (!c.family.empty()) return c.family;
  std::string family = c.id();
  for (const std::string& on : c.on) family += "/" + on;
  return family;
}

// Most of its numbers at least: one that all groups share (the period of a flicker) does not tie the others.
bool has_numbers_of_groups(const System& system, const std::vector<std::size_t>& candidates) {
  return std::any_of(candidates.begin(), candidates.end(), [&](std::size_t c) {
    const std::vector<std::size_t>& own = system.problem().candidates()[c].parameters;
    const auto single =
        std::ranges::count_if(own, [&](std::size_t p) { return system.problem().parameters()[p].groups.size() == 1; });
    return 2 * static_cast<std::size_t>(single) > own.size();
  });
}

// A claim about one or two groups among more: groups that it says nothing about have nothing to gain, so that the
// spread over groups would hide what single blocks show.
bool is_about_few_groups(const System& system, const std::vector<std::size_t>& candidates) {
  std::set<std::size_t> groups;
  for (const std::size_t c : candidates)
    for (const std::size_t p : system.problem().candidates()[c].parameters) {
      const std::vector<std::size_t>& own = system.problem().parameters()[p].groups;
      if (own.empty()) return false;
      groups.insert(own.begin(), own.end());
    }
  return groups.size() <= 2 && 2 * groups.size() <= system.groups.size();
}

bool is_protected(const std::string& name, const std::vector<std::string>& protect) {
  return std::any_of(protect.begin(), protect.end(),
                     [&](const std::string& p) { return name == p || name.starts_with(p + "/"); });
}

// The chance that unseen rows are so much the better for nothing. By the falls of single blocks, with as many degrees
// as blocks bear them, (sum d^2)^2 / sum d^4 less one; and by their signed ranks, where a few strong blocks, an edge
// here and there, leave too few degrees to say what many agree about. The smaller of two p-values counts twice. A
// linear interval speaks neither at a bound nor along a flat likelihood; this does.
double unseen_p(const HeldOut& before, const HeldOut& after) {
  double squares = 0, fourths = 0;
  std::vector<double> falls;
  for (std::size_t b = 0; b < std::min(before.blocks.size(), after.blocks.size()); ++b) {
    const double d = before.blocks[b] - after.blocks[b];
    falls.push_back(d);
    squares += d * d, fourths += d * d * d * d;
  }
  const double degrees = fourths > 0 ? squares * squares / fourths - 1 : 0;
  const double by_size = degrees > 1 ? stats::student_upper(block_z(before, after), degrees) : 1;
  return std::min(1.0, 2 * std::min(by_size, stats::signed_rank_upper(falls)));
}

// The chance that unseen groups are so much the better for nothing: by their mean over its standard error, and by their
// signed ranks, where a few that gain much leave the mean too wide to say what all of them agree about. The smaller of
// two p-values counts twice.
double groups_p(const HeldOut& before, const HeldOut& after, const Hypothesis& h) {
  std::vector<double> falls;
  for (std::size_t k = 0; k < before.whitened.size(); ++k) falls.push_back(before.whitened[k] - after.whitened[k]);
  const double freedom = static_cast<double>(falls.size()) - 1,
               by_size = h.gain_sigma > 0 ? stats::student_upper(h.gain / h.gain_sigma, freedom) : 1;
  return std::min(1.0, 2 * std::min(by_size, stats::signed_rank_upper(falls, 1)));
}

}  // namespace

const mechanism::Parameter* declared(const Candidate& candidate, const Parameter& parameter) {
  const std::string& full = parameter.name;
  for (const mechanism::Parameter& p : candidate.mechanism->parameters) {
    if (!full.ends_with(p.name)) continue;
    const char before = full.size() == p.name.size() ? '.' : full[full.size() - p.name.size() - 1];
    if (before == '.' || before == '/') return &p;
  }
  return nullptr;
}

double typical_size(const Candidate& candidate, const Parameter& parameter) {
  const mechanism::Parameter* own = declared(candidate, parameter);
  return own == nullptr ? 0 : own->typical;
}

std::string at_a_limit(const Problem& problem, const Fit& fit, const std::vector<std::size_t>& candidates) {
  for (const std::size_t c : candidates)
    for (const std::size_t p : problem.candidates()[c].parameters) {
      const Parameter& parameter = problem.parameters()[p];
      if (std::find(fit.inner.begin(), fit.inner.end(), p) != fit.inner.end()) continue;
      const double away = std::abs(fit.values[p] - parameter.neutral);
      if (!(away <= usual_reach * typical_size(problem.candidates()[c], parameter))) return parameter.name;
    }
  return "";
}

Race::Race(const System& system, const Options& options) : system_(system), options_(options) {
  const Problem& problem = system.problem();
  const std::vector<std::size_t> apart = problem.tested_apart();
  for (std::size_t c = 0; c < problem.candidates().size(); ++c) {
    if (std::ranges::find(apart, c) != apart.end()) continue;
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

Model Race::changed(const Model& from, std::vector<std::size_t> candidates, const Slopes* kept) const {
  const Problem& problem = system_.problem();
  std::vector<double> start;
  for (const std::size_t c : candidates) {
    const bool known = std::find(from.candidates.begin(), from.candidates.end(), c) != from.candidates.end();
    for (const std::size_t p : problem.candidates()[c].parameters)
      start.push_back(known ? from.fit.values[p] : problem.parameters()[p].start);
  }
  return started(from, std::move(candidates), start, kept);
}

std::pair<std::vector<double>, std::vector<std::size_t>> Race::beginning(const Model& from,
                                                                         const std::vector<std::size_t>& candidates,
                                                                         const std::vector<double>& start) const {
  const Problem& problem = system_.problem();
  std::vector<double> values = from.fit.values;
  std::vector<std::size_t> active = free_;
  for (const std::size_t c : from.candidates)
    for (const std::size_t p : problem.candidates()[c].parameters) values[p] = problem.parameters()[p].neutral;
  std::size_t place = 0;
  for (const std::size_t c : candidates)
    for (const std::size_t p : problem.candidates()[c].parameters) {
      values[p] = start[place++];
      active.push_back(p);
    }
  return {std::move(values), std::move(active)};
}

double Race::promised_cost(const Model& from, const std::vector<std::size_t>& candidates,
                           const std::vector<double>& start, const Slopes& kept) const {
  const auto [values, active] = beginning(from, candidates, start);
  const Fit there = fit(system_, values, active, 0);
  return there.cost - decrement(system_, there, kept);
}

Model Race::started(const Model& from, std::vector<std::size_t> candidates, const std::vector<double>& start,
                    const Slopes* kept, double promise) const {
  auto [values, active] = beginning(from, candidates, start);
  Model m{std::move(candidates), {}, {}};
  if (kept == nullptr) {
    m.fit = fit(system_, std::move(values), active);
    free_from_bounds(m);
    m.held_out = held_out_by_step(system_, m.fit);
    return m;
  }
  auto [reached, turned, promised] = along_chords(from, values, active, *kept);
  m.fit = std::move(reached);
  // Chords that are stuck show by what tangents promise there, however much was gained on the way.
  double gained = from.fit.cost - m.fit.cost;
  const bool gradual = std::any_of(m.candidates.begin(), m.candidates.end(),
                                   [&](std::size_t c) { return system_.problem().candidates()[c].gradual; });
  if (!gradual && (gained < 0.5 * promise || gained < promised)) {
    Fit anew = fit(system_, std::move(values), active, tangents);
    if (anew.cost < m.fit.cost) {
      m.fit = std::move(anew);
      gained = from.fit.cost - m.fit.cost;
      turned = slopes(system_, m.fit.values, active);
    }
  }
  free_from_bounds(m);
  m.held_out = held_out_by_step(system_, m.fit, turned ? &*turned : kept);
  // Far less better on groups left out than linear folds promised, or than on those in play: a step along a valley that
  // has turned since these slopes were taken.
  double rows = 0;
  for (const double own : m.held_out.rows) rows += own;
  if (gained > much * from.fit.cost &&
      rows * gain(from.held_out, m.held_out).mean < far_less * std::max(gained, promise)) {
    HeldOut anew = held_out_by_step(system_, m.fit);
    if (gain(m.held_out, anew).mean > 0) m.held_out = std::move(anew);
  }
  // Much better on the groups in play and no better on those left out: it stopped half-way, where a step from the joint
  // optimum says nothing.
  if (gained > much * from.fit.cost && !(gain(from.held_out, m.held_out).mean > 0)) {
    m.fit = fit(system_, m.fit.values, active);
    free_from_bounds(m);
    m.held_out = held_out_by_step(system_, m.fit);
  }
  return m;
}

void Race::free_from_bounds(Model& m) const {
  const Problem& problem = system_.problem();
  std::optional<double> nothing;  // cost without any of the candidates
  for (const std::size_t c : m.candidates)
    for (const std::size_t p : problem.candidates()[c].parameters) {
      if (std::find(m.fit.inner.begin(), m.fit.inner.end(), p) != m.fit.inner.end()) continue;
      std::vector<double> values = m.fit.values;
      values[p] = problem.parameters()[p].neutral;
      if (values[p] == m.fit.values[p]) continue;
      if (!nothing) nothing = fit(system_, beginning(m, {}, {}).first, m.fit.active, 0).cost;
      const double gained = *nothing - m.fit.cost;
      const auto costs_no_more = [&](const Fit& other) { return other.cost - m.fit.cost < idle * gained; };
      Fit other = fit(system_, values, m.fit.active, 0);
      other.converged = m.fit.converged;
      if (!costs_no_more(other) && gained > much * *nothing && !at_a_limit(problem, m.fit, {c}).empty())
        other = fit(system_, std::move(values), m.fit.active, tangents);
      if (costs_no_more(other)) m.fit = std::move(other);
    }
}

// Where tangents promise more than a small part of what the chords have gained, they take the chords' place.
Race::AlongChords Race::along_chords(const Model& from, std::vector<double> values,
                                     const std::vector<std::size_t>& active, const Slopes& kept) const {
  AlongChords at;
  for (int turn = 0;; ++turn) {
    at.fit = fit(system_, std::move(values), active, chords, at.turned ? &*at.turned : &kept);
    Slopes fresh = slopes(system_, at.fit.values, active);
    at.promised = decrement(system_, at.fit, fresh);
    const double gained = std::max(0.0, from.fit.cost - at.fit.cost);
    if (turn == turns || at.promised < small_gain * gained + small_cost) return at;
    values = at.fit.values;
    at.turned = std::move(fresh);
  }
}

Slopes Race::slopes_at(const Model& model) const {
  std::vector<std::size_t> parameters = free_;
  for (const std::size_t c : model.candidates) {
    const std::vector<std::size_t>& own = system_.problem().candidates()[c].parameters;
    parameters.insert(parameters.end(), own.begin(), own.end());
  }
  return slopes(system_, model.fit.values, std::move(parameters));
}

std::vector<std::size_t> Race::open_to(const Model& model) const {
  std::vector<std::size_t> result;
  for (const std::size_t c : allowed_) {
    const auto bars = [&](std::size_t other) { return never_together(other, c); };
    if (std::none_of(model.candidates.begin(), model.candidates.end(), bars)) result.push_back(c);
  }
  return result;
}

bool Race::relatives(std::size_t a, std::size_t b) const {
  const std::vector<Candidate>& all = system_.problem().candidates();
  return family_of(all[a]) == family_of(all[b]);
}

bool Race::never_together(std::size_t a, std::size_t b) const {
  return relatives(a, b) || system_.problem().excludes(a, b);
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
  double share = total > 0 ? std::sqrt(sum / total) : 0;
  for (const std::size_t c : after.candidates) {
    const std::optional<std::size_t> all = system_.problem().candidates()[c].share_of_readings;
    if (!all || std::ranges::find(before.candidates, c) != before.candidates.end()) continue;
    share = std::max(share, std::abs(after.fit.values[*all] - system_.problem().parameters()[*all].neutral));
  }
  return share;
}

Hypothesis Race::judged(const Model& before, const Model& after, const std::vector<std::size_t>& added,
                        const std::vector<Hypothesis>& negative_controls, std::size_t looks, const Slopes* kept) const {
  Hypothesis h;
  h.kind = Hypothesis::Kind::mechanisms;
  h.candidates = added;
  h.name = name_of(added);
  h.held_out = after.held_out.score();
  const Gain g = gain(before.held_out, after.held_out);
  h.gain = g.mean;
  h.gain_sigma = g.sigma;
  const bool about_few = is_about_few_groups(system_, added);
  const double blocks_z = about_few ? block_z(before.held_out, after.held_out) : 0;
  if (blocks_z > 0) h.gain_sigma = h.gain / blocks_z;
  h.effect = effect(before, after);
  std::vector<std::size_t> parameters;
  for (const std::size_t c : added) {
    const std::vector<std::size_t>& own = system_.problem().candidates()[c].parameters;
    parameters.insert(parameters.end(), own.begin(), own.end());
  }
  const Uncertainty u = uncertainty(system_, after.fit, kept);
  h.parameters = estimates(system_, after.fit, u, parameters);
  // The least certain of several added mechanisms decides. Groups that disagree about the size of an effect do not say
  // that there is none where they agree that it helps: there blocks alone speak.
  const bool helps = added.size() == 1 && g.mean > 2 * g.sigma;
  h.wald_p = 0;
  for (const std::size_t c : added)
    h.wald_p =
        std::max(h.wald_p, neutral_p(system_, after.fit, u, system_.problem().candidates()[c].parameters, helps));
  if (helps) h.wald_p = std::min(h.wald_p, unseen_p(before.held_out, after.held_out));
  // A free hand in every group beats physics that all groups share: negative controls are held against mechanisms of
  // their own kind.
  const bool grouped = has_numbers_of_groups(system_, added);
  std::ptrdiff_t peers = 0, rivals = 0;
  for (const Hypothesis& negative_control : negative_controls) {
    if (has_numbers_of_groups(system_, negative_control.candidates) != grouped) continue;
    ++peers;
    rivals += negative_control.gain > h.gain + h.gain_sigma;
  }
  const std::string limit = at_a_limit(system_.problem(), after.fit, added);
  // Numbers of single groups soak up any misfit, so that their being away from neutral proves nothing: held-out groups
  // alone speak.
  const bool by_chance = grouped && !(about_few && blocks_z > least_block_z) &&
                         groups_p(before.held_out, after.held_out, h) > options_.level;
  if (!(h.gain > h.gain_sigma))
    h.refused = "does not lower the held-out score beyond its standard error";
  else if (by_chance)
    h.refused =
        "has a number for every " + system_.problem().group_noun() + ", and too few of them agree that it helps";
  else if (10 * rivals > peers)
    h.refused = "negative controls without physics do better";
  else if (stats::sidak(h.wald_p, static_cast<double>(looks)) > options_.level)
    h.refused = "its parameters cannot be told from neutral";
  else if (!limit.empty())
    h.refused = limit + " ends at the limit of what is plausible";
  else if (h.effect < options_.smallest_effect)
    h.refused = smaller_than_what_matters;
  return h;
}

}  // namespace gonio::inference
