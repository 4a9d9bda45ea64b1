// See tables_problem.h: assembly and prediction.
#include "explain/tables/tables_problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/tables/read_table.h"
#include "explain/tables/table_conditions.h"
#include "explain/tables/table_noise.h"
#include "explain/tables/unit.h"
#include "manifest/document.h"
#include "manifest/fields.h"
#include "manifest/sections/table.h"

namespace gonio::explain::tables {
namespace {

const Model& model_of(const manifest::Document& document, const std::string& name) {
  const manifest::Table& section = document.tables.at(name);
  if (const Model* model = find_model(section.model)) return *model;
  std::vector<std::string> known;
  for (const Model* model : all_models()) known.push_back(model->name);
  throw Error(Exit::data, manifest::place(document, "/tables/" + name + "/model"),
              "\"" + section.model + "\" is no model of a table", manifest::remedy_for(section.model, known));
}

// Along which rows are cut into groups: the model's columns, those that an expression names, then all others that are
// no observations.
std::vector<std::string> telling_columns(const Model& model, const manifest::Table& section) {
  std::vector<std::string> telling;
  for (const Column& column : model.columns) telling.push_back(column.name);
  for (const auto& [column, unit] : section.columns)
    if (std::find(section.observed.begin(), section.observed.end(), column) == section.observed.end() &&
        std::find(section.sigma.begin(), section.sigma.end(), column) == section.sigma.end() &&
        !stem_of(column).ends_with("_sigma"))
      telling.push_back(column);
  std::stable_partition(telling.begin() + static_cast<std::ptrdiff_t>(model.columns.size()), telling.end(),
                        [&](const std::string& c) { return section.expression.find(stem_of(c)) != std::string::npos; });
  return telling;
}

}  // namespace

TablesProblem::TablesProblem(const manifest::Document& document, const std::string& name, const ProblemOptions& options,
                             bool several)
    : model_(&model_of(document, name)), domain_(several ? "tables-" + name : "tables") {
  const manifest::Table& section = document.tables.at(name);
  const std::string usual = model_->group.empty() ? "series" : model_->group;
  table_ = read_table(document, name, usual, telling_columns(*model_, section));
  if (section.group.empty() && table_.place_of(usual) == Table::none)
    grouped_ = "Rows were held out in " + std::to_string(table_.group.size()) + " stretches, " + table_.group.front() +
               " first: name a column with `group` if rows belong together otherwise.";
  bound_ = model_->bind(document, name, table_);
  assemble(document);
  switch_on(document);
  observe(document, options);
}

void TablesProblem::assemble(const manifest::Document&) {
  parameters_ = bound_->parameters();
  base_ = bound_->base();
  candidates_ = bound_->candidates();
  std::vector<std::string> done;
  for (const Candidate& c : candidates_) done.push_back(c.id());
  if (!model_->reads_light)
    for (const Term* form : all_forms()) done.push_back(form->mechanism().id);
  terms_ = std::make_unique<TermStack>(table_, model_->name, done, parameters_.size());
  parameters_.insert(parameters_.end(), terms_->parameters().begin(), terms_->parameters().end());
  candidates_.insert(candidates_.end(), terms_->candidates().begin(), terms_->candidates().end());
}

void TablesProblem::observe(const manifest::Document& document, const ProblemOptions& options) {
  const manifest::Table& section = document.tables.at(table_.name);
  Observations& o = observations_;
  const std::size_t observed = table_.observed.size();
  for (std::size_t r = 0; r < table_.rows(); ++r)
    for (const std::size_t c : table_.observed) o.value.push_back(table_.values[c][r]);
  for (std::size_t i = 0; i < o.value.size(); ++i) {
    const double own = bound_->scaled(o.value[i], i / observed);
    rescaled_ = rescaled_ || own != o.value[i];
    o.value[i] = own;
  }
  for (const std::size_t first : table_.first) o.first.push_back(first * observed);
  o.group = table_.group;
  o.norm = bound_->norm();
  double square = 0;
  for (const double y : o.value) square += y * y / static_cast<double>(o.value.size());
  if (o.norm.empty())
    for (const double y : o.value) o.norm.push_back(relative() ? y * y : 1);
  if (!(square > 0)) throw Error(Exit::data, table_.place, "observes nothing but zeros");
  set_blocks(section);
  // Until noise is known: one part in a hundred of the value, and of the table's typical value.
  for (const double y : o.value) o.sigma.push_back(0.01 * std::sqrt(relative() ? y * y + 1e-4 * square : 1));
  const std::vector<double> values = preliminary_fit(*this);
  prediction_.resize(o.rows());
  for (std::size_t g = 0; g < o.groups(); ++g)
    predict(values, g, {prediction_.data() + o.first[g], o.first[g + 1] - o.first[g]});
  for (const double f : prediction_)
    if (!std::isfinite(f))
      throw Error(Exit::data, table_.place, "the model predicts a value that is not finite",
                  "check the starting values of its parameters");
  set_noise(section, options);
  set_reference();
  plan(document);
  add_conditions(section);
}

void TablesProblem::set_reference() {
  Observations& o = observations_;
  const bool one_sign = std::all_of(prediction_.begin(), prediction_.end(), [](double f) { return f >= 0; }) ||
                        std::all_of(prediction_.begin(), prediction_.end(), [](double f) { return f <= 0; });
  if (!relative() || !one_sign || !bound_->norm().empty()) return;
  for (std::size_t i = 0; i < o.rows(); ++i) {
    reference_.push_back(std::hypot(prediction_[i], 10 * o.sigma[i]));
    o.value[i] /= reference_[i];
    o.sigma[i] /= reference_[i];
    o.norm[i] = 1;
  }
}

void TablesProblem::set_blocks(const manifest::Table& section) {
  Observations& o = observations_;
  const std::size_t observed = table_.observed.size();
  const std::size_t column = section.block.empty() ? Table::none : table_.place_of(section.block);
  if (!section.block.empty() && column == Table::none)
    throw Error(Exit::data, table_.place + "/block", "names column \"" + section.block + "\", which the table lacks");
  const std::size_t shared = bound_->blocks_a_group();
  std::uint32_t next = 0;
  for (std::size_t g = 0; g < o.groups(); ++g) {
    std::vector<std::pair<double, std::uint32_t>> seen;
    for (std::size_t r = table_.first[g]; r < table_.first[g + 1]; ++r) {
      std::uint32_t block = next;
      if (column == Table::none && shared > 0) {
        const std::size_t rows = table_.first[g + 1] - table_.first[g], k = r - table_.first[g];
        o.block.insert(o.block.end(), observed, next + static_cast<std::uint32_t>(k * shared / rows));
        continue;
      }
      if (column != Table::none) {
        const double value = table_.values[column][r];
        const auto found = std::find_if(seen.begin(), seen.end(), [&](const auto& s) { return s.first == value; });
        if (found != seen.end())
          block = found->second;
        else
          seen.emplace_back(value, block);
      }
      if (block == next) ++next;
      o.block.insert(o.block.end(), observed, block);
    }
    if (column == Table::none) next += static_cast<std::uint32_t>(shared);
  }
}

std::vector<double> TablesProblem::scaled(std::vector<double> values) const {
  for (std::size_t i = 0; i < reference_.size(); ++i) values[i] /= reference_[i];
  return values;
}

void TablesProblem::add_conditions(const manifest::Table& section) {
  std::vector<Condition> by_row = bound_->conditions();
  for (Condition& c : further_conditions(table_, section, by_row, model_->columns)) by_row.push_back(std::move(c));
  const std::size_t observed = table_.observed.size();
  for (Condition& c : by_row) {
    std::vector<double> values;
    for (const double v : c.values) values.insert(values.end(), observed, v);
    c.values = std::move(values);
    if (c.direction.empty() && relative()) c.direction = scaled(prediction_);
    if (c.curve_unit.empty()) c.curve_unit = relative() ? "1" : model_->unit;
    observations_.conditions.push_back(std::move(c));
  }
  const bool varies =
      std::any_of(prediction_.begin(), prediction_.end(), [&](double f) { return f != prediction_[0]; });
  const bool stated =
      std::any_of(by_row.begin(), by_row.end(), [](const Condition& c) { return c.name == "image.radiance"; });
  if (!varies || stated || !relative()) return;
  const std::string unit = table_.units[table_.observed[0]];
  const std::vector<double> absolute = reference_.empty() ? reference_ : scaled(std::vector(prediction_.size(), 1.0));
  observations_.conditions.push_back({"image.radiance", unit, "sensor", prediction_, absolute, unit});
}

std::vector<std::vector<double>> TablesProblem::rescaled(std::vector<std::vector<double>> repeats) const {
  for (std::vector<double>& take : repeats)
    for (std::size_t i = 0; i < take.size() && rescaled_; ++i)
      take[i] = bound_->scaled(take[i], i / table_.observed.size());
  return repeats;
}

void TablesProblem::set_noise(const manifest::Table& section, const ProblemOptions& options) {
  Observations& o = observations_;
  std::vector<double> own = bound_->sigma();
  if (!table_.sigma.empty() && options.repeats.empty()) {
    o.sigma.clear();
    for (std::size_t r = 0; r < table_.rows(); ++r)
      for (const std::size_t c : table_.sigma) o.sigma.push_back(table_.values[c][r]);
    if (rescaled_) rescale_sigma();
    const std::vector<double> scatter = bound_->scatter();
    for (std::size_t i = 0; i < scatter.size(); ++i) o.sigma[i] = std::hypot(o.sigma[i], scatter[i]);
    noise_ = "as the table states it" + bound_->scatter_in_words();
    return;
  }
  if (!own.empty() && options.repeats.empty()) {
    o.sigma = std::move(own);
    noise_ = "as the model has it";
    return;
  }
  std::vector<std::size_t> conditions;
  for (std::size_t c = 0; c < table_.columns.size(); ++c) {
    const auto in = [&](const std::vector<std::size_t>& list) {
      return std::find(list.begin(), list.end(), c) != list.end();
    };
    if (in(table_.observed) || in(table_.sigma) || table_.columns[c] == section.block ||
        !table_.varies(table_.columns[c]))
      continue;
    conditions.push_back(c);
  }
  const NoiseModel noise =
      table_noise(table_, o.value, prediction_, rescaled(read_repeats(options.repeats, section, table_)), conditions);
  for (std::size_t i = 0; i < o.rows(); ++i) o.sigma[i] = noise.sigma(prediction_[i]);
  noise_ = noise.how;
  if (noise.from_neighbours) noise_conditions_ = std::move(conditions);
}

std::optional<double> TablesProblem::noise_factor(std::span<const double> residual) const {
  if (noise_conditions_.empty()) return {};
  std::size_t fitted = base_.size();
  for (const Candidate& c : candidates_) fitted += c.parameters.size();
  const auto rows = static_cast<double>(residual.size()), freedom = rows - static_cast<double>(fitted);
  if (freedom < 0.5 * rows) return 1.0;
  std::vector<double> whitened(residual.begin(), residual.end());
  for (std::size_t i = 0; i < whitened.size(); ++i) whitened[i] /= observations_.sigma[i];
  const double scatter = neighbour_scatter(table_, whitened, noise_conditions_);
  return scatter > 0 ? scatter * std::sqrt(rows / freedom) : 1.0;
}

// The slope of the scale over the noise itself, at what was observed.
void TablesProblem::rescale_sigma() {
  Observations& o = observations_;
  const std::size_t observed = table_.observed.size();
  for (std::size_t i = 0; i < o.rows(); ++i) {
    const std::size_t row = i / observed;
    const double y = table_.values[table_.observed[i % observed]][row], s = o.sigma[i];
    o.sigma[i] = std::abs(bound_->scaled(y + 0.5 * s, row) - bound_->scaled(y - 0.5 * s, row));
  }
}

void TablesProblem::predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const {
  bound_->predict(values.first(bound_->parameters().size()), table_.first[group], table_.first[group + 1], prediction);
  const std::size_t first = table_.first[group] * table_.observed.size();
  terms_->act(values, first, prediction);
  finish(first, prediction);
}

void TablesProblem::finish(std::size_t first, std::span<double> predictions) const {
  const std::size_t observed = table_.observed.size();
  for (std::size_t i = 0; i < predictions.size() && rescaled_; ++i)
    predictions[i] = bound_->scaled(predictions[i], (first + i) / observed);
  for (std::size_t i = 0; i < predictions.size() && !reference_.empty(); ++i) predictions[i] /= reference_[first + i];
}

void TablesProblem::jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                             std::span<double> derivatives) const {
  const std::size_t own = bound_->parameters().size(), observed = table_.observed.size();
  const std::size_t first = table_.first[group] * observed, rows = table_.first[group + 1] * observed - first;
  std::vector<double> predictions(rows), slopes(rows);
  bound_->predict(values.first(own), table_.first[group], table_.first[group + 1], predictions);
  std::vector<std::size_t> of_model, places;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] < own) {
      of_model.push_back(columns[k]);
      places.push_back(k);
    } else {
      terms_->derivative(values, first, predictions, columns[k], derivatives.subspan(k * rows, rows));
    }
  }
  std::vector<double> unit_slopes = final_slopes(values, first, predictions);
  const auto scale_all = [&] {
    for (std::size_t k = 0; k < derivatives.size() && !unit_slopes.empty(); ++k)
      derivatives[k] *= unit_slopes[k % rows];
  };
  if (of_model.empty()) return scale_all();
  std::vector<double> inner(of_model.size() * rows);
  bound_->jacobian(values.first(own), table_.first[group], table_.first[group + 1], of_model, inner);
  terms_->slopes(values, first, predictions, slopes);
  for (std::size_t k = 0; k < of_model.size(); ++k)
    for (std::size_t i = 0; i < rows; ++i) derivatives[places[k] * rows + i] = inner[k * rows + i] * slopes[i];
  scale_all();
}

