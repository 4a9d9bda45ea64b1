// What the user writes as a formula: a forward model over the columns of a table and named parameters, a pattern over
// places. Evaluated by muParser. Constant pi; functions sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh
// atanh exp ln log10 log2 sqrt abs sign rint min max sum avg (and log, which is ln); operators + - * / ^, comparisons,
// && ||, and condition ? a : b. Columns are in SI and are named with or without their unit: theta for theta_rad.
#pragma once
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace gonio {

class Expression {
 public:
  // Error(data) at `place` with the position of what does not parse. Assignments are refused.
  Expression(std::string text, std::string place);
  ~Expression();
  const std::vector<std::string>& names() const { return names_; }  // that it uses, sorted

  // Value for row after row: `columns[k]` points to the rows of names()[k], or is null and `constants[k]` holds.
  // Safe from several threads: each takes a parser of its own from a pool.
  void evaluate(std::span<const double* const> columns, std::span<const double> constants, std::size_t first,
                std::span<double> values) const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine() const;

  std::string text_, place_;
  std::vector<std::string> names_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Engine>> idle_;
};

}  // namespace gonio
