// See tables_problem.h: what goes back into the manifest, and what a person looks at.
#include <algorithm>

#include "base/text.h"
#include "explain/explanation.h"
#include "explain/tables/tables_problem.h"

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

std::string TablesProblem::remarks(const Explanation&) const {
  return "Noise " + noise_ + "." + (grouped_.empty() ? "" : " " + grouped_);
}

void TablesProblem::apply(const Explanation& e, manifest::Document& document) const {
  const std::size_t own = bound_->parameters().size();
  bound_->apply(std::span(e.values).first(own), std::span(e.sigma).first(own), document);
  const std::vector<Candidate>& of_terms = terms_->candidates();
  for (const std::size_t c : e.named) {
    const mechanism::Mechanism& m = *candidates_[c].mechanism;
    manifest::MechanismUse use;
    use.on = candidates_[c].on;
    const auto term =
        std::find_if(of_terms.begin(), of_terms.end(), [&](const Candidate& t) { return t.mechanism == &m; });
    if (term != of_terms.end()) {
      const std::vector<double> amounts = terms_->amounts(static_cast<std::size_t>(term - of_terms.begin()), e.values);
      for (std::size_t k = 0; k < amounts.size(); ++k) use.parameters[m.parameters[k].name] = amounts[k];
    }
    for (const std::size_t p : candidates_[c].parameters) {
      const std::string& full = parameters_[p].name;
      const std::string name = full.substr(full.find_last_of("./") + 1);
      use.parameters[name] = e.values[p];
      use.sigma[name] = std::vector<double>{e.sigma[p]};
    }
    document.mechanisms[m.id] = std::move(use);
  }
}

Illustration TablesProblem::illustrate(const Explanation&, const std::filesystem::path&, manifest::Document&) const {
  return {};
}

}  // namespace gonio::explain::tables
