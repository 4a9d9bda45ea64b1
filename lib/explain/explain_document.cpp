// See explain_document.h.
#include "explain/explain_document.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <deque>

#include "base/atomic_file.h"
#include "base/progress.h"
#include "explain/domains.h"
#include "explain/witness.h"
#include "inference/entry.h"
#include "inference/evidence.h"
#include "inference/report.h"
#include "inference/sentence.h"
#include "inference/stability.h"
#include "manifest/document.h"
#include "mechanism/listing.h"

namespace gonio::explain {
namespace {

bool doubtful(const Problem& problem, const Explanation& e) {
  std::size_t blocks = 0;
  for (const std::uint32_t b : problem.observations().block) blocks = std::max<std::size_t>(blocks, b + 1);
  return !e.converged || 10 * e.outlier_blocks > blocks;
}

// The worse of two answers: a gate that failed outweighs a negative answer.
Exit worse(Exit a, Exit b) {
  return static_cast<int>(a) > static_cast<int>(b) ? a : b;
}

struct Told {
  std::unique_ptr<Problem> problem;
  Explanation explanation{};
  Illustration illustration{};
};

// "boards"; the second problem of a domain is "tables-2". The last of `told` is the one that is named.
std::string evidence_name(const std::deque<Told>& told) {
  const std::string domain = told.back().problem->domain();
  const auto same = std::ranges::count_if(told, [&](const Told& t) { return t.problem->domain() == domain; });
  return same == 1 ? domain : domain + "-" + std::to_string(same);
}

// Did the domain that another waits for leave something that nothing repairs?
bool is_unmended(const std::deque<Told>& told, const std::string& domain) {
  return std::ranges::any_of(
      told, [&](const Told& t) { return t.problem->domain() == domain && t.explanation.verdict == Verdict::unknown; });
}

// The same question of parts of the recordings: how often does the answer come out?
void ask_parts(const Domain& domain, const Problem& problem, const ExplainRequest& request,
               std::set<std::string> refused, const manifest::Document& document, Explanation& e) {
  for (const Explanation::Contradicted& c : e.contradicted)
    if (std::ranges::none_of(e.named, [&](std::size_t n) { return problem.candidates()[n].id() == c.mechanism; }))
      refused.insert(c.mechanism);
  e.stability = inference::stability(problem, request.resample, request.options.seed, [&](const auto& left_out) {
    return explain_before_witnesses(domain, problem, request.options, refused, document, left_out);
  });
  inference::write_sentence(problem, e);
}

// Matrices of some megabytes come and go by the thousand. Handed back to the system at once, a third of the time goes
// into fetching their pages again.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int megabyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * megabyte);
  mallopt(M_TRIM_THRESHOLD, 512 * megabyte);
#endif
}

}  // namespace

Exit explain_document(manifest::Document& document, const ExplainRequest& request) {
  keep_freed_memory();
  std::vector<AskedDomain> domains = domains_of(document, request.recordings);
  std::deque<Told> told;
  std::vector<ReportPart> parts;
  Exit exit = Exit::done;
  document.explanations.clear();
  const auto tell = [&](const Domain& domain, std::unique_ptr<Problem> asked) {
    std::vector<Answered> before;
    for (const Told& t : told) before.push_back({t.problem.get(), &t.explanation});
    Told& t = told.emplace_back(std::move(asked));
    const Problem& problem = *t.problem;
    const std::set<std::string> refused = refused_before(domain, before);
    Explanation& e = t.explanation = explain_before_witnesses(domain, problem, request.options, refused, document);
    if (request.resample > 0) ask_parts(domain, problem, request, refused, document, e);
    t.illustration = problem.illustrate(e, request.out, document);
    if (e.significant && !request.out.empty())
      t.illustration.observations = write_evidence(problem, e, evidence_name(told), request.out, document);
    problem.apply(e, document);
    document.explanations.push_back(entry_of(problem, e, t.illustration));
    parts.push_back({&problem, &e, &t.illustration});
    log(LogLevel::info, problem.domain() + ": " + e.sentence);
    if (e.verdict == Verdict::unknown) exit = worse(exit, Exit::negative);
    if (doubtful(problem, e)) exit = worse(exit, Exit::quality);
  };
  for (AskedDomain& asked : domains) {
    if (asked.waits && asked.domain->needs_it && is_unmended(told, asked.domain->after)) {
      log(LogLevel::info, asked.domain->name + ": not asked: its recordings are held against what " +
                              asked.domain->after + " has just refuted, and nothing mends that");
      continue;
    }
    if (asked.waits) asked.problems = asked.domain->problems(document, request.recordings);
    for (std::unique_ptr<Problem>& problem : asked.problems) tell(*asked.domain, std::move(problem));
  }
  if (!request.page.empty()) write_file(request.page, report_page(document.name, parts));
  return exit;
}

std::string list_of_mechanisms() {
  return mechanism::text();
}

void check_hypotheses(const std::vector<std::string>& ids) {
  for (const std::string& id : ids)
    if (mechanism::find_mechanism(id) == nullptr)
      throw Error(Exit::usage, "--hypotheses", "\"" + id + "\" is no mechanism", "explain --list shows them all");
}

}  // namespace gonio::explain
