// See explain_document.h.
#include "explain/explain_document.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>

#include "base/atomic_file.h"
#include "base/progress.h"
#include "explain/domains.h"
#include "inference/entry.h"
#include "inference/evidence.h"
#include "inference/report.h"
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

// "boards"; the second problem of a domain is "tables-2".
std::string evidence_name(const std::vector<std::unique_ptr<Problem>>& problems, std::size_t k) {
  const std::string domain = problems[k]->domain();
  const auto earlier = std::count_if(problems.begin(), problems.begin() + static_cast<std::ptrdiff_t>(k),
                                     [&](const std::unique_ptr<Problem>& p) { return p->domain() == domain; });
  return earlier == 0 ? domain : domain + "-" + std::to_string(earlier + 1);
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
  const std::vector<std::unique_ptr<Problem>> problems = problems_of(document, request.recordings);
  std::vector<Explanation> explanations(problems.size());
  std::vector<Illustration> illustrations(problems.size());
  std::vector<ReportPart> parts;
  Exit exit = Exit::done;
  document.explanations.clear();
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const Problem& problem = *problems[k];
    Explanation& e = explanations[k] = explain(problem, request.options);
    illustrations[k] = problem.illustrate(e, request.out, document);
    if (e.significant && !request.out.empty())
      illustrations[k].observations = write_evidence(problem, e, evidence_name(problems, k), request.out, document);
    problem.apply(e, document);
    document.explanations.push_back(entry_of(problem, e, illustrations[k]));
    parts.push_back({&problem, &e, &illustrations[k]});
    log(LogLevel::info, problem.domain() + ": " + e.sentence);
    if (e.verdict == Verdict::unknown) exit = worse(exit, Exit::negative);
    if (doubtful(problem, e)) exit = worse(exit, Exit::quality);
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
