// The race of hypotheses: every model is a set of candidates switched on together with the free parameters, fitted on
// the groups in play and scored on held-out groups; dummies and free curves run against them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/fit.h"
#include "explain/signature.h"

namespace gonio::explain {

struct Model {
  std::vector<std::size_t> candidates;
  Fit fit;
  HeldOut held_out;
};

class Race {
 public:
  Race(const System& system, const Options& options);

  const System& system() const { return system_; }
  const std::vector<std::size_t>& allowed() const { return allowed_; }  // candidates that may be named
  const std::vector<std::size_t>& free() const { return free_; }        // base parameters that are not protected

  Model base(const std::vector<double>& start) const;
  // `from` with other candidates; fitted from its values, new candidates from their starting points.
  Model changed(const Model& from, std::vector<std::size_t> candidates) const;
  // Candidates that may join: allowed, not in the model, no relative in it.
  std::vector<std::size_t> open_to(const Model& model) const;

  // The step from `before` to `after` as one line of the scoreboard; `refused` says which condition of a name it fails.
  // `dummies`: what those achieved on the same model; more than a tenth of them better by its standard
  // error, and it is no better than chance.
  // `looks`: hypotheses tried beside it.
  Hypothesis judged(const Model& before, const Model& after, const std::vector<std::size_t>& added,
                    const std::vector<Hypothesis>& dummies, std::size_t looks) const;
  double effect(const Model& before, const Model& after) const;
  std::string name_of(const std::vector<std::size_t>& candidates) const;

 private:
  const System& system_;
  const Options& options_;
  std::vector<std::size_t> allowed_, free_;
};

// The state of knowledge about one model: what structure its residuals still hold, and what free curves and dummies
// could repair.
struct Remainder {
  double global_p = 1;
  std::vector<LocatedCondition> conditions;  // the most telling first
  std::vector<Isolability> isolability;
  std::vector<Hypothesis> curves, dummies;  // largest gain first
  double false_alarm = 0;                   // share of dummies that would have been named
};
Remainder remainder(const Race& race, const Model& model, const Options& options);

struct Selection {
  Model base, model;
  Remainder before, after;
  std::vector<Hypothesis> scoreboard;
  std::vector<std::vector<std::size_t>> not_told_apart;
};
// `mismatch_p`: of the null test on the base model; above the level nothing is added to it.
Selection select(const Race& race, const Options& options, const std::vector<double>& start, double mismatch_p);

}  // namespace gonio::explain
