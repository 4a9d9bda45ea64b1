// Tables of results for an analysis of variance: from CSV, from the evaluations of a manifest. See analysis.h.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "io/csv.h"
#include "manifest/document.h"
#include "manifest/sections/evaluation.h"
#include "nrsfm/evaluate/analysis.h"

namespace gonio::nrsfm {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string quoted_list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += (text.empty() ? "\"" : ", \"") + n + "\"";
  return text;
}

std::size_t column(const io::Csv& csv, const std::string& name, const char* option) {
  const auto it = std::find(csv.header.begin(), csv.header.end(), name);
  if (it == csv.header.end())
    throw Error(Exit::usage, option, csv.name + " has no column \"" + name + "\"", "it has " + quoted_list(csv.header));
  return static_cast<std::size_t>(it - csv.header.begin());
}

double error_number(const std::string& text, const std::string& place) {
  std::string lower;
  for (const char c : text) lower += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return lower.empty() || lower == "nan" || lower == "na" ? nan : io::csv_number(text, place);
}

// The tables that nrsfm-eval --csv writes have a row for each measure of a reconstruction.
bool has_measures(const io::Csv& csv) {
  const auto& h = csv.header;
  const auto has = [&](const char* name) { return std::find(h.begin(), h.end(), name) != h.end(); };
  return h.size() > 5 && h[0] == "id" && h[1] == "sequence" && h[2] == "algorithm" && has("measure") &&
         has("alignment") && has("value");
}

// Only rows of one measure under one alignment, "e3d" or "e3d/frame-rotation" (empty: of the first row), in columns of
// factors, "block" and the measure.
io::Csv of_one_measure(const io::Csv& csv, const std::string& wanted, std::string& unit) {
  const std::size_t measure = column(csv, "measure", ""), alignment = column(csv, "alignment", ""),
                    value = column(csv, "value", ""), sequence = column(csv, "sequence", "");
  const auto unit_column = std::find(csv.header.begin(), csv.header.end(), "unit") - csv.header.begin();
  std::string name = wanted.substr(0, wanted.find('/'));
  std::string aligned = wanted.find('/') == std::string::npos ? "" : wanted.substr(wanted.find('/') + 1);
  if (wanted.empty()) name = csv.rows.front()[measure];
  io::Csv result{csv.name, {}, {}, {}};
  for (std::size_t r = 0; r < csv.rows.size(); ++r) {
    const std::vector<std::string>& row = csv.rows[r];
    if (row[measure] != name || (!aligned.empty() && row[alignment] != aligned)) continue;
    aligned = row[alignment];
    if (static_cast<std::size_t>(unit_column) < row.size()) {
      const std::string& here = row[static_cast<std::size_t>(unit_column)];
      if (!result.rows.empty() && here != unit)
        throw Error(Exit::data, csv.place(r), name + " is in \"" + here + "\", in \"" + unit + "\" before",
                    "evaluate all in one unit");
      unit = here;
    }
    std::vector<std::string> kept(row.begin() + 2, row.begin() + static_cast<std::ptrdiff_t>(measure));
    kept.push_back(row[sequence]);
    kept.push_back(row[value]);
    result.rows.push_back(std::move(kept));
    result.line.push_back(csv.line[r]);
  }
  if (result.rows.empty())
    throw Error(Exit::usage, "--error", csv.name + " has no row of \"" + wanted + "\"",
                "name a measure, or measure/alignment, of its rows");
  result.header.assign(csv.header.begin() + 2, csv.header.begin() + static_cast<std::ptrdiff_t>(measure));
  const bool no_factors = result.header.size() == 1;  // the algorithm alone
  result.header.push_back(no_factors ? "sequence" : "block");
  result.header.push_back(name);
  return result;
}

Results results_from(const io::Csv& given, const std::string& wanted, const std::vector<std::string>& factors) {
  Results results;
  results.name = given.name;
  const bool measures = has_measures(given);
  const io::Csv csv = measures ? of_one_measure(given, wanted, results.unit) : given;
  if (results.unit == "1") results.unit.clear();
  const bool usual = std::find(csv.header.begin(), csv.header.end(), "error") != csv.header.end();
  const std::string error = measures || (wanted.empty() && !usual) ? csv.header.back()
                            : wanted.empty()                       ? "error"
                                                                   : wanted;
  const std::size_t value = column(csv, error, "--error");
  results.measure = error;
  for (const std::string unit : {"mm", "m"})
    if (!measures && error.ends_with("_" + unit)) {
      results.unit = unit;
      results.measure = error.substr(0, error.size() - unit.size() - 1);
    }
  const auto block = std::find(csv.header.begin(), csv.header.end(), "block") - csv.header.begin();
  std::vector<std::size_t> columns;
  for (const std::string& f : factors) columns.push_back(column(csv, f, "--factors"));
  if (factors.empty())
    for (std::size_t c = 0; c < csv.header.size(); ++c)
      if (c != value && c != static_cast<std::size_t>(block)) columns.push_back(c);
  if (columns.empty()) throw Error(Exit::data, csv.name, "no column is left for a factor");
  for (const std::size_t c : columns) results.factors.push_back(csv.header[c]);
  for (std::size_t r = 0; r < csv.rows.size(); ++r) {
    const std::vector<std::string>& row = csv.rows[r];
    Result result{{}, error_number(row[value], csv.place(r)), {}};
    if (static_cast<std::size_t>(block) < row.size()) result.block = row[static_cast<std::size_t>(block)];
    for (const std::size_t c : columns) {
      if (row[c].empty())
        throw Error(Exit::data, csv.place(r), "factor \"" + csv.header[c] + "\" is empty", "name its level");
      result.factors[csv.header[c]] = row[c];
    }
    results.rows.push_back(std::move(result));
  }
  return results;
}

