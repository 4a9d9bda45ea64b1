// One table of observations as a problem: the model that the table names, the terms that its columns allow, groups,
// noise and conditions. Mechanisms that the manifest already switches on stand at their values and are no candidates
// any more, so that an upgraded manifest is explained again from where it stands.
//
// Values that are all of one sign may span decades, and an error of a tenth in a dark row matters as much as in a
// bright one: each observation is then divided by its reference, sqrt(f^2 + (10 sigma)^2) with f the base model's
// prediction, so that residuals are relative errors. Values that change their sign, and models with a norm of their
// own, keep their unit.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "explain/domain.h"
#include "explain/tables/proposed_table.h"
#include "explain/tables/table_model.h"
#include "explain/tables/term_stack.h"

namespace gonio::explain::tables {

class TablesProblem final : public Problem {
 public:
  // Error(data) at the table; `several`: the manifest has more than one, and the domain's name says which.
  TablesProblem(const manifest::Document& document, const std::string& name, const ProblemOptions& options,
                bool several);

  const Table& table() const { return table_; }
  const BoundModel& bound() const { return *bound_; }
  double reference(std::size_t observation) const { return reference_.empty() ? 1 : reference_[observation]; }
  const std::string& noise() const { return noise_; }  // "stated", or where it comes from

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override;
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override;
  std::string domain() const override { return domain_; }
  std::string unit() const override { return model_->unit; }
  std::string score_name() const override { return model_->score_name; }
  std::string group_noun() const override { return model_->group_noun; }
  Importance importance() const override { return model_->importance; }
  // Noise that was estimated on the base model's residuals is measured again where every mechanism had its part.
  std::optional<double> noise_factor(std::span<const double> residual) const override;
  bool noise_is_known() const override { return bound_->scatter_is_all(); }
  std::string remarks(const Explanation& explanation) const override;
  std::vector<Proposal> proposals() const override;
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override;
  void apply(const Explanation& explanation, manifest::Document& document) const override;
  Illustration illustrate(const Explanation& explanation, const std::filesystem::path& out,
                          manifest::Document& document) const override;

 private:
  void assemble(const manifest::Document& document);
  bool is_switched_on(const Candidate& candidate, const manifest::Document& document) const;
  bool holds(const Candidate& candidate, const manifest::MechanismUse& use) const;
  void switch_on(const manifest::Document& document);
  std::optional<std::size_t> number_of(const Candidate& candidate, std::size_t k,
                                       const manifest::MechanismUse& use) const;
  static bool of_single_targets(const Candidate& candidate);  // has it numbers of its own for each name in `on`?
  void observe(const manifest::Document& document, const ProblemOptions& options);
  void add_conditions(const manifest::Table& section);
  void set_blocks(const manifest::Table& section);
  void set_noise(const manifest::Table& section, const ProblemOptions& options);
  void set_reference();
  void rescale_sigma();
  void plan(const manifest::Document& document);
  std::vector<std::vector<double>> rescaled(std::vector<std::vector<double>> repeats) const;
  std::vector<double> final_slopes(std::span<const double> values, std::size_t first,
                                   std::vector<double> predictions) const;
  void finish(std::size_t first, std::span<double> predictions) const;  // into the unit of the observations
  std::vector<double> scaled(std::vector<double> values) const;         // divided by the references
  bool relative() const { return model_->unit == "1" && !rescaled_; }

  const Model* model_ = nullptr;
  Table table_;
  std::unique_ptr<BoundModel> bound_;
  std::unique_ptr<TermStack> terms_;
  std::unique_ptr<ProposedTable> proposed_;    // where the model proposes nothing itself; null: nothing
  std::vector<double> prediction_;             // of the base model, fitted: places conditions and scales noise
  std::vector<double> reference_;              // by which each observation is divided; empty: by nothing
  bool rescaled_ = false;                      // the model compares in a scale of its own
  std::vector<std::size_t> noise_conditions_;  // columns along which neighbours differ; empty: noise is known
  std::string domain_, noise_, grouped_;
};

// Tables that a registered model predicts.
bool has_tables(const manifest::Document& document);
std::vector<std::unique_ptr<Problem>> table_problems(const manifest::Document& document, const ProblemOptions& options);

// Values of the problem's parameters with the base model fitted alone, each observation weighted by its norm: good
// enough to place conditions by. Levenberg & Marquardt.
std::vector<double> preliminary_fit(const Problem& problem);

}  // namespace gonio::explain::tables
