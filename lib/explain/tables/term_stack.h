// The registered terms that a table's columns allow, bound to it and applied one after the other to what the model
// predicts: f' = act_n(... act_1(f)). Derivatives with respect to the model's parameters follow by the chain rule, so
// that the model is differentiated once, whatever the terms.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "explain/tables/table_model.h"

namespace gonio::explain::tables {

class TermStack {
 public:
  // Terms whose mechanism is among `done` are the model's own and left out. `offset`: place of the first of
  // parameters() among the problem's.
  TermStack(const Table& table, const std::string& model, const std::vector<std::string>& done, std::size_t offset);

  const std::vector<Parameter>& parameters() const { return parameters_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }

  // Observations first .. first + predictions.size() - 1, in place. `values`: of all the problem's parameters.
  void act(std::span<const double> values, std::size_t first, std::span<double> predictions) const;
  // df'/df of each observation, `predictions` being the model's own.
  void slopes(std::span<const double> values, std::size_t first, std::span<const double> predictions,
              std::span<double> slopes) const;
  // df'/dp for the parameter at `column` of the problem.
  void derivative(std::span<const double> values, std::size_t first, std::span<const double> predictions,
                  std::size_t column, std::span<double> derivative) const;
  // All numbers of candidate `c`'s mechanism as the manifest states them, in its order: free, fixed and tied ones.
  std::vector<double> amounts(std::size_t c, std::span<const double> values) const;

 private:
  struct Bound {
    const Term* term = nullptr;
    std::vector<std::vector<double>> at;  // [column][row]
    std::vector<std::size_t> places;      // one per parameter of the mechanism: the problem's, or none: `fixed` holds
    std::vector<double> fixed, neutral;
    bool in_play(std::span<const double> values) const;
  };
  void bind(const Table& table, const Term& term);
  std::vector<double> numbers(const Bound& bound, std::span<const double> values) const;

  std::vector<Bound> bound_;
  std::vector<Parameter> parameters_;
  std::vector<Candidate> candidates_;
  std::size_t observed_ = 1, offset_ = 0;
};

// Is the term offered to tables of this model with these columns?
bool is_applicable(const Term& term, const Table& table, const std::string& model);

}  // namespace gonio::explain::tables
