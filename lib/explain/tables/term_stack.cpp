// See term_stack.h.
#include "explain/tables/term_stack.h"

#include <algorithm>
#include <cmath>

#include "explain/tables/unit.h"

namespace gonio::explain::tables {
namespace {

constexpr std::size_t none = Table::none;

double largest_observation(const Table& table) {
  double largest = 0;
  for (const std::size_t c : table.observed)
    for (const double v : table.values[c]) largest = std::max(largest, std::abs(v));
  return largest > 0 ? largest : 1;
}

std::vector<double> values_at(const Table& table, const TermColumn& column) {
  const std::vector<double>* values = table.find(column.name);
  if (values == nullptr) return std::vector<double>(table.rows(), std::nan(""));
  std::vector<double> at = *values;
  const double least = column.from_least ? *std::min_element(at.begin(), at.end()) : 0;
  for (double& v : at) v -= least;
  const double most = column.as_share ? *std::max_element(at.begin(), at.end()) : 1;
  for (double& v : at) v /= most;
  return at;
}

TermParameter declared(const mechanism::Parameter& p) {
  const double size = std::max({std::abs(p.start - p.neutral), 1e-3 * std::min(p.upper - p.lower, 1e3), 1e-9});
  return {p.start, p.lower, p.upper, size, TermParameter::Use::free, false};
}

}  // namespace

std::vector<const Term*> all_forms() {
  std::vector<const Term*> forms;
  for (const Term* term : all_terms()) {
    forms.push_back(term);
    for (const Term& form : term->alternatives) forms.push_back(&form);
  }
  return forms;
}

bool is_applicable(const Term& term, const Table& table, const std::string& model) {
  if (!term.models.empty() && std::find(term.models.begin(), term.models.end(), model) == term.models.end())
    return false;
  for (const TermColumn& column : term.columns) {
    if (!column.needed) continue;
    const std::size_t c = table.place_of(column.name);
    if (c == none || !table.labels[c].empty()) return false;
    if (parse_unit(table.units[c], table.place).powers != parse_unit(column.unit, table.place).powers) return false;
    if (term.applies == nullptr && !table.varies(column.name)) return false;
  }
  return term.applies == nullptr || term.applies(table);
}

TermStack::TermStack(const Table& table, const std::string& model, const std::vector<std::string>& done,
                     std::size_t offset)
    : observed_(table.observed.size()), offset_(offset) {
  std::vector<const Term*> terms;
  for (const Term* term : all_forms()) {
    if (std::find(done.begin(), done.end(), term->mechanism().id) != done.end()) continue;
    if (is_applicable(*term, table, model)) terms.push_back(term);
  }
  std::stable_sort(terms.begin(), terms.end(), [](const Term* a, const Term* b) { return a->order < b->order; });
  for (const Term* term : terms) bind(table, *term);
}

void TermStack::bind(const Table& table, const Term& term) {
  const mechanism::Mechanism& m = term.mechanism();
  std::vector<TermParameter> settings;
  for (const mechanism::Parameter& p : m.parameters) settings.push_back(declared(p));
  if (term.adapt != nullptr) term.adapt(table, largest_observation(table), settings);
  Bound bound{&term, {}, {}, {}, {}};
  for (const TermColumn& column : term.columns) bound.at.push_back(values_at(table, column));
  Candidate candidate{&m, {}, {}, {}};
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const TermParameter& s = settings[k];
    const mechanism::Parameter& p = m.parameters[k];
    bound.fixed.push_back(s.start);
    bound.neutral.push_back(s.use == TermParameter::Use::fixed ? s.start : p.neutral);
    bound.places.push_back(s.use == TermParameter::Use::free   ? offset_ + parameters_.size()
                           : s.use == TermParameter::Use::same ? bound.places.at(0)
                                                               : none);
    if (s.use != TermParameter::Use::free) continue;
    candidate.parameters.push_back(offset_ + parameters_.size());
    const std::string& unit = s.as_observed ? table.units[table.observed[0]] : p.unit;
    parameters_.push_back({m.id + "." + p.name, unit, s.start, p.neutral, s.lower, s.upper, s.size, {}, {}});
  }
  bound_.push_back(std::move(bound));
  candidates_.push_back(std::move(candidate));
}

std::vector<double> TermStack::numbers(const Bound& bound, std::span<const double> values) const {
  std::vector<double> result = bound.fixed;
  for (std::size_t k = 0; k < result.size(); ++k)
    if (bound.places[k] != none) result[k] = values[bound.places[k]];
  return result;
}

std::vector<double> TermStack::amounts(std::size_t c, std::span<const double> values) const {
  return numbers(bound_[c], values);
}

bool TermStack::Bound::in_play(std::span<const double> values) const {
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k] != none && values[places[k]] != neutral[k]) return true;
  return false;
}

void TermStack::act(std::span<const double> values, std::size_t first, std::span<double> predictions) const {
  std::vector<double> at;
  for (const Bound& bound : bound_) {
    if (!bound.in_play(values)) continue;
    const std::vector<double> p = numbers(bound, values);
    const auto equation = bound.term->act != nullptr ? bound.term->act : bound.term->mechanism().act;
    at.resize(bound.at.size());
    for (std::size_t i = 0; i < predictions.size(); ++i) {
      const std::size_t row = (first + i) / observed_;
      for (std::size_t k = 0; k < at.size(); ++k) at[k] = bound.at[k][row];
      predictions[i] = equation(predictions[i], at, p);
    }
  }
}

// Central differences of the terms alone, which cost nothing beside a model: relative step 1e-6, error 1e-11.
void TermStack::slopes(std::span<const double> values, std::size_t first, std::span<const double> predictions,
                       std::span<double> slopes) const {
  const auto resting = [&](const Bound& b) { return !b.in_play(values); };
  if (std::all_of(bound_.begin(), bound_.end(), resting)) {
    std::fill(slopes.begin(), slopes.end(), 1.0);
    return;
  }
  std::vector<double> above(predictions.begin(), predictions.end()), below = above, width(above.size());
  for (std::size_t i = 0; i < above.size(); ++i) {
    const double step = 1e-6 * (std::abs(predictions[i]) + 1e-12);
    above[i] += step;
    below[i] -= step;
    width[i] = above[i] - below[i];
  }
  act(values, first, above);
  act(values, first, below);
  for (std::size_t i = 0; i < above.size(); ++i) slopes[i] = width[i] > 0 ? (above[i] - below[i]) / width[i] : 1;
}

void TermStack::derivative(std::span<const double> values, std::size_t first, std::span<const double> predictions,
                           std::size_t column, std::span<double> derivative) const {
  const Parameter& p = parameters_.at(column - offset_);
  std::vector<double> moved(values.begin(), values.end());
  std::vector<double> above(predictions.begin(), predictions.end()), below = above;
  const double centre = values[column], step = 1e-4 * p.size;
  const double upper = std::min(centre + step, std::max(p.upper, centre));
  const double lower = std::max(centre - step, std::min(p.lower, centre));
  moved[column] = upper;
  act(moved, first, above);
  moved[column] = lower;
  act(moved, first, below);
  const double scale = upper > lower ? 1 / (upper - lower) : 0;
  for (std::size_t i = 0; i < derivative.size(); ++i) derivative[i] = (above[i] - below[i]) * scale;
}

}  // namespace gonio::explain::tables
