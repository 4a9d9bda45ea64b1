// See domains.h.
#include "explain/domains.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

std::vector<const Domain*> that_apply(const manifest::Document& document) {
  std::vector<const Domain*> domains;
  for (const Domain* domain : all_domains())
    if (domain->applies(document)) domains.push_back(domain);
  std::stable_sort(domains.begin(), domains.end(),
                   [](const Domain* a, const Domain* b) { return a->order < b->order; });
  return domains;
}

}  // namespace

std::vector<std::unique_ptr<Problem>> problems_of(const manifest::Document& document, const ProblemOptions& options) {
  std::vector<std::unique_ptr<Problem>> problems;
  for (AskedDomain& asked : domains_of(document, options)) {
    if (asked.waits) asked.problems = asked.domain->problems(document, options);
    for (std::unique_ptr<Problem>& problem : asked.problems) problems.push_back(std::move(problem));
  }
  return problems;
}

std::vector<AskedDomain> domains_of(const manifest::Document& document, const ProblemOptions& options) {
  std::vector<AskedDomain> all;
  const std::vector<const Domain*> domains = that_apply(document);
  bool any = false;
  for (const Domain* domain : domains) {
    AskedDomain asked{domain, std::ranges::find(domains, domain->after, &Domain::name) != domains.end(), {}};
    if (!asked.waits) asked.problems = domain->problems(document, options);
    any = any || !asked.problems.empty();
    all.push_back(std::move(asked));
  }
  if (any) return all;
  std::string known;
  for (const Domain* domain : all_domains()) known += (known.empty() ? "" : "; ") + domain->sentence;
  throw Error(Exit::data, manifest::place(document, ""), "has nothing to explain", "give one of: " + known);
}

std::vector<std::string> hypotheses_of(const Domain& domain, const Problem& problem, std::span<const Answered> before,
                                       const std::vector<std::string>& wanted) {
  std::set<std::string> looked_at, named;
  for (const Answered& answer : before) {
    if (domain.leaves.empty() || answer.problem->domain() != domain.leaves_to) continue;
    const auto& candidates = answer.problem->candidates();
    const Explanation& e = *answer.explanation;
    for (const auto& c : candidates)
      if (c.id().starts_with(domain.leaves)) looked_at.insert(c.id());
    for (const std::size_t c : e.named) named.insert(candidates[c].id());
    for (const auto* sets : {&e.not_told_apart, &e.instead})
      for (const auto& set : *sets)
        for (const std::size_t c : set) named.insert(candidates[c].id());
  }
  std::vector<std::string> asked;
  for (const auto& c : problem.candidates()) {
    const bool is_wanted = wanted.empty() || std::ranges::find(wanted, c.id()) != wanted.end();
    if (is_wanted && (named.contains(c.id()) || !looked_at.contains(c.id()))) asked.push_back(c.id());
  }
  const bool all = asked.size() == problem.candidates().size();
  return all || asked.empty() ? wanted : asked;
}

std::vector<std::filesystem::path> files_of(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (const Domain* domain : that_apply(document))
    for (std::filesystem::path& file : domain->files(document)) files.push_back(std::move(file));
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

}  // namespace gonio::explain
