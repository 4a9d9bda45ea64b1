// See entry.h.
#include "inference/entry.h"

#include <algorithm>
#include <cmath>

#include "manifest/explanation_tables.h"

namespace gonio::inference {
namespace {

std::optional<double> where_finite(double v) {
  return std::isfinite(v) ? std::optional(v) : std::nullopt;
}

// Does `full` ("lens.radial.k1", "light-0/tilt_x_rad") name the mechanism's
// parameter `name`?
bool is_parameter(const std::string& full, const std::string& name) {
  if (full == name) return true;
  return full.size() > name.size() && full.ends_with(name) &&
         (full[full.size() - name.size() - 1] == '.' || full[full.size() - name.size() - 1] == '/');
}

// That the candidate is among what was left out.
double probability_of(const Explanation& e, std::size_t candidate) {
  double sum = 0;
  for (const Explanation::Weighed& w : e.weighed)
    if (std::find(w.candidates.begin(), w.candidates.end(), candidate) != w.candidates.end()) sum += w.probability;
  return std::min(sum, 1.0);
}

manifest::NamedMechanism named_mechanism(const Problem& problem, const Explanation& e, std::size_t candidate) {
  const Candidate& c = problem.candidates()[candidate];
  manifest::NamedMechanism entry;
  entry.mechanism = c.id();
  entry.on = c.on;
  if (!e.weighed.empty()) entry.probability = probability_of(e, candidate);
  for (const mechanism::Parameter& p : c.mechanism->parameters) {
    std::vector<double> value, width;
    manifest::NamedInterval interval{.name = p.name, .lower = {}, .upper = {}};
    for (const Estimate& estimate : e.estimates) {
      bool own = false;
      for (const std::size_t place : c.parameters) own = own || place == estimate.parameter;
      if (!own || !is_parameter(problem.parameters()[estimate.parameter].name, p.name)) continue;
      value.push_back(estimate.value);
      width.push_back(estimate.sigma);
      interval.lower.push_back(estimate.lower_95);
      interval.upper.push_back(estimate.upper_95);
    }
    if (value.empty()) continue;
    entry.parameters.emplace_back(p.name, value);
    entry.sigma.emplace_back(p.name, width);
    entry.interval_95.push_back(interval);
  }
  return entry;
}

std::vector<manifest::WeighedAnswer> weighed(const Problem& problem, const Explanation& e) {
  using Kind = Explanation::Weighed::Kind;
  std::vector<manifest::WeighedAnswer> list;
  for (const Explanation::Weighed& w : e.weighed) {
    manifest::WeighedAnswer& answer = list.emplace_back();
    answer.answer = w.kind == Kind::nothing ? "nothing" : w.kind == Kind::outside ? "outside" : "mechanisms";
    for (const std::size_t c : w.candidates) answer.mechanisms.push_back(problem.candidates()[c].id());
    answer.probability = w.probability;
    for (const auto& [name, value] : w.statistics) answer.statistics.push_back({name, {value}});
  }
  return list;
}

manifest::MismatchCondition located_condition(const LocatedCondition& c) {
  return {.condition = c.name,
          .range = {c.lower, c.upper},
          .unit = c.unit,
          .share = c.share,
          .effect = c.effect,
          .effect_unit = c.curve.value_unit};
}

std::optional<manifest::LocatedMismatch> located(const Explanation& e, const Illustration& illustration) {
  if (!e.significant || e.conditions.empty()) return {};
  manifest::LocatedMismatch result;
  static_cast<manifest::MismatchCondition&>(result) = located_condition(e.conditions[0]);
  result.observations = illustration.observations;
  if (!illustration.masks.empty()) result.mask = illustration.masks[0];
  if (illustration.masks.size() > 1) result.masks = illustration.masks;
  for (const Box& b : illustration.boxes) result.boxes.push_back({b.group, b.x, b.y, b.width, b.height});
  result.stage = e.stage;
  for (const LocatedCondition& c : e.conditions) result.conditions.push_back(located_condition(c));
  for (const LocatedGroup& g : e.groups) result.groups.push_back({g.name, g.share, g.before, g.after});
  return result;
}

std::vector<manifest::ScoredHypothesis> scoreboard(const Explanation& e) {
  std::vector<manifest::ScoredHypothesis> list;
  for (const Hypothesis& h : e.scoreboard) {
    const bool fitted = h.kind == Hypothesis::Kind::mechanisms;
    list.push_back({.hypothesis = h.name,
                    .held_out = h.held_out,
                    .gain = h.gain,
                    .gain_sigma = h.gain_sigma,
                    .effect = h.effect,
                    .p_neutral = fitted ? where_finite(h.wald_p) : std::nullopt,
                    .refused = h.refused});
  }
  return list;
}

std::vector<manifest::MechanismVisibility> isolability(const Problem& problem, const Explanation& e) {
  std::vector<manifest::MechanismVisibility> list;
  for (const Isolability& i : e.isolability) {
    const Candidate& c = problem.candidates()[i.candidate];
    manifest::MechanismVisibility entry;
    entry.mechanism = c.id();
    entry.on = c.on;
    entry.surviving_share = i.surviving_share;
    for (std::size_t k = 0; k < i.detection_limit.size(); ++k) {
      const std::string& name = problem.parameters()[c.parameters[k]].name;
      entry.detection_limit.push_back({name, {i.detection_limit[k]}});
      entry.limit_with_others.push_back({name, {i.limit_with_others[k]}});
    }
    for (const auto& [other, cosine] : i.look_alikes)
      entry.looks_like.push_back({problem.candidates()[other].id(), cosine});
    entry.visible = i.visible;
    list.push_back(std::move(entry));
  }
  return list;
}

std::vector<manifest::ShiftedParameter> compensation(const Problem& problem, const Explanation& e) {
  std::vector<manifest::ShiftedParameter> list;
  for (const Compensation& c : e.compensation) {
    manifest::ShiftedParameter entry;
    entry.parameter = problem.parameters()[c.parameter].name;
    entry.before = c.before, entry.after = c.after, entry.sigma = c.sigma;
    entry.unit = problem.parameters()[c.parameter].unit;
    if (c.calibrated) {
      entry.calibrated = {*c.calibrated, c.calibrated_sigma ? where_finite(*c.calibrated_sigma) : std::nullopt};
      entry.towards = c.towards;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

manifest::LawTermFound law_term(const LawTerm& t) {
  manifest::LawTermFound term;
  term.coefficient = t.coefficient, term.sigma = t.sigma;
  term.unit = t.unit, term.along = t.along;
  for (const auto& [condition, power] : t.powers) term.powers.push_back({condition, {power}});
  if (!t.shape.empty()) term.shape = {t.shape, t.shape_of, t.scale, t.scale_sigma, t.scale_unit};
  return term;
}

// A law of no known effect, or only where the structure is.
manifest::OutsideLibrary outside(const Outside& o) {
  manifest::OutsideLibrary entry;
  entry.condition = o.condition, entry.stage = o.stage;
  if (o.terms.empty()) return entry;
  entry.law = o.law;
  for (const LawTerm& t : o.terms) entry.terms.push_back(law_term(t));
  entry.share = where_finite(o.share);
  entry.extrapolated = o.extrapolated;
  entry.held_out = {o.held_out_before, o.held_out_after};
  return entry;
}

manifest::NextMeasurement next_measurement(const Problem& problem, const Explanation& e) {
  manifest::NextMeasurement next{.sentence = e.next_measurement, .plan = {}};
  for (const PlannedMeasurement& p : e.plan) {
    std::vector<std::string> ids;
    for (const std::size_t c : p.separates) ids.push_back(problem.candidates()[c].id());
    next.plan.push_back({p.sentence, p.setup, ids, p.z});
  }
  return next;
}

std::vector<std::string> ids_of(const Problem& problem, const std::vector<std::size_t>& set) {
  std::vector<std::string> ids;
  for (const std::size_t c : set) ids.push_back(problem.candidates()[c].id());
  return ids;
}

std::vector<manifest::NotToldApart> not_told_apart(const Problem& problem, const Explanation& e) {
  std::vector<manifest::NotToldApart> list;
  for (const std::vector<std::size_t>& set : e.not_told_apart)
    list.push_back({.mechanisms = ids_of(problem, set), .sets = {}});
  // Whole explanations, each a list of its own.
  for (const std::vector<std::size_t>& set : e.instead)
    list.push_back({.mechanisms = {}, .sets = {ids_of(problem, e.named), ids_of(problem, set)}});
  return list;
}

manifest::AnswerStability stability(const Problem& problem, const Explanation& e) {
  const Stability& s = *e.stability;
  manifest::AnswerStability entry{static_cast<std::int64_t>(s.draws),
                                  static_cast<std::int64_t>(s.groups),
                                  static_cast<std::int64_t>(s.same(problem, e.verdict, e.named)),
                                  {}};
  for (const Stability::Answer& a : s.answers)
    entry.answers.push_back({verdict_name(a.verdict), ids_of(problem, a.named), static_cast<std::int64_t>(a.times)});
  return entry;
}

}  // namespace

manifest::Value entry_of(const Problem& problem, const Explanation& e, const Illustration& illustration) {
  manifest::ExplanationEntry entry;
  entry.domain = problem.domain(), entry.verdict = verdict_name(e.verdict);
  if (!e.weighed.empty()) entry.probability = e.probability;
  entry.weighed = weighed(problem, e);
  for (const Misplaced::File& f : e.misplaced.files) entry.misplaced.push_back({f.group, f.shows, f.own, f.other});
  for (const std::size_t c : e.named) entry.named.push_back(named_mechanism(problem, e, c));
  entry.not_told_apart = not_told_apart(problem, e);
  if (e.outside) entry.outside = outside(*e.outside);
  for (const Explanation::Contradicted& c : e.contradicted)
    entry.contradicted.push_back({c.mechanism, c.by, c.quantity, c.before, c.after, c.unit});
  if (e.stability && e.stability->draws > 0) entry.stability = stability(problem, e);
  entry.located = located(e, illustration);
  entry.held_out = {.before = e.held_out_before,
                    .after = e.held_out_after,
                    .unit = problem.unit(),
                    .score = problem.score_name(),
                    .how = e.test_groups.empty() ? "each group left out in turn" : "test groups opened once",
                    .test_groups = {}};
  for (const std::size_t g : e.test_groups) entry.held_out.test_groups.push_back(problem.observations().group[g]);
  entry.fitted = {e.fitted_before, e.fitted_after};
  entry.null_test = {e.global_p, e.significant, e.important, e.smallest_effect};
  entry.noise.factor = e.noise_factor;
  entry.noise.blocks_set_aside = static_cast<std::int64_t>(e.outlier_blocks);
  for (const std::size_t g : e.odd_groups) entry.noise.groups_set_aside.push_back(problem.observations().group[g]);
  if (e.outliers) {
    entry.noise.outlying_readings = static_cast<std::int64_t>(e.outliers->readings);
    entry.noise.outlying_effect = e.outliers->effect;
  }
  entry.negative_controls = {static_cast<std::int64_t>(e.negative_controls), e.false_alarm};
  entry.scoreboard = scoreboard(e);
  entry.isolability = isolability(problem, e);
  entry.compensation = compensation(problem, e);
  entry.sentence = e.sentence;
  entry.next_measurement = next_measurement(problem, e);
  return manifest::Codec<manifest::ExplanationEntry>::write(entry);
}

}  // namespace gonio::inference
