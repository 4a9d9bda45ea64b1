// Forward models of tables, and terms that act on what any of them predicts. Both are registered by file:
// lib/explain/tables/models/<model>.cpp defines `const Model& <model>()` in namespace gonio::explain::tables,
// lib/explain/tables/terms/<id with _>.cpp defines `const Term& <id with _>()` in gonio::explain::tables::terms.
//
// TablesProblem (tables_problem.h) reads a table, sorts its rows by group, binds the model that the table names, adds
// the terms whose columns are there, and hands the whole to the engine. A row has one prediction for each observed
// column; observations are numbered row by row: row r, observed column k -> r * observed + k.
//
// Values are in SI: degrees have become radians when a model sees them, "theta_i [deg]" and "theta_i_deg" the column
// theta_i. A column is found by its name with or without its unit: "exposure" is exposure_s.
#pragma once
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "explain/engine.h"

namespace gonio::explain::tables {

struct Table {
  std::string name, place;                       // in the manifest's "tables"; "scan.json#/tables/t" for messages
  std::vector<std::string> columns, units;       // units after conversion to SI
  std::vector<std::vector<double>> values;       // [column][row]; columns of names: places in their labels
  std::vector<std::vector<std::string>> labels;  // [column]: the names in the order in which they appear; else empty
  std::vector<std::size_t> observed, sigma;      // columns; sigma empty: not stated
  std::vector<std::size_t> first;                // group g has rows first[g] .. first[g + 1] - 1
  std::vector<std::string> group;
  std::size_t rows() const { return values.empty() ? 0 : values[0].size(); }
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::size_t place_of(const std::string& column) const;  // none where there is no such column
  // The column's values; null where there is none.
  const std::vector<double>* find(const std::string& column) const;
  bool varies(const std::string& column) const;  // is there, with more than one value
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
  // One standard deviation of every observation where the table states none; empty: from repeats, else from differences
  // between neighbouring rows (table_noise.h).
  virtual std::vector<double> sigma() const { return {}; }
  // What readings differ by that the model cannot foretell and no mechanism is asked for, one standard deviation for
  // each observation in its unit: beside the noise that the table states. Empty: nothing.
  virtual std::vector<double> scatter() const { return {}; }
  virtual bool scatter_is_all() const { return false; }        // with it the noise is known: Problem::noise_is_known
  virtual std::string scatter_in_words() const { return {}; }  // goes on from "Noise as the table states it"
  // The scale in which a value of a row is compared with what was observed there: monotone, applied to observations
  // and, after all terms, to predictions (reflectance spans decades: log1p). Sigma, norm and conditions then live in
  // it.
  virtual double scaled(double value, std::size_t /*row*/) const { return value; }
  // Rows next to each other within a group may share an error: into how many blocks a group is cut where the table
  // names no column for them; 0: every row is one of its own.
  virtual std::size_t blocks_a_group() const { return 0; }
  // What it means, for people, that these mechanisms are named, with the model's own values and sigmas.
  virtual std::string remarks(std::span<const std::string> /*named*/, std::span<const double> /*values*/,
                              std::span<const double> /*sigma*/) const {
    return {};
  }
  // Fitted values with sigmas and the named mechanisms into the document's sections. `values`, `sigma`: the model's
  // own.
  virtual void apply(std::span<const double> values, std::span<const double> sigma,
                     manifest::Document& document) const = 0;
  // Can the manifest say it? Else it stands in the explanation alone: an object that was moved between two images.
  virtual bool is_of_manifest(const Candidate& /*candidate*/) const { return true; }
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
  std::string score_name = "relative RMSE", unit = "1";
  std::string group_noun = "group";  // "series", "frame"
  std::string group{};               // column that holds rows together where the table names none: "theta_i"
  Importance importance = Importance::share_of_signal;
  bool reads_light = true;  // terms (of lamps, optics, sensors of light) act on what it predicts
  std::unique_ptr<BoundModel> (*bind)(const manifest::Document& document, const std::string& name,
                                      const Table& table) = nullptr;
};
template <class Bound>  // a Model's `bind` that constructs it
std::unique_ptr<BoundModel> bind_as(const manifest::Document& document, const std::string& name, const Table& table) {
  return std::make_unique<Bound>(document, name, table);
}
std::span<const Model* const> all_models();  // sorted by name; defined in a generated source
const Model* find_model(const std::string& name);

// A parameter of a term in one table: bounds and steps follow the table's scale.
struct TermParameter {
  // free: fitted. fixed: stays at `start` (the value at which a departure is stated). same: as the term's first one
  // (one channel of three).
  enum class Use { free, fixed, same };
  double start = 0, lower = 0, upper = 0, size = 1;
  Use use = Use::free;
  bool as_observed = false;  // in the unit of the observed column
};
struct TermColumn {
  std::string name, unit, meaning;
  bool from_least = false;  // `at` counts from the column's smallest value: time since the first row
  bool needed = true;       // else NaN where the table has none
  bool as_share = false;    // of its largest value
};

// A mechanism that changes a predicted value through known columns, whatever predicted it: an offset, a response curve,
// a drift with time.
struct Term {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  int order = 0;                                  // terms act in this order: light, volume, optics, sensor (term_order)
  std::vector<TermColumn> columns{};              // in the order of `at`
  std::vector<std::string> models{};              // to which it applies; empty: to all
  bool (*applies)(const Table& table) = nullptr;  // null: wherever the needed columns are there and vary
  // Null: the mechanism's own equation, whose inputs are these columns in this order. A term has one of its own where
  // columns may be missing, or where it is one form of several, and calls the equation (namespace gonio::equation).
  double (*act)(double predicted, std::span<const double> at, std::span<const double> parameters) = nullptr;
  // Fits the mechanism's declaration (already in `parameters`) to a table whose largest observation is `scale`.
  void (*adapt)(const Table& table, double scale, std::span<TermParameter> parameters) = nullptr;
  std::span<const Term> alternatives{};  // further forms of the same mechanism, each a candidate of its own
};
namespace term_order {  // as render/sensor_chain.h has it behind the optics
constexpr int light = 100, volume = 200, reference = 300, optics = 400, shutter = 500, dark_current = 550,
              non_linearity = 600, row_pattern = 700, black_offset = 800, saturation = 900;
}
std::span<const Term* const> all_terms();  // sorted by name; defined in a generated source
std::vector<const Term*> all_forms();      // of all of them, each term's alternatives behind it

}  // namespace gonio::explain::tables
