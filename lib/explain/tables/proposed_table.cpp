// See proposed_table.h.
#include "explain/tables/proposed_table.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace gonio::explain::tables {
namespace {

constexpr std::size_t readings = 4;

// What a person can set, and how far it makes sense.
struct Knob {
  const char* column;
  double least, most;
};
constexpr Knob knobs[] = {{"exposure_s", 1e-6, 1e4}, {"radiance", 0, 1e300},      {"distance_m", 0, 1e3},
                          {"path_m", 0, 1e3},        {"image_radius", 0, 1.4},    {"theta_i", 0, 1.48},
                          {"theta_o", 0, 1.48},      {"wavelength_m", 1e-7, 1e-5}};

std::size_t middle_row(std::span<const double> prediction, std::size_t observed) {
  std::vector<std::size_t> order(prediction.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return prediction[a] < prediction[b]; });
  return order[order.size() / 2] / observed;
}

}  // namespace

ProposedTable::ProposedTable(const manifest::Document& document, const Model& model, const Table& table,
                             const std::vector<std::string>& done, std::span<const double> prediction,
                             std::span<const double> sigma)
    : table_(table), own_rows_(table.rows()) {
  const std::size_t row = middle_row(prediction, table.observed.size());
  for (const Knob& knob : knobs) propose_beyond(knob.column, row);
  if (proposals_.empty()) return;
  table_.group.emplace_back("proposed");
  table_.first.push_back(table_.rows());
  bound_ = model.bind(document, table.name, table_);
  terms_ = std::make_unique<TermStack>(table_, model.name, done, bound_->parameters().size());
  for (std::size_t i = 0; i < prediction.size(); ++i) noise_.emplace_back(prediction[i], sigma[i]);
  std::sort(noise_.begin(), noise_.end());
}

// Where values are positive and span a factor of three they are stretched by four, else shifted by half their range.
void ProposedTable::propose_beyond(const std::string& column, std::size_t row) {
  const std::size_t c = table_.place_of(column);
  if (c == Table::none || !table_.labels[c].empty()) return;
  const Knob& knob =
      *std::find_if(std::begin(knobs), std::end(knobs), [&](const Knob& k) { return column == k.column; });
  const auto end = table_.values[c].begin() + static_cast<std::ptrdiff_t>(own_rows_);
  const double least = *std::min_element(table_.values[c].begin(), end);
  const double most = *std::max_element(table_.values[c].begin(), end);
  const bool by_factor = least > 0 && (most > 3 * least || most == least);
  const double reach = 0.5 * (most - least);
  const double below = std::max(knob.least, by_factor ? least / 4 : least - reach);
  const double above = std::min(knob.most, by_factor ? most * 4 : most + reach);
  // Distances and paths count from the table's smallest value for some terms: beyond it they would shift all rows.
  const bool counts_from_least = column == "distance_m";
  for (const double value : {below, above}) {
    if ((value < least && counts_from_least) || !(value < least || value > most)) continue;
    for (std::size_t n = 0; n < readings; ++n)
      for (std::size_t k = 0; k < table_.columns.size(); ++k)
        table_.values[k].push_back(k == c ? value : table_.values[k][row]);
    manifest::Value setup = manifest::Value::object({{table_.columns[c], value}});
    for (std::size_t k = 0; k < table_.columns.size(); ++k) {
      const bool is_observed = std::find(table_.observed.begin(), table_.observed.end(), k) != table_.observed.end() ||
                               std::find(table_.sigma.begin(), table_.sigma.end(), k) != table_.sigma.end();
      if (k != c && !is_observed && table_.labels[k].empty()) setup[table_.columns[k]] = table_.values[k][row];
    }
    proposals_.push_back({std::to_string(readings) + " readings at " + table_.columns[c] + " = " +
                              format("%.3g", value) + " " + (table_.units[c] == "1" ? "" : table_.units[c]),
                          std::move(setup)});
    while (proposals_.back().sentence.ends_with(' ')) proposals_.back().sentence.pop_back();
  }
}

ProposedRows ProposedTable::propose(std::span<const double> values, std::size_t proposal) const {
  const std::size_t first = own_rows_ + readings * proposal, observed = table_.observed.size();
  ProposedRows rows;
  rows.prediction.resize(readings * observed);
  bound_->predict(values.first(bound_->parameters().size()), first, first + readings, rows.prediction);
  terms_->act(values, first * observed, rows.prediction);
  for (const double f : rows.prediction) {
    const auto near = std::lower_bound(noise_.begin(), noise_.end(), std::pair{f, 0.0});
    rows.sigma.push_back((near == noise_.end() ? noise_.back() : *near).second);
  }
  return rows;
}

}  // namespace gonio::explain::tables
