// See tables_problem.h: what goes back into the manifest, and what a person looks at.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "explain/tables/tables_problem.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/table.h"
#include "report/plot.h"

namespace gonio::explain::tables {

bool has_tables(const manifest::Document& document) {
  return std::any_of(document.tables.begin(), document.tables.end(),
                     [](const auto& t) { return find_model(t.second.model) != nullptr; });
}

std::vector<std::unique_ptr<Problem>> table_problems(const manifest::Document& document,
                                                     const ProblemOptions& options) {
  std::vector<std::string> names;
  for (const auto& [name, table] : document.tables)
    if (find_model(table.model) != nullptr) names.push_back(name);
  std::vector<std::unique_ptr<Problem>> problems;
  for (const std::string& name : names)
    problems.push_back(std::make_unique<TablesProblem>(document, name, options, names.size() > 1));
  return problems;
}

std::string TablesProblem::remarks(const Explanation& e) const {
  std::vector<std::string> named;
  for (const std::size_t c : e.named) named.push_back(candidates_[c].id());
  const std::size_t count = bound_->parameters().size();
  const std::string own = bound_->remarks(named, std::span(e.values).first(count), std::span(e.sigma).first(count));
  return (own.empty() ? "" : own + " ") + "Noise " + noise_ + "." + (grouped_.empty() ? "" : " " + grouped_);
}

namespace {

// One mechanism on two targets, each of which was a candidate of its own.
void join(manifest::MechanismUse& use, const manifest::MechanismUse& other, const mechanism::Mechanism& m) {
  for (const mechanism::Parameter& p : m.parameters) {
    if (!use.parameters.contains(p.name) && !other.parameters.contains(p.name)) continue;
    std::vector<double>& value = use.parameters[p.name].value;
    std::vector<double>& sigma = use.sigma[p.name];
    value.resize(use.on.size(), p.neutral), sigma.resize(use.on.size(), 0);
    const auto more = other.parameters.find(p.name);
    value.push_back(more == other.parameters.end() ? p.neutral : more->second.scalar());
    sigma.push_back(more == other.parameters.end() ? 0 : other.sigma.at(p.name).front());
  }
  use.on.insert(use.on.end(), other.on.begin(), other.on.end());
}

}  // namespace

void TablesProblem::apply(const Explanation& e, manifest::Document& document) const {
  const std::size_t own = bound_->parameters().size();
  bound_->apply(std::span(e.values).first(own), std::span(e.sigma).first(own), document);
  const std::vector<Candidate>& of_terms = terms_->candidates();
  std::set<std::string> entered;
  for (const std::size_t c : e.named) {
    const mechanism::Mechanism& m = *candidates_[c].mechanism;
    if (!bound_->is_of_manifest(candidates_[c])) continue;
    manifest::MechanismUse use;
    use.on = candidates_[c].on;
    // What stands fixed beside the fitted numbers, a reference among them, unless it is neutral.
    const auto term = std::find_if(of_terms.begin(), of_terms.end(), [&](const Candidate& t) {
      return t.mechanism == &m && t.parameters == candidates_[c].parameters;
    });
    if (term != of_terms.end()) {
      const std::vector<double> amounts = terms_->amounts(static_cast<std::size_t>(term - of_terms.begin()), e.values);
      for (std::size_t k = 0; k < amounts.size(); ++k)
        if (amounts[k] != m.parameters[k].neutral) use.parameters[m.parameters[k].name] = amounts[k];
    }
    for (const std::size_t p : candidates_[c].parameters) {
      const std::string& full = parameters_[p].name;
      const std::string name = full.substr(full.find_last_of("./") + 1);
      if (!of_single_targets(candidates_[c])) use.parameters[name].value.clear(), use.sigma[name].clear();
      use.parameters[name].value.push_back(e.values[p]);
      use.sigma[name].push_back(e.sigma[p]);
    }
    if (!entered.insert(m.id).second && use.on.size() == 1)
      join(document.mechanisms[m.id], use, m);
    else
      document.mechanisms[m.id] = std::move(use);
  }
}

namespace {

constexpr std::size_t most_dots = 1200;
constexpr double hardly = 0.25;  // of the largest direction of a row

// At most `most_dots` rows, evenly taken. Rows that the condition hardly moves say nothing of it, and are left out.
report::Series dots(const Condition& condition, const std::vector<double>& residual, const std::string& name) {
  report::Series series;
  series.name = name;
  series.kind = report::Series::Kind::points;
  const std::size_t step = 1 + residual.size() / most_dots;
  double largest = 0;
  for (const double d : condition.direction) largest = std::max(largest, std::abs(d));
  for (std::size_t i = 0; i < residual.size(); i += step) {
    const double direction = condition.direction.empty() ? 1 : condition.direction[i];
    if (!std::isfinite(condition.values[i]) || std::abs(direction) < hardly * largest || direction == 0) continue;
    series.x.push_back(condition.values[i]);
    series.y.push_back(residual[i] / direction);
  }
  return series;
}

}  // namespace

// Every row's residual over the most telling condition: what lies beneath the page's curve.
Illustration TablesProblem::illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const {
  Illustration result;
  if (e.conditions.empty() || !e.significant) return result;
  const auto& conditions = observations_.conditions;
  const auto found = std::find_if(conditions.begin(), conditions.end(),
                                  [&](const Condition& c) { return c.name == e.conditions[0].name; });
  if (found == conditions.end()) return result;
  report::Plot plot;
  plot.x_label = found->name + (found->unit == "1" || found->unit.empty() ? "" : " [" + found->unit + "]");
  plot.y_label = found->curve_unit == "1" ? "relative residual" : "residual [" + found->curve_unit + "]";
  plot.series.push_back(dots(*found, e.residual_before, "base model"));
  if (!e.named.empty()) plot.series.push_back(dots(*found, e.residual_after, "with the named physics"));
  result.pictures.push_back({"Residuals of single rows over " + found->name, "", report::svg(plot)});
  return result;
}

}  // namespace gonio::explain::tables
