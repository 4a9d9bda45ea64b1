// From a table of results to designs, models, tests, means and ranks. See analysis.h.
#include "nrsfm/evaluate/analysis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/text.h"

namespace gonio::nrsfm {
namespace {

using stats::Design;
using stats::Term;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

int find_factor(const Design& design, const std::string& name) {
  for (std::size_t f = 0; f < design.factors.size(); ++f)
    if (design.factors[f].name == name) return static_cast<int>(f);
  return -1;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

struct Piece {
  std::string name;
  bool minus = false;
};
// At "+" and at "-" between blanks: names may have hyphens.
std::vector<Piece> pieces_of(const std::string& model) {
  std::vector<Piece> pieces(1);
  for (std::size_t i = 0; i < model.size(); ++i) {
    const bool minus = model.compare(i, 3, " - ") == 0;
    if (minus || model[i] == '+') {
      pieces.push_back({{}, minus});
      i += minus ? 2 : 0;
    } else {
      pieces.back().name += model[i];
    }
  }
  for (Piece& p : pieces) {
    p.name = trimmed(p.name);
    if (p.name.empty())
      throw Error(Exit::usage, "--model", "\"" + model + "\" has an empty term",
                  "write \"algorithm + path + algorithm:path\"");
  }
  return pieces;
}

std::size_t empty_pairs(const Design& design, int a, int b) {
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < design.y.size(); ++i) seen.insert({design.level[at(a)][i], design.level[at(b)][i]});
  return design.factors[at(a)].levels.size() * design.factors[at(b)].levels.size() - seen.size();
}

std::vector<Term> full_pairs(const Design& design, std::vector<std::string>& notes) {
  std::vector<Term> terms;
  for (const Term& t : stats::main_effects_and_pairs(design)) {
    const std::size_t empty = t.size() == 2 ? empty_pairs(design, t[0], t[1]) : 0;
    if (empty == 0) {
      terms.push_back(t);
    } else {
      notes.push_back(format("%s is left out of the model: %zu of its combinations have no result",
                             stats::term_name(design, t).c_str(), empty));
    }
  }
  return terms;
}

// "a", "a:b", "a*b" (which is a + b + a:b). Nothing where a factor is absent from this part.
std::vector<Term> named_terms(const Design& design, const std::string& text, const std::vector<std::string>& absent) {
  Term term;
  bool missing = false;
  const bool star = text.find('*') != std::string::npos;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(":*", from), text.size());
    const std::string name = trimmed(text.substr(from, end - from));
    const int f = find_factor(design, name);
    from = end + 1;
    if (f < 0 && std::find(absent.begin(), absent.end(), name) != absent.end()) {
      missing = true;
    } else if (f < 0) {
      std::string known;
      for (const stats::Factor& factor : design.factors) known += (known.empty() ? "" : ", ") + factor.name;
      throw Error(Exit::usage, "--model", "there is no factor \"" + name + "\"", "factors are " + known);
    } else if (std::find(term.begin(), term.end(), f) == term.end()) {
      term.push_back(f);
    }
  }
  std::sort(term.begin(), term.end());
  if (!star) return missing ? std::vector<Term>{} : std::vector<Term>{term};
  std::vector<Term> all;
  for (unsigned subset = 1; subset < 1u << term.size(); ++subset) {
    Term part;
    for (std::size_t i = 0; i < term.size(); ++i)
      if (subset >> i & 1u) part.push_back(term[i]);
    all.push_back(part);
  }
  return all;
}

// Rows of a part as a design: levels sorted by name; factors that do not vary are left out.
Design design_of(const Results& results, const std::vector<const Result*>& rows, std::vector<std::string>& absent,
                 std::vector<std::string>& notes) {
  Design design;
  for (const std::string& name : results.factors) {
    std::set<std::string> levels;
    for (const Result* r : rows) levels.insert(r->factors.at(name));
    if (levels.size() < 2) {
      absent.push_back(name);
      if (!levels.empty()) notes.push_back(name + " is \"" + *levels.begin() + "\" everywhere: not a factor here");
      continue;
    }
    stats::Factor factor{name, {levels.begin(), levels.end()}};
    std::vector<int> index;
    for (const Result* r : rows)
      index.push_back(static_cast<int>(
          std::lower_bound(factor.levels.begin(), factor.levels.end(), r->factors.at(name)) - factor.levels.begin()));
    design.factors.push_back(std::move(factor));
    design.level.push_back(std::move(index));
  }
  for (const Result* r : rows) design.y.push_back(r->error);
  return design;
}

