// See entry.h. Infinite and undefined numbers become null.
#include "inference/entry.h"

#include <cmath>

namespace gonio::inference {
namespace {

using manifest::Value;

Value number(double v) {
  return std::isfinite(v) ? Value(v) : Value();
}

Value numbers(const std::vector<double>& values) {
  Value list = Value::array();
  for (const double v : values) list.push_back(number(v));
  return list;
}

// Does `full` ("lens.radial.k1", "light-0/tilt_x_rad") name the mechanism's parameter `name`?
bool is_parameter(const std::string& full, const std::string& name) {
  if (full == name) return true;
  return full.size() > name.size() && full.ends_with(name) &&
         (full[full.size() - name.size() - 1] == '.' || full[full.size() - name.size() - 1] == '/');
}

// One number, or a list with one for each target.
Value gathered(const std::vector<double>& values) {
  return values.size() == 1 ? number(values[0]) : numbers(values);
}

Value named_mechanism(const Problem& problem, const Explanation& e, std::size_t candidate) {
  const Candidate& c = problem.candidates()[candidate];
  Value entry = Value::object({{"mechanism", c.id()}});
  if (!c.on.empty()) entry["on"] = c.on;
  Value parameters = Value::object(), sigma = Value::object(), interval = Value::object();
  for (const mechanism::Parameter& p : c.mechanism->parameters) {
    std::vector<double> value, width, lower, upper;
    for (const Estimate& estimate : e.estimates) {
      bool own = false;
      for (const std::size_t place : c.parameters) own = own || place == estimate.parameter;
      if (!own || !is_parameter(problem.parameters()[estimate.parameter].name, p.name)) continue;
      value.push_back(estimate.value);
      width.push_back(estimate.sigma);
      lower.push_back(estimate.lower_95);
      upper.push_back(estimate.upper_95);
    }
    if (value.empty()) continue;
    parameters[p.name] = gathered(value);
    sigma[p.name] = gathered(width);
    interval[p.name] = Value(Value::Array{gathered(lower), gathered(upper)});
  }
  entry["parameters"] = parameters;
  entry["sigma"] = sigma;
  entry["interval_95"] = interval;
  return entry;
}

Value located_condition(const LocatedCondition& c) {
  return Value::object({{"condition", c.name},
                        {"range", numbers({c.lower, c.upper})},
                        {"unit", c.unit},
                        {"share", number(c.share)},
                        {"effect", number(c.effect)},
                        {"effect_unit", c.curve.value_unit}});
}

Value located(const Explanation& e, const Illustration& illustration) {
  if (!e.significant || e.conditions.empty()) return {};
  Value result = located_condition(e.conditions[0]);
  if (!illustration.observations.empty()) result["observations"] = illustration.observations;
  if (!illustration.masks.empty()) result["mask"] = illustration.masks[0];
  if (illustration.masks.size() > 1) result["masks"] = illustration.masks;
  if (!illustration.boxes.empty()) {
    Value boxes = Value::array();
    for (const Box& b : illustration.boxes)
      boxes.push_back(Value::object(
          {{"group", b.group}, {"x_px", b.x}, {"y_px", b.y}, {"width_px", b.width}, {"height_px", b.height}}));
    result["boxes"] = boxes;
  }
  if (!e.stage.empty()) result["stage"] = e.stage;
  Value conditions = Value::array(), groups = Value::array();
  for (const LocatedCondition& c : e.conditions) conditions.push_back(located_condition(c));
  for (const LocatedGroup& g : e.groups)
    groups.push_back(Value::object(
        {{"group", g.name}, {"share", number(g.share)}, {"before", number(g.before)}, {"after", number(g.after)}}));
  result["conditions"] = conditions;
  result["groups"] = groups;
  return result;
}

Value scoreboard(const Explanation& e) {
  Value list = Value::array();
  for (const Hypothesis& h : e.scoreboard) {
    const bool fitted = h.kind == Hypothesis::Kind::mechanisms;
    Value entry = Value::object({{"hypothesis", h.name},
                                 {"held_out", number(h.held_out)},
                                 {"gain", number(h.gain)},
                                 {"gain_sigma", number(h.gain_sigma)},
                                 {"effect", number(h.effect)}});
    if (fitted) entry["p_neutral"] = number(h.wald_p);
    if (!h.refused.empty()) entry["refused"] = h.refused;
    list.push_back(entry);
  }
  return list;
}

Value isolability(const Problem& problem, const Explanation& e) {
  Value list = Value::array();
  for (const Isolability& i : e.isolability) {
    const Candidate& c = problem.candidates()[i.candidate];
    Value limits = Value::object(), with_others = Value::object(), look_alikes = Value::array();
    for (std::size_t k = 0; k < i.detection_limit.size(); ++k) {
      limits[problem.parameters()[c.parameters[k]].name] = number(i.detection_limit[k]);
      with_others[problem.parameters()[c.parameters[k]].name] = number(i.limit_with_others[k]);
    }
    for (const auto& [other, cosine] : i.look_alikes)
      look_alikes.push_back(
          Value::object({{"mechanism", problem.candidates()[other].id()}, {"cosine", number(cosine)}}));
    Value entry = Value::object({{"mechanism", c.id()}});
    if (!c.on.empty()) entry["on"] = c.on;
    entry["surviving_share"] = number(i.surviving_share);
    entry["detection_limit"] = limits;
    entry["limit_with_others"] = with_others;
    entry["looks_like"] = look_alikes;
    entry["visible"] = i.visible;
    list.push_back(entry);
  }
  return list;
}

Value compensation(const Problem& problem, const Explanation& e) {
  Value list = Value::array();
  for (const Compensation& c : e.compensation) {
    Value entry = Value::object({{"parameter", problem.parameters()[c.parameter].name},
                                 {"before", number(c.before)},
                                 {"after", number(c.after)},
                                 {"sigma", number(c.sigma)},
                                 {"unit", problem.parameters()[c.parameter].unit}});
    if (c.calibrated) {
      entry["calibrated"] = Value::object({{"value", number(*c.calibrated)}});
      if (c.calibrated_sigma) entry["calibrated"]["sigma"] = number(*c.calibrated_sigma);
      entry["towards"] = c.towards;
    }
    list.push_back(entry);
  }
  return list;
}

Value law_term(const LawTerm& t) {
  Value powers = Value::object();
  for (const auto& [condition, power] : t.powers) powers[condition] = power;
  Value term = Value::object({{"coefficient", number(t.coefficient)},
                              {"sigma", number(t.sigma)},
                              {"unit", t.unit},
                              {"along", t.along},
                              {"powers", powers}});
  if (!t.shape.empty())
    term["shape"] = Value::object({{"function", t.shape},
                                   {"of", t.shape_of},
                                   {"scale", number(t.scale)},
                                   {"scale_sigma", number(t.scale_sigma)},
                                   {"scale_unit", t.scale_unit}});
  return term;
}

// A law of no known effect, or only where the structure is.
Value outside(const Outside& o) {
  Value entry = Value::object({{"condition", o.condition}, {"stage", o.stage}});
  if (o.terms.empty()) return entry;
  Value terms = Value::array();
  for (const LawTerm& t : o.terms) terms.push_back(law_term(t));
  entry["law"] = o.law;
  entry["terms"] = terms;
  entry["share"] = number(o.share);
  entry["extrapolated"] = o.extrapolated;
  entry["held_out"] = Value::object({{"before", number(o.held_out_before)}, {"after", number(o.held_out_after)}});
  return entry;
}

Value misplaced(const Misplaced& m) {
  Value list = Value::array();
  for (const Misplaced::File& f : m.files)
    list.push_back(Value::object(
        {{"group", f.group}, {"shows", f.shows}, {"error", number(f.own)}, {"error_there", number(f.other)}}));
  return list;
}

Value next_measurement(const Problem& problem, const Explanation& e) {
  Value next = Value::object();
  if (!e.next_measurement.empty()) next["sentence"] = e.next_measurement;
  Value plan = Value::array();
  for (const PlannedMeasurement& p : e.plan) {
    std::vector<std::string> ids;
    for (const std::size_t c : p.separates) ids.push_back(problem.candidates()[c].id());
    plan.push_back(
        Value::object({{"sentence", p.sentence}, {"setup", p.setup}, {"separates", ids}, {"z", number(p.z)}}));
  }
  if (!e.plan.empty()) next["plan"] = plan;
  return next;
}

}  // namespace

Value entry_of(const Problem& problem, const Explanation& e, const Illustration& illustration) {
  Value named = Value::array(), apart = Value::array(), tests = Value::array();
  for (const std::size_t c : e.named) named.push_back(named_mechanism(problem, e, c));
  const auto ids_of = [&](const std::vector<std::size_t>& set) {
    std::vector<std::string> ids;
    for (const std::size_t c : set) ids.push_back(problem.candidates()[c].id());
    return ids;
  };
  for (const std::vector<std::size_t>& set : e.not_told_apart) apart.push_back(ids_of(set));
  // Whole explanations, each a list of its own.
  for (const std::vector<std::size_t>& set : e.instead)
    apart.push_back(Value(Value::Array{ids_of(e.named), ids_of(set)}));
  for (const std::size_t g : e.test_groups) tests.push_back(problem.observations().group[g]);
  Value entry = Value::object({{"domain", problem.domain()}, {"verdict", verdict_name(e.verdict)}});
  if (!e.misplaced.files.empty()) entry["misplaced"] = misplaced(e.misplaced);
  entry["named"] = named;
  entry["not_told_apart"] = apart;
  entry["outside"] = e.outside ? outside(*e.outside) : Value();
  entry["located"] = located(e, illustration);
  entry["held_out"] =
      Value::object({{"before", number(e.held_out_before)},
                     {"after", number(e.held_out_after)},
                     {"unit", problem.unit()},
                     {"score", problem.score_name()},
                     {"how", e.test_groups.empty() ? "each group left out in turn" : "test groups opened once"},
                     {"test_groups", tests}});
  entry["fitted"] = Value::object({{"before", number(e.fitted_before)}, {"after", number(e.fitted_after)}});
  entry["null_test"] = Value::object({{"p", number(e.global_p)},
                                      {"significant", e.significant},
                                      {"important", e.important},
                                      {"matters", number(e.matters)}});
  entry["noise"] = Value::object(
      {{"factor", number(e.noise_factor)}, {"blocks_set_aside", static_cast<std::int64_t>(e.outlier_blocks)}});
  entry["dummies"] =
      Value::object({{"run", static_cast<std::int64_t>(e.dummies)}, {"passed_share", number(e.false_alarm)}});
  entry["scoreboard"] = scoreboard(e);
  entry["isolability"] = isolability(problem, e);
  entry["compensation"] = compensation(problem, e);
  entry["sentence"] = e.sentence;
  entry["next_measurement"] = next_measurement(problem, e);
  return entry;
}

}  // namespace gonio::inference
