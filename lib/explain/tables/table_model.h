// Forward models of tables, and terms that act on what any of them predicts. Both are registered by file:
// lib/explain/tables/models/<model>.cpp defines `const Model& <model>()`, lib/explain/tables/terms/<id with _>.cpp
// defines `const Term& <id with _>()`, in namespace gonio::explain::tables.
//
// TablesProblem (tables_problem.h) reads a table, sorts its rows by group, binds the model that the table names, adds
// the terms whose columns are there, and hands the whole to the engine. A row has one prediction for each observed
// column; observations are numbered row by row: row r, observed column k -> r * observed + k.
//
// Values are in SI: degrees have become radians when a model sees them.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "explain/problem.h"

namespace gonio::explain::tables {

struct Table {
  std::string name, place;                   // in the manifest's "tables"; "scan.json#/tables/t" for messages
  std::vector<std::string> columns, units;   // units after conversion to SI
  std::vector<std::vector<double>> values;   // [column][row]
  std::vector<std::size_t> observed, sigma;  // columns; sigma empty: not stated
  std::vector<std::size_t> first;            // group g has rows first[g] .. first[g + 1] - 1
  std::vector<std::string> group;
  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  // The column's values; null where there is none.
  const std::vector<double>* find(const std::string& column) const;
  // Error(data) at the table where it is missing or has another dimension than `unit`.
  const std::vector<double>& needed(const std::string& column, const std::string& unit) const;
};

struct Column {  // what a model reads: for the manual, the messages, and the test that walks the registry
  std::string name, unit, meaning;
  bool needed = true;
};

// A model bound to one table. It fills the lists in its constructor; places in `parameters` are its own, from zero.
class BoundModel {
 public:
  virtual ~BoundModel() = default;
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<std::size_t>& base() const { return base_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  // One value per row of the table, NaN where it does not apply; directions are left empty (the problem sets them to
  // the prediction where the score is relative).
  const std::vector<Condition>& conditions() const { return conditions_; }

  // Rows first .. last - 1 of the table; `prediction` has (last - first) * observed places.
  virtual void predict(std::span<const double> values, std::size_t first, std::size_t last,
                       std::span<double> prediction) const = 0;
  // Derivatives, column after column; the default takes central differences, a step of 1e-4 size, one-sided at bounds.
  virtual void jacobian(std::span<const double> values, std::size_t first, std::size_t last,
                        std::span<const std::size_t> columns, std::span<double> derivatives) const;
  // What a residual of one observation counts in the score's unit; empty: 1 for absolute scores, y^2 for relative ones.
  virtual std::vector<double> norm() const { return {}; }
  // Fitted values with sigmas and the named mechanisms into the document's sections. `values`, `sigma`: the model's
  // own.
  virtual void apply(std::span<const double> values, std::span<const double> sigma,
                     manifest::Document& document) const = 0;
  virtual std::vector<Proposal> proposals() const { return {}; }
  virtual ProposedRows propose(std::span<const double>, std::size_t) const { return {}; }

 protected:
  BoundModel() = default;
  std::vector<Parameter> parameters_;
  std::vector<std::size_t> base_;
  std::vector<Candidate> candidates_;
  std::vector<Condition> conditions_;
};

struct Model {
  std::string name;      // "surface": the manifest's tables/T/model
  std::string sentence;  // what it predicts
  std::vector<Column> columns;
  std::string score_name, unit;  // "relative RMSE", "1"
  std::string group_noun;        // "series", "frame"
  Importance importance = Importance::share_of_signal;
  std::unique_ptr<BoundModel> (*bind)(const manifest::Document& document, const std::string& name,
                                      const Table& table) = nullptr;
};
std::span<const Model* const> all_models();  // sorted by name; defined in a generated source
const Model* find_model(const std::string& name);

// A mechanism that changes a predicted value through known columns, whatever predicted it: an offset, a response curve,
// a drift with time. `act` returns `predicted`, to the bit, at the neutral parameters.
struct Term {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  std::vector<Column> columns;                    // needed, in the order of `at`
  std::vector<std::string> models;                // to which it applies; empty: to all
  bool (*applies)(const Table& table) = nullptr;  // null: wherever the columns are there and vary
  double (*act)(double predicted, std::span<const double> at, std::span<const double> parameters) = nullptr;
};
std::span<const Term* const> all_terms();

}  // namespace gonio::explain::tables
