// Who may win: every mechanism and every pair of mechanisms, scored on held-out groups by linear algebra alone, from
// one set of slopes and finite changes. Only those within reach of the best are fitted inside the simulator.
#pragma once
#include <vector>

#include "inference/race.h"

namespace gonio::inference {

struct Entrant {
  std::vector<std::size_t> candidates;
  double reach = 0;           // fall of the held-out mean square that its linear form promises
  double promise = 0;         // the same of the groups that it is fitted to
  HeldOut held_out;           // of that form
  std::vector<double> start;  // where the fit had best begin: the candidates' parameters in order
  double effect = 0;          // of that form, in the unit of Options::smallest_effect
};

class Screening {
 public:
  Screening(const Race& race, const ResidualStructure& residual_structure);
  // Every visible candidate, the furthest-reaching first.
  const std::vector<Entrant>& singles() const { return singles_; }
  // The furthest-reaching pairs, at most `keep` of them, after a look at no more than `most`. `with`: only pairs that
  // hold this candidate. Pairs with more numbers than a fold can bear are left to the rounds that follow a first one.
  std::vector<Entrant> pairs(std::size_t most, std::size_t keep, std::optional<std::size_t> with = {}) const;
  // Where else the fit of a candidate could begin: the points of its finite changes.
  std::vector<std::vector<double>> points(std::size_t candidate) const;
  std::size_t pair_count() const { return singles_.size() * (singles_.size() - 1) / 2; }

 private:
  // A candidate's linear forms: its slopes at the start, or its finite change to another point.
  struct Form {
    std::vector<Eigen::Index> columns;
    std::vector<double> point;
  };
  struct Runner {
    std::size_t candidate = 0;
    std::vector<Form> forms;  // slopes first, then the best change if that reaches further
  };
  Runner runner_of(std::size_t candidate) const;
  const Race& race_;
  const Evidence& evidence_;
  std::vector<Runner> runners_;  // in the order of singles_
  std::vector<Entrant> singles_;
};

}  // namespace gonio::inference
