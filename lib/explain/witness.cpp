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
                                     const std::set<std::string>& refused, const manifest::Document& document,
                                     const std::vector<std::size_t>& left_out) {
  // Poses of views that take no part would be no testimony.
  const std::vector<const Domain*> witnesses =
      left_out.empty() ? witnesses_of(domain, document) : std::vector<const Domain*>{};
  std::vector<Explanation::Contradicted> contradicted;
  const auto told = [&](Explanation e) {
    e.contradicted = contradicted;
    if (!contradicted.empty()) inference::write_sentence(problem, e);
    return e;
  };
  const auto id_of = [&](std::size_t candidate) { return problem.candidates()[candidate].id(); };
  const auto note = [&](std::size_t candidate, const Testimony& t) {
    contradicted.push_back({id_of(candidate), t.by, t.quantity, t.unit, t.before, t.after});
  };
  for (Options now = options;;) {
    Explanation e = explain_without(problem, now, refused, left_out);
    const std::optional<Objection> against = objection(domain, witnesses, problem, e, document);
    if (!against) return told(std::move(e));
    std::vector<std::size_t> blamed = e.named;
    if (against->candidate) blamed = {*against->candidate};
    // The last that was added is the likeliest to be the one.
    for (std::size_t k = blamed.size(); k-- > 0 && blamed.size() > 1;) {
      const std::optional<Options> rest = asked_without(problem, now, {id_of(blamed[k])});
      if (!rest) continue;
      Explanation without = explain_without(problem, *rest, refused, left_out);
      if (objection(domain, witnesses, problem, without, document)) continue;
      note(blamed[k], against->testimony);
      return told(std::move(without));
    }
    std::set<std::string> taken_back;
    for (const std::size_t candidate : blamed) {
      note(candidate, against->testimony);
      taken_back.insert(id_of(candidate));
    }
    std::optional<Options> rest = asked_without(problem, now, taken_back);
    if (!rest) return told(std::move(e));
    now = std::move(*rest);
  }
}

}  // namespace gonio::explain
