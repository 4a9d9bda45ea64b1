// See domains.h.
#include "explain/domains.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/progress.h"
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
  std::vector<std::pair<std::string, Error>> beyond;
  for (const Domain* domain : domains) {
    try {
      if (domain->within_reach != nullptr) domain->within_reach(document);
    } catch (const Error& error) {
      beyond.emplace_back(domain->name, error);
      continue;
    }
    AskedDomain asked{domain, std::ranges::find(domains, domain->after, &Domain::name) != domains.end(), {}};
    if (!asked.waits) asked.problems = domain->problems(document, options);
    any = any || !asked.problems.empty();
    all.push_back(std::move(asked));
  }
  for (const auto& [name, error] : beyond) {
    if (!any) throw error;
    log(LogLevel::warning, name + ": not asked: " + error.what());
  }
  if (any) return all;
  std::string known;
  for (const Domain* domain : all_domains()) known += (known.empty() ? "" : "; ") + domain->sentence;
  throw Error(Exit::data, manifest::place(document, ""), "has nothing to explain", "give one of: " + known);
}

std::set<std::string> refused_before(const Domain& domain, std::span<const Answered> before) {
  std::set<std::string> refused, named;
  for (const Answered& answer : before) {
    if (domain.leaves.empty() || answer.problem->domain() != domain.leaves_to) continue;
    const auto& candidates = answer.problem->candidates();
    for (const auto& c : candidates)
      if (c.id().starts_with(domain.leaves)) refused.insert(c.id());
    for (const std::size_t c : answer.explanation->named) named.insert(candidates[c].id());
  }
  for (const std::string& id : named) refused.erase(id);
  return refused;
}

Explanation explain_without(const Problem& problem, const Options& options, const std::set<std::string>& refused,
                            const std::vector<std::size_t>& left_out) {
  Options now = options;
  for (;;) {
    Explanation e = explain(problem, now, left_out);
    std::set<std::string> wrong;
    for (const std::size_t c : e.named)
      if (const std::string& id = problem.candidates()[c].id(); refused.contains(id)) wrong.insert(id);
    if (wrong.empty()) return e;
    std::optional<Options> rest = asked_without(problem, now, wrong);
    if (!rest) return e;  // the user asked for nothing else
    now = std::move(*rest);
  }
}

std::optional<Options> asked_without(const Problem& problem, Options options, const std::set<std::string>& refused) {
  if (options.hypotheses.empty())
    for (const auto& c : problem.candidates()) options.hypotheses.push_back(c.id());
  std::erase_if(options.hypotheses, [&refused](const std::string& id) { return refused.contains(id); });
  return options.hypotheses.empty() ? std::nullopt : std::optional(std::move(options));
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