const manifest::EvaluatedError* find(const manifest::Evaluation& e, const std::string& measure,
                                     const std::string& alignment) {
  for (const manifest::EvaluatedError& error : e.errors)
    if (error.measure == measure && (alignment.empty() || error.alignment == alignment)) return &error;
  return nullptr;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += (text.empty() ? "" : ", ") + n;
  return text;
}

}  // namespace

Results read_results(const std::filesystem::path& file, const std::string& error,
                     const std::vector<std::string>& factors) {
  return results_from(io::read_csv(file), error, factors);
}
Results parse_results(const std::string& text, const std::string& name, const std::string& error,
                      const std::vector<std::string>& factors) {
  return results_from(io::parse_csv(text, name), error, factors);
}

Results results_of(const manifest::Document& document, const std::string& measure, const std::string& alignment) {
  const std::string place = document.name + "#/evaluations";
  if (document.evaluations.empty())
    throw Error(Exit::data, place, "there are none", "run nrsfm-eval on reconstructions");
  Results results;
  results.name = document.name;
  const manifest::Evaluation& first = document.evaluations.front();
  if (measure.empty() && first.errors.empty()) throw Error(Exit::data, place + "/0", "it has no errors");
  results.measure = measure.empty() ? first.errors.front().measure : measure;
  const std::string aligned = measure.empty() && alignment.empty() ? first.errors.front().alignment : alignment;
  std::set<std::string> names;
  for (const manifest::Evaluation& e : document.evaluations)
    for (const auto& [name, level] : e.factors) names.insert(name);
  names.erase("algorithm");
  if (names.empty()) names.insert("sequence");
  results.factors = {"algorithm"};
  results.factors.insert(results.factors.end(), names.begin(), names.end());
  bool any = false;
  for (std::size_t i = 0; i < document.evaluations.size(); ++i) {
    const manifest::Evaluation& e = document.evaluations[i];
    Result result{e.factors, nan, e.sequence};
    result.factors.try_emplace("algorithm", e.algorithm);
    result.factors.try_emplace("sequence", e.sequence);
    for (const std::string& f : results.factors)
      if (!result.factors.contains(f) || result.factors[f].empty())
        throw Error(Exit::data, place + "/" + std::to_string(i), "it has no level of factor \"" + f + "\"",
                    "name one: other evaluations do");
    if (const manifest::EvaluatedError* error = find(e, results.measure, aligned)) {
      if (any && error->unit != results.unit)
        throw Error(Exit::data, place + "/" + std::to_string(i),
                    results.measure + " is in \"" + error->unit + "\", in \"" + results.unit + "\" before",
                    "evaluate all in one unit");
      results.unit = error->unit;
      result.error = error->value;
      any = true;
    }
    std::erase_if(result.factors, [&](const auto& f) {
      return std::find(results.factors.begin(), results.factors.end(), f.first) == results.factors.end();
    });
    results.rows.push_back(std::move(result));
  }
  if (!any)
    throw Error(Exit::data, place,
                "none has \"" + results.measure + "\"" + (aligned.empty() ? "" : " under \"" + aligned + "\""),
                "ask for a measure and an alignment that they have");
  if (results.unit == "1") results.unit.clear();
  return results;
}

void keep_factors(Results& results, const std::vector<std::string>& factors) {
  if (factors.empty()) return;
  for (const std::string& f : factors)
    if (std::ranges::find(results.factors, f) == results.factors.end())
      throw Error(Exit::usage, "--factors", "there is no factor \"" + f + "\"",
                  "factors are " + listed(results.factors));
  results.factors = factors;
  for (Result& r : results.rows)
    std::erase_if(r.factors, [&](const auto& f) { return std::ranges::find(factors, f.first) == factors.end(); });
}

Results joined(std::vector<Results> tables) {
  Results all = std::move(tables.front());
  const std::set<std::string> factors(all.factors.begin(), all.factors.end());
  for (std::size_t k = 1; k < tables.size(); ++k) {
    Results& t = tables[k];
    if (std::set<std::string>(t.factors.begin(), t.factors.end()) != factors)
      throw Error(Exit::data, t.name,
                  "has the factors " + listed(t.factors) + ", " + all.name + " has " + listed(all.factors),
                  "choose common ones with --factors");
    if (t.measure != all.measure || t.unit != all.unit)
      throw Error(Exit::data, t.name,
                  "has " + t.measure + " in \"" + t.unit + "\", " + all.name + " has " + all.measure + " in \"" +
                      all.unit + "\"",
                  "analyse one error in one unit; --error chooses it");
    std::ranges::move(t.rows, std::back_inserter(all.rows));
  }
  return all;
}

}  // namespace gonio::nrsfm