// Of what finish() does, at what the terms make of the model's `predictions`; empty: 1.
std::vector<double> TablesProblem::final_slopes(std::span<const double> values, std::size_t first,
                                                std::vector<double> predictions) const {
  if (!rescaled_ && reference_.empty()) return {};
  terms_->act(values, first, predictions);
  std::vector<double> above = predictions, below = predictions, slopes(predictions.size());
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const double step = 1e-6 * (std::abs(predictions[i]) + 1e-12);
    above[i] += step;
    below[i] -= step;
    slopes[i] = 1 / (above[i] - below[i]);
  }
  finish(first, above);
  finish(first, below);
  for (std::size_t i = 0; i < slopes.size(); ++i) slopes[i] *= above[i] - below[i];
  return slopes;
}

void TablesProblem::plan(const manifest::Document& document) {
  const bool bindable = model_->name == "sensor" || model_->name == "volume" || model_->name == "expression";
  if (!bound_->proposals().empty() || rescaled_ || !bindable) return;
  std::vector<std::string> done;
  for (const Candidate& c : bound_->candidates()) done.push_back(c.id());
  // The same terms at the same places: a column that only the proposals vary would let in further ones.
  for (const Term* term : all_forms()) {
    const std::string& id = term->mechanism().id;
    const auto same = [&](const Candidate& c) { return c.id() == id; };
    if (std::none_of(terms_->candidates().begin(), terms_->candidates().end(), same)) done.push_back(id);
  }
  std::vector<double> sigma = observations_.sigma;
  for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] *= reference(i);
  proposed_ = std::make_unique<ProposedTable>(document, *model_, table_, done, prediction_, sigma);
  if (proposed_->term_parameters() != terms_->parameters().size()) proposed_.reset();
}

std::vector<Proposal> TablesProblem::proposals() const {
  return proposed_ ? proposed_->proposals() : bound_->proposals();
}

ProposedRows TablesProblem::propose(std::span<const double> values, std::size_t proposal) const {
  return proposed_ ? proposed_->propose(values, proposal)
                   : bound_->propose(values.first(bound_->parameters().size()), proposal);
}

}  // namespace gonio::explain::tables