std::vector<int> blocks_of(const Design& design, const std::vector<const Result*>& rows, int ranked) {
  std::map<std::string, int> numbers;
  std::vector<int> blocks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::string name = rows[i]->block;
    if (name.empty())
      for (std::size_t f = 0; f < design.factors.size(); ++f)
        if (static_cast<int>(f) != ranked) name += "\n" + design.factors[f].levels[at(design.level[f][i])];
    blocks.push_back(numbers.try_emplace(name, static_cast<int>(numbers.size())).first->second);
  }
  return blocks;
}

std::vector<Factors> empty_cells(const Design& design, std::vector<std::string>& notes) {
  constexpr std::size_t most = 200000;
  std::size_t all = 1;
  for (const stats::Factor& f : design.factors) all = std::min(most + 1, all * f.levels.size());
  if (all > most) {
    notes.push_back("the full crossing of all factors has too many cells to list those without results");
    return {};
  }
  std::vector<char> seen(all, 0);
  for (std::size_t i = 0; i < design.y.size(); ++i) {
    std::size_t cell = 0;
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      cell = cell * design.factors[f].levels.size() + at(design.level[f][i]);
    seen[cell] = 1;
  }
  std::vector<Factors> empty;
  for (std::size_t cell = 0; cell < all; ++cell) {
    if (seen[cell]) continue;
    Factors factors;
    std::size_t rest = cell;
    for (std::size_t f = design.factors.size(); f-- > 0; rest /= design.factors[f].levels.size())
      factors[design.factors[f].name] = design.factors[f].levels[rest % design.factors[f].levels.size()];
    empty.push_back(std::move(factors));
  }
  return empty;
}

// Levels of a factor, those with the least mean first; what cannot be estimated comes last.
std::vector<int> order_by_mean(const stats::Anova& fit, const Design& design, int factor) {
  std::vector<stats::MarginalMean> means = stats::marginal_means(fit, design, {factor});
  std::stable_sort(means.begin(), means.end(), [](const auto& a, const auto& b) {
    return a.estimable != b.estimable ? a.estimable : a.estimable && a.value < b.value;
  });
  std::vector<int> place(means.size());
  for (std::size_t i = 0; i < means.size(); ++i) place[at(means[i].levels[0])] = static_cast<int>(i);
  return place;
}

