// See witness.h.
#include "explain/witness.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "explain/domains.h"
#include "inference/sentence.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

std::vector<const Domain*> witnesses_of(const Domain& domain, const manifest::Document& document) {
  std::vector<const Domain*> witnesses;
  for (const Domain* other : all_domains())
    if (other->witness_of == domain.name && other->applies(document)) witnesses.push_back(other);
  return witnesses;
}

// The document as it would be written where nothing is named, and as it is written.
manifest::Document stated(const Problem& problem, Explanation e, manifest::Document document) {
  e.verdict = Verdict::null;
  e.named.clear(), e.estimates.clear();
  e.values = e.base_values;
  e.residual_after = e.residual_before;
  problem.apply(e, document);
  return document;
}
manifest::Document mended(const Problem& problem, const Explanation& e, manifest::Document document) {
  problem.apply(e, document);
  return document;
}

struct Objection {
  Testimony testimony;
  std::optional<std::size_t> candidate{};  // where it is known which one it speaks against
};
// The domain's own, or the strongest of the witnesses.
std::optional<Objection> objection(const Domain& domain, const std::vector<const Domain*>& witnesses,
                                   const Problem& problem, const Explanation& e, const manifest::Document& document) {
  if (domain.objects != nullptr)
    for (const std::size_t candidate : e.named)
      if (const auto own = domain.objects(problem, e, candidate); own && own->contradicts())
        return Objection{*own, candidate};
  std::optional<Objection> strongest;
  if (e.named.empty() || witnesses.empty()) return strongest;
  const manifest::Document before = stated(problem, e, document), after = mended(problem, e, document);
  for (const Domain* witness : witnesses)
    for (const Testimony& t : witness->testify(before, after)) {
      log(LogLevel::debug, t.by + ": " + t.quantity + " " + inference::score_in_words(t.before, t.unit) + " without, " +
                               inference::score_in_words(t.after, t.unit) + " with what is named");
      if (t.contradicts() && (!strongest || t.errors > strongest->testimony.errors)) strongest = Objection{t};
    }
  return strongest;
}

}  // namespace

Explanation explain_before_witnesses(const Domain& domain, const Problem& problem, const Options& options,
                                     std::set<std::string> refused, const manifest::Document& document) {
  const std::vector<const Domain*> witnesses = witnesses_of(domain, document);
  std::vector<Explanation::Contradicted> contradicted;
  const auto told = [&](Explanation e) {
    e.contradicted = contradicted;
    if (!contradicted.empty()) inference::write_sentence(problem, e);
    return e;
  };
  for (;;) {
    Explanation e = explain_without(problem, options, refused);
    const std::optional<Objection> against = objection(domain, witnesses, problem, e, document);
    if (!against) return told(std::move(e));
    const auto take_back = [&](std::size_t candidate) {
      const std::string& id = problem.candidates()[candidate].id();
      refused.insert(id);
      const Testimony& t = against->testimony;
      contradicted.push_back({id, t.by, t.quantity, t.unit, t.before, t.after});
    };
    if (against->candidate) {
      take_back(*against->candidate);
      continue;
    }
    // The last that was added is the likeliest to be the one.
    const std::vector<std::size_t> named = e.named;
    const std::set<std::string> before = refused;
    const std::vector<Explanation::Contradicted> known = contradicted;
    for (std::size_t k = named.size(); k-- > 0 && named.size() > 1;) {
      take_back(named[k]);
      Explanation without = explain_without(problem, options, refused);
      if (!objection(domain, witnesses, problem, without, document)) return told(std::move(without));
      refused = before, contradicted = known;
    }
    for (const std::size_t candidate : named) take_back(candidate);
  }
}

}  // namespace gonio::explain
