// One round of the search: what may join a model, screened linearly, the furthest-reaching fitted inside the simulator,
// best first.
#pragma once
#include <optional>
#include <vector>

#include "inference/screening.h"

namespace gonio::inference {

struct Runner {
  Model model;
  Hypothesis hypothesis;
  bool polished = false;  // fitted to the end with derivatives of its own
  bool taken = false;     // next() has given it
};

class ForwardStep {
 public:
  // All of them outlive the round.
  ForwardStep(const Race& race, const Effort& effort, const Model& model, const ResidualStructure& left);

  const std::vector<Runner>& runners() const { return runners_; }
  // Those that the screening left behind, as lines of the scoreboard.
  std::vector<Hypothesis> screened_out() const;

  // The best that passes, fitted to the end; among those that the data cannot part from it the plainest: no finer form
  // of another one, and the fewest numbers. It leaves the round's choice: called again, the next. Nothing: none passes.
  std::optional<Runner> next();
  // Pairs that were passed over because a single one passed: to be called once that one has been refused.
  void admit_pairs();

 private:
  Runner fitted(const Entrant& e, std::size_t looks) const;
  Runner polished(const Runner& r) const;
  void run_singles();
  void run_pairs();
  void run_overlooked();
  void polish_leaders();
  std::optional<std::size_t> winner() const;
  bool may_matter(const Entrant& e) const;
  bool more_than_either(const Entrant& pair) const;
  bool plainer(const Runner& a, const Runner& b) const;

  const Race& race_;
  const Effort& effort_;
  const Model& model_;
  const ResidualStructure& left_;
  Screening screening_;
  Slopes kept_;
  std::vector<Runner> runners_;
  std::vector<Entrant> passed_over_;
  std::size_t fitted_ = 0, pairs_ = 0;   // of the singles, those before this place
  std::vector<std::size_t> overlooked_;  // places of singles that were fitted behind it
  double rows_ = 0;
};

}  // namespace gonio::inference