MeansTable means_table(const stats::Anova& fit, const Design& design, const Term& term,
                       const std::vector<Term>& terms) {
  MeansTable table{term, "mu", stats::marginal_means(fit, design, term)};
  for (const Term& t : terms)
    if (std::all_of(t.begin(), t.end(), [&](int f) { return std::find(term.begin(), term.end(), f) != term.end(); }))
      table.formula += " + " + stats::term_name(design, t);
  std::vector<std::vector<int>> place;
  for (const int f : term) place.push_back(order_by_mean(fit, design, f));
  const auto key = [&](const stats::MarginalMean& m) {
    std::vector<int> k;
    for (std::size_t i = 0; i < term.size(); ++i) k.push_back(place[i][at(m.levels[i])]);
    return k;
  };
  std::stable_sort(table.means.begin(), table.means.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return table;
}

void add_ranks(Part& part, const std::vector<const Result*>& rows, const AnalysisOptions& options) {
  const int factor = find_factor(part.design, options.algorithm);
  if (factor < 0 || std::find(part.terms.begin(), part.terms.end(), Term{factor}) == part.terms.end()) return;
  try {
    part.ranks = stats::bootstrap_ranks(part.design, part.terms, factor, blocks_of(part.design, rows, factor),
                                        options.draws, options.confidence, options.seed);
    part.ranked = factor;
  } catch (const Error& e) {
    if (e.code() != Exit::data) throw;
    part.notes.push_back(std::string("no ranks: ") + e.what());
  }
}

Part part_of(const Results& results, const std::string& id, const std::string& title,
             const std::vector<const Result*>& chosen, const AnalysisOptions& options) {
  Part part;
  part.id = id;
  part.title = title;
  std::vector<const Result*> rows;
  for (const Result* r : chosen)
    if (std::isfinite(r->error)) rows.push_back(r);
  part.failed = chosen.size() - rows.size();
  if (part.failed > 0) part.notes.push_back(format("%zu of %zu results are failures", part.failed, chosen.size()));
  std::vector<std::string> absent;
  part.design = design_of(results, rows, absent, part.notes);
  part.terms = model_terms(part.design, options.model, part.notes, absent);
  if (part.terms.empty())
    throw Error(Exit::data, results.name, title + ": no factor has two levels",
                "add results of other algorithms or sequences");
  try {
    part.anova = stats::anova(part.design, part.terms, options.type, options.covariance);
  } catch (const Error& e) {
    throw Error(e.code(), results.name, title + ": " + (e.place() == "results" ? "" : e.place() + ": ") + e.problem(),
                e.remedy());
  }
  part.notes.insert(part.notes.end(), part.anova.notes.begin(), part.anova.notes.end());
  for (const Term& t : part.terms) part.tables.push_back(means_table(part.anova, part.design, t, part.terms));
  part.empty_cells = empty_cells(part.design, part.notes);
  add_ranks(part, rows, options);
  return part;
}

}  // namespace

std::vector<Term> model_terms(const Design& design, const std::string& model, std::vector<std::string>& notes,
                              const std::vector<std::string>& absent) {
  std::vector<Term> terms;
  for (const Piece& piece : pieces_of(model)) {
    std::vector<Term> named;
    if (piece.name == "pairs") {
      named = full_pairs(design, notes);
    } else if (piece.name == "main") {
      for (int f = 0; f < static_cast<int>(design.factors.size()); ++f) named.push_back({f});
    } else {
      named = named_terms(design, piece.name, absent);
    }
    for (const Term& t : named) {
      std::erase(terms, t);
      if (!piece.minus) terms.push_back(t);
    }
  }
  std::erase(terms, Term{});
  std::stable_sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.size() < b.size(); });
  return terms;
}

Analysis analyse(const Results& results, const AnalysisOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1))
    throw Error(Exit::usage, "--confidence", format("%g is not between 0 and 1", options.confidence));
  Analysis analysis{results.measure, results.unit, options, {}};
  const auto has = [&](const std::string& f) {
    return std::find(results.factors.begin(), results.factors.end(), f) != results.factors.end();
  };
  std::vector<const Result*> all, complete, both;
  std::set<std::string> levels, able;  // of the factor "missing"; algorithms with results where tracks are missing
  for (const Result& r : results.rows) {
    all.push_back(&r);
    if (!has(options.missing)) continue;
    const std::string& level = r.factors.at(options.missing);
    levels.insert(level);
    if (level == options.without) complete.push_back(&r);
    if (level != options.without && std::isfinite(r.error) && has(options.algorithm))
      able.insert(r.factors.at(options.algorithm));
  }
  if (levels.size() < 2) {
    analysis.parts.push_back(part_of(results, "all", "all results", all, options));
    return analysis;
  }
  if (!levels.contains(options.without))
    throw Error(Exit::usage, "--without", "factor \"" + options.missing + "\" has no level \"" + options.without + "\"",
                "its levels are \"" + *levels.begin() + "\" and \"" + *levels.rbegin() + "\"");
  for (const Result* r : all)
    if (!has(options.algorithm) || able.contains(r->factors.at(options.algorithm))) both.push_back(r);
  analysis.parts.push_back(part_of(results, "complete", "results without missing tracks", complete, options));
  if (able.size() > 1 || !has(options.algorithm))
    analysis.parts.push_back(part_of(results, "missing", "with and without missing tracks", both, options));
  return analysis;
}

}  // namespace gonio::nrsfm
