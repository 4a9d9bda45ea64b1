// See law_terms.h.
#include "inference/law_terms.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/unit.h"
#include "inference/wording.h"

namespace gonio::inference {
namespace {

constexpr double least_ratio = 1e-4;  // of the smallest to the largest value, for negative and broken powers
constexpr int scales_tried = 9;
constexpr double most_folds = 7;  // |x / scale| of an exponential: beyond a factor of a thousand its coefficient, which
                                  // is its value at zero, says nothing about what was seen

std::vector<double> powers_for(const ConditionKind& kind) {
  if (kind.periodic) return {};
  if (kind.crosses_zero) return {1, 2, 3, 4};
  if (!(kind.lower > least_ratio * kind.upper)) return {1, 2, 3, 4, 0.5};
  return {1, 2, -1, -2, 3, 4, 0.5, -0.5, 1.5};
}

double price_of(double power) {
  const double size = std::abs(power);
  if (size != std::floor(size)) return 2;
  return size <= 2 ? 0 : size - 2;
}

void add_shapes(const ConditionKind& kind, std::size_t c, double blocks, std::vector<Term>& terms) {
  if (kind.angle)
    for (const char* shape : {"sin", "cos"})
      for (const double scale : {1.0, 0.5}) terms.push_back({{}, shape, c, scale, false, c, scale == 1 ? 1.0 : 2.0});
  if (kind.periodic) return;
  const double range = kind.upper - kind.lower, largest = std::max(std::abs(kind.lower), std::abs(kind.upper));
  for (int k = 0; k < scales_tried; ++k)
    for (const double sign : {1.0, -1.0}) {
      const double scale = range * 0.04 * std::pow(50.0, k / (scales_tried - 1.0));
      if (largest <= most_folds * scale) terms.push_back({{}, "exp", c, sign * scale, true, c, 1 + std::log(blocks)});
    }
}

constexpr const char* radiance = "image.radiance";  // what was predicted: its curve is an absolute error

bool is_relative(const Condition& c) {
  return !c.direction.empty() && Unit(c.curve_unit).is_number() && c.name != radiance;
}

// The condition whose direction makes errors absolute; null: no direction does.
const Condition* absolute_condition(const std::vector<Condition>& conditions) {
  const auto found =
      std::find_if(conditions.begin(), conditions.end(), [](const Condition& c) { return c.name == radiance; });
  return found == conditions.end() ? nullptr : &*found;
}

// Of the observations, as far as the problem says.
Unit residual_unit(const Problem& problem) {
  if (const Condition* c = absolute_condition(problem.observations().conditions); c != nullptr) return Unit(c->unit);
  return problem.importance() == Importance::share_of_signal ? Unit() : Unit(problem.unit());
}

// Adds the same terms without a direction.
void add_absolute(std::vector<Term>& terms, std::size_t first) {
  const std::size_t last = terms.size();
  for (std::size_t k = first; k < last; ++k) {
    Term term = terms[k];
    term.along = Term::absolute;
    if (!term.powers.empty() || !term.shape.empty()) terms.push_back(std::move(term));
  }
}

double direction_of(const Condition& condition, std::size_t row) {
  return condition.direction.empty() ? 1 : condition.direction[row];
}

std::string number_in_words(double value, double sigma) {
  if (!(sigma > 0)) return printed(value);
  const int digits = std::clamp(static_cast<int>(std::floor(std::log10(std::abs(value) / sigma))) + 2, 1, 6);
  return "(" + printed(value, digits) + " ± " + printed(sigma, 2) + ")";
}

std::string power_in_words(const std::string& name, double power) {
  return power == 1 ? name : name + "^" + printed(power);
}

// Every condition over a round number of its own unit, so that the coefficient is the size of the term there.
std::string term_in_words(const LawTerm& t) {
  double size = 1;
  Unit unit(t.unit);
  std::string product;
  for (std::size_t k = 0; k < t.powers.size(); ++k) {
    const auto& [name, power] = t.powers[k];
    const LawTerm::Reference at = k < t.reference.size() ? t.reference[k] : LawTerm::Reference{};
    const bool bare = at.unit.empty();
    product += " * " + power_in_words(bare ? name : "(" + name + " / " + quantity(at.value, at.unit) + ")", power);
    if (bare) continue;
    size *= std::pow(at.value, power);
    unit = unit / Unit(at.unit).power(-power);
  }
  std::string text = number_in_words(t.coefficient * size, t.sigma * size);
  if (unit.text() != "1") text += " " + unit.text();
  text += product;
  if (t.shape == "exp") {
    text += std::string(" * exp(") + (t.scale > 0 ? "-" : "") + t.shape_of + " / " +
            number_in_words(std::abs(t.scale), t.scale_sigma) + (t.scale_unit == "1" ? "" : " " + t.scale_unit) + ")";
  } else if (!t.shape.empty()) {
    text += " * " + t.shape + "(" + (t.scale == 1 ? "" : printed(1 / t.scale) + " ") + t.shape_of + ")";
  }
  return text;
}

std::string wave_in_words(const LawTerm& c, const LawTerm& s) {
  const double size = std::hypot(c.coefficient, s.coefficient), turn = 2 * std::numbers::pi;
  const double sigma = std::hypot(c.coefficient * c.sigma, s.coefficient * s.sigma) / size;
  return number_in_words(size, sigma) + (c.unit != "1" ? " " + c.unit : "") + " * cos(2 pi " + c.shape_of + " / " +
         number_in_words(turn * c.scale, turn * c.scale_sigma) + (c.scale_unit == "1" ? "" : " " + c.scale_unit) +
         " - " + printed(std::atan2(s.coefficient, c.coefficient), 2) + ")";
}

}  // namespace

bool is_wave(const std::vector<LawTerm>& terms, std::size_t k) {
  if (k + 1 >= terms.size()) return false;
  const LawTerm &c = terms[k], &s = terms[k + 1];
  return c.shape == "cos" && s.shape == "sin" && c.shape_of == s.shape_of && c.scale == s.scale && c.scale_sigma > 0;
}

bool shares_scale(const Term& cosine, const Term& sine) {
  return cosine.shape == "cos" && sine.shape == "sin" && cosine.fitted_scale && sine.fitted_scale &&
         cosine.shape_of == sine.shape_of && cosine.scale == sine.scale;
}

ConditionKind kind_of(const System& system, std::size_t condition) {
  const Condition& c = system.observations().conditions[condition];
  ConditionKind kind;
  std::size_t applies = 0, used = 0;
  for (std::size_t i = 0; i < c.values.size(); ++i) {
    if (!(system.weight(i) > 0)) continue;
    ++used;
    if (!std::isfinite(c.values[i])) continue;
    kind.lower = applies == 0 ? c.values[i] : std::min(kind.lower, c.values[i]);
    kind.upper = applies == 0 ? c.values[i] : std::max(kind.upper, c.values[i]);
    ++applies;
  }
  const double range = kind.upper - kind.lower, size = std::max(std::abs(kind.lower), std::abs(kind.upper));
  kind.usable = 4 * applies >= used && applies > 8 && range > 1e-6 * size;
  kind.crosses_zero = kind.lower < 0;
  kind.angle = c.unit == "rad";
  kind.periodic = kind.angle && range > 3.3;  // more than half a turn
  return kind;
}

bool is_readable(const System& system, const Term& term) {
  if (term.shape != "exp") return true;
  const ConditionKind kind = kind_of(system, term.shape_of);
  return std::max(std::abs(kind.lower), std::abs(kind.upper)) <= most_folds * std::abs(term.scale);
}

std::vector<Term> possible_terms(const System& system, const std::vector<std::size_t>& leaders) {
  const std::size_t count = system.observations().conditions.size();
  std::vector<ConditionKind> kinds;
  for (std::size_t c = 0; c < count; ++c) kinds.push_back(kind_of(system, c));
  double blocks = 1;
  for (const std::uint32_t b : system.observations().block) blocks = std::max(blocks, b + 1.0);
  std::vector<Term> terms;
  for (std::size_t place = 0; place < leaders.size(); ++place) {
    const std::size_t c = leaders[place];
    if (!kinds[c].usable) continue;
    const std::size_t first = terms.size();
    terms.push_back({{}, "", c, 1, false, c, 0});  // in proportion to the direction itself
    for (const double power : powers_for(kinds[c]))
      terms.push_back({{{c, power}}, "", c, 1, false, c, price_of(power)});
    add_shapes(kinds[c], c, blocks, terms);
    for (std::size_t d = 0; d < count; ++d) {
      const auto earlier = std::find(leaders.begin(), leaders.begin() + static_cast<std::ptrdiff_t>(place), d);
      const bool done = earlier != leaders.begin() + static_cast<std::ptrdiff_t>(place);
      if (d == c || !kinds[d].usable || done) continue;
      for (const double p : powers_for(kinds[c]))
        for (const double q : powers_for(kinds[d]))
          if (std::abs(p) <= 2 && std::abs(q) <= 2)
            terms.push_back({{{c, p}, {d, q}}, "", c, 1, false, c, 2 + price_of(p) + price_of(q)});
    }
    if (is_relative(system.observations().conditions[c])) add_absolute(terms, first);
  }
  return terms;
}

std::vector<double> column_of(const System& system, const Term& term, const Mask& mask) {
  const std::vector<Condition>& conditions = system.observations().conditions;
  const Condition* along = term.along == Term::absolute ? absolute_condition(conditions) : &conditions[term.along];
  const bool shaped = !term.shape.empty(), exponential = term.shape == "exp", sine = term.shape == "sin";
  std::vector<double> column(system.observations().rows(), 0.0);
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (!(system.weight(i) > 0) || !(mask.empty() || mask[i])) continue;
    double value = along == nullptr ? 1 : direction_of(*along, i);
    for (const auto& [c, power] : term.powers) {
      const double x = conditions[c].values[i];
      value *= power == 1 ? x : power == 2 ? x * x : std::pow(x, power);
    }
    if (shaped) {
      const double x = conditions[term.shape_of].values[i] / term.scale;
      value *= exponential ? std::exp(-x) : sine ? std::sin(x) : std::cos(x);
    }
    if (std::isfinite(value)) column[i] = value;
  }
  return column;
}

