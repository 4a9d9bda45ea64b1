// Model "expression": the user's own forward model, tables/T/expression over columns and tables/T/parameters
// (base/expression.h).
#include "base/expression.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/table_model.h"
#include "explain/tables/unit.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "none" : text;
}

class OwnModel final : public BoundModel {
 public:
  OwnModel(const manifest::Document& document, const std::string& name, const Table& table)
      : name_(name), expression_(document.tables.at(name).expression, table.place + "/expression") {
    if (table.observed.size() != 1)
      throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                  "an expression predicts one");
    const manifest::Table& section = document.tables.at(name);
    std::vector<std::string> unknown;
    for (const std::string& used : expression_.names()) {
      const std::size_t column = table.place_of(used);
      const bool given = section.parameters.contains(used);
      place_.push_back(Table::none);
      column_.emplace_back();
      if (column != Table::none)
        bind_column(table, column, used, given);
      else if (given)
        bind_parameter(section, used);
      else
        unknown.push_back(used);
    }
    if (!unknown.empty())
      throw Error(
          Exit::data, table.place + "/expression",
          "uses " + joined(unknown) + ", neither columns nor parameters (columns: " + joined(table.columns) + ")",
          "parameters are given as --free " + unknown[0] + "=1, or in the table's parameters");
    for (const auto& [parameter, value] : section.parameters)
      if (std::find(expression_.names().begin(), expression_.names().end(), parameter) == expression_.names().end())
        throw Error(Exit::data, table.place + "/parameters/" + parameter, "is not in the expression",
                    "it uses " + joined(expression_.names()));
  }

  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const override {
    std::vector<const double*> columns;
    std::vector<double> constants;
    for (std::size_t k = 0; k < place_.size(); ++k) {
      columns.push_back(place_[k] == Table::none ? column_[k].data() : nullptr);
      constants.push_back(place_[k] == Table::none ? 0 : values[place_[k]]);
    }
    expression_.evaluate(columns, constants, first, prediction.first(last - first));
  }
  void apply(std::span<const double> values, std::span<const double> sigma,
             manifest::Document& document) const override {
    manifest::Table& section = document.tables.at(name_);
    for (std::size_t p = 0; p < parameters_.size(); ++p)
      store_parameter(section, parameters_[p].name.substr(parameters_[p].name.rfind('/') + 1), values[p], sigma[p]);
  }

 private:
  void bind_column(const Table& table, std::size_t column, const std::string& used, bool given) {
    if (given)
      throw Error(Exit::data, table.place + "/parameters/" + used, "is a column of the table as well",
                  "rename the parameter");
    if (std::find(table.observed.begin(), table.observed.end(), column) != table.observed.end())
      throw Error(Exit::data, table.place + "/expression", "uses \"" + used + "\", which is what it has to predict");
    if (!table.labels[column].empty())
      throw Error(Exit::data, table.place + "/expression", "uses \"" + used + "\", a column of names");
    column_.back() = table.values[column];
  }
  void bind_parameter(const manifest::Table& section, const std::string& used) {
    ModelParameter p = model_parameter(section, name_, used, "", 1, false);
    place_.back() = parameters_.size();
    if (p.free) base_.push_back(parameters_.size());
    parameters_.push_back(std::move(p.parameter));
  }

  std::string name_;
  Expression expression_;
  std::vector<std::size_t> place_;           // of each name among the parameters; none: a column
  std::vector<std::vector<double>> column_;  // its rows
};

}  // namespace

const Model& expression() {
  static const Model model{.name = "expression",
                           .sentence = "A formula of the user's own over columns and parameters: a*cos(theta)+b.",
                           .columns = {},
                           .bind = bind_as<OwnModel>};
  return model;
}

}  // namespace gonio::explain::tables
