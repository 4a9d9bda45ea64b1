// See tables_problem.h: mechanisms that the manifest has switched on.
#include <algorithm>

#include "explain/tables/tables_problem.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::explain::tables {

// Which number of a parameter's list is candidate parameter k's: the place of its target among those that the manifest
// names. Candidates with the numbers of several targets hold them target by target.
std::optional<std::size_t> TablesProblem::number_of(const Candidate& candidate, std::size_t k,
                                                    const manifest::MechanismUse& use) const {
  if (!of_single_targets(candidate)) {
    if (candidate.on.size() != 1 || use.on.size() < 2) return 0;
    return static_cast<std::size_t>(std::ranges::find(use.on, candidate.on[0]) - use.on.begin());
  }
  const std::size_t own = k / candidate.mechanism->parameters.size();
  if (use.on.empty()) return own;
  const std::string& target = candidate.on[own];
  const auto found = std::find(use.on.begin(), use.on.end(), target);
  if (found == use.on.end()) return {};
  return static_cast<std::size_t>(found - use.on.begin());
}

bool TablesProblem::of_single_targets(const Candidate& candidate) {
  return candidate.on.size() > 1 &&
         candidate.parameters.size() == candidate.on.size() * candidate.mechanism->parameters.size();
}

namespace {

// Which of the use's numbers a candidate's parameter is; nothing where the manifest does not give it.
const manifest::Parameter* given_for(const manifest::MechanismUse& use, const Parameter& p) {
  const auto given = use.parameters.find(p.name.substr(p.name.find_last_of("./") + 1));
  return given == use.parameters.end() || !given->second.given() ? nullptr : &given->second;
}

}  // namespace

bool TablesProblem::is_switched_on(const Candidate& candidate, const manifest::Document& document) const {
  const auto found = document.mechanisms.find(candidate.id());
  if (found == document.mechanisms.end() || !bound_->is_of_manifest(candidate)) return false;
  const std::vector<std::string>& on = found->second.on;
  return on.empty() || candidate.on.empty() || std::ranges::any_of(candidate.on, [&](const std::string& name) {
           return std::ranges::find(on, name) != on.end();
         });
}

// Has it a place for every number that the manifest gives and that does something, within its range?
bool TablesProblem::holds(const Candidate& candidate, const manifest::MechanismUse& use) const {
  return std::ranges::all_of(candidate.mechanism->parameters, [&](const mechanism::Parameter& declared) {
    const auto given = use.parameters.find(declared.name);
    if (given == use.parameters.end() || !given->second.given()) return true;
    return std::ranges::all_of(given->second.value, [&](double v) {
      return v == declared.neutral || std::ranges::any_of(candidate.parameters, [&](std::size_t place) {
               const Parameter& p = parameters_[place];
               return given_for(use, p) == &given->second && v >= p.lower && v <= p.upper;
             });
    });
  });
}

// What the manifest switches on already holds at its values; parameters that it sets free join the base model. Of
// several forms of one mechanism on the same targets the plainest that has a place for all of its numbers: two of them
// would act twice.
void TablesProblem::switch_on(const manifest::Document& document) {
  std::vector<Candidate> left;
  std::vector<const Candidate*> chosen;
  for (const Candidate& candidate : candidates_) {
    if (!is_switched_on(candidate, document)) {
      left.push_back(candidate);
      continue;
    }
    const manifest::MechanismUse& use = document.mechanisms.at(candidate.id());
    const auto same = std::ranges::find_if(chosen, [&](const Candidate* other) {
      return other->mechanism == candidate.mechanism && other->on == candidate.on;
    });
    if (same == chosen.end()) {
      chosen.push_back(&candidate);
      continue;
    }
    const bool fits = holds(candidate, use), other_fits = holds(**same, use);
    const bool plainer = candidate.parameters.size() < (*same)->parameters.size();
    if ((fits && !other_fits) || (fits && plainer)) *same = &candidate;
  }
  for (const Candidate* candidate : chosen) {
    const manifest::MechanismUse& use = document.mechanisms.at(candidate->id());
    for (std::size_t k = 0; k < candidate->parameters.size(); ++k) {
      const std::size_t place = candidate->parameters[k];
      Parameter& p = parameters_[place];
      const manifest::Parameter* given = given_for(use, p);
      const std::optional<std::size_t> number = number_of(*candidate, k, use);
      if (given == nullptr || !number || *number >= given->value.size()) continue;
      p.start = p.neutral = given->value[*number];
      if (given->sigma) p.prior_sigma = given->sigma;
      if (given->free) base_.push_back(place);
    }
  }
  candidates_ = std::move(left);
}

}  // namespace gonio::explain::tables