namespace {

// The largest size met, to one digit as it is shown; nothing for plain numbers.
LawTerm::Reference reference_of(const System& system, std::size_t condition) {
  const Unit unit(system.observations().conditions[condition].unit);
  if (unit.is_number()) return {};
  const ConditionKind kind = kind_of(system, condition);
  const double largest = std::max(std::abs(kind.lower), std::abs(kind.upper));
  const double factor = shown_in(unit.text(), largest).factor;
  return {std::stod(printed(largest * factor, 1)) / factor, unit.text()};
}

}  // namespace

LawTerm told(const System& system, const Term& term, double coefficient, double sigma, double scale_sigma) {
  const Problem& problem = system.problem();
  const std::vector<Condition>& conditions = problem.observations().conditions;
  LawTerm t;
  t.coefficient = coefficient;
  t.sigma = sigma;
  Unit unit = residual_unit(problem);
  if (term.along != Term::absolute && !conditions[term.along].direction.empty() &&
      conditions[term.along].name != radiance) {
    t.along = conditions[term.along].name;
    unit = Unit(conditions[term.along].curve_unit);
  }
  for (const auto& [c, power] : term.powers) {
    unit = unit / Unit(conditions[c].unit).power(power);
    t.powers.emplace_back(conditions[c].name, power);
    t.reference.push_back(reference_of(system, c));
  }
  t.unit = unit.text();
  if (term.shape.empty()) return t;
  t.shape = term.shape;
  t.shape_of = conditions[term.shape_of].name;
  t.scale = term.scale;
  t.scale_sigma = scale_sigma;
  t.scale_unit = Unit(conditions[term.shape_of].unit).text();
  return t;
}

std::string in_words(const Problem& problem, const std::vector<LawTerm>& terms) {
  if (terms.empty()) return "";
  const std::vector<Condition>& conditions = problem.observations().conditions;
  const auto relative = [&](const LawTerm& t) {
    const auto along =
        std::find_if(conditions.begin(), conditions.end(), [&](const Condition& c) { return c.name == t.along; });
    return along != conditions.end() && is_relative(*along);
  };
  const bool all_relative = std::all_of(terms.begin(), terms.end(), relative);
  std::string text = "residual";
  if (all_relative)
    text = "relative residual";
  else if (!terms[0].along.empty() && !relative(terms[0]))
    text = "residual along " + terms[0].along;
  text += " =";
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const bool wave = is_wave(terms, k);
    text += (k == 0 ? " " : " + ") + (wave ? wave_in_words(terms[k], terms[k + 1]) : term_in_words(terms[k])) +
            (relative(terms[k]) && !all_relative ? " * prediction" : "");
    k += wave;
  }
  return text;
}

}  // namespace gonio::inference
