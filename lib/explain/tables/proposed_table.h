// Measurements that could be taken next: the middle row of a table again with one condition beyond its present range, a
// quarter of the shortest exposure, four times the longest. They are predicted by the same model and terms, bound to
// the table with these rows behind it.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "explain/tables/term_stack.h"

namespace gonio::explain::tables {

class ProposedTable {
 public:
  // `done`: mechanisms of the model's own. `prediction`, `sigma`: of the base model, one per observation, in the
  // table's unit.
  ProposedTable(const manifest::Document& document, const Model& model, const Table& table,
                const std::vector<std::string>& done, std::span<const double> prediction,
                std::span<const double> sigma);

  const std::vector<Proposal>& proposals() const { return proposals_; }
  // How many parameters its terms have: as many as the problem's own, or `values` means something else here.
  std::size_t term_parameters() const { return terms_ ? terms_->parameters().size() : 0; }
  // Four readings. `values`: of all the problem's parameters.
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const;

 private:
  void propose_beyond(const std::string& column, std::size_t row);

  Table table_;
  std::size_t own_rows_ = 0;
  std::vector<Proposal> proposals_;
  std::unique_ptr<BoundModel> bound_;
  std::unique_ptr<TermStack> terms_;
  std::vector<std::pair<double, double>> noise_;  // prediction, sigma; ascending
};

}  // namespace gonio::explain::tables
