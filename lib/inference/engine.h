// The engine of `explain`: from a problem to an explanation, by the steps noise, fair refit, isolability, null test,
// location, naming on held-out groups, equivalents, final judgement on groups that were never opened.
//
// It knows no physics. Rules it keeps: nothing is named without a significant mismatch; nothing below
// `smallest_effect`; no name for what a negative control does as well, what sits at its bound, what helps no unseen
// group; equals are reported as equals.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "inference/explanation.h"

namespace gonio::inference {

struct Options {
  double smallest_effect = 0.01;        // smallest effect worth a name, see Importance
  double sure = 0.9;                    // probability that suffices to name one explanation alone
  double level = 0.01;                  // false alarms allowed to the null test, and to every name
  std::vector<std::string> hypotheses;  // mechanism ids to consider; empty: all candidates of the problem
  std::vector<std::string> protect;     // names of parameters, or of what stands before a '/', that keep their values
  int draws = 1999;                     // of the null distribution
  std::size_t negative_controls = 24;
  std::uint64_t seed = 1;
  double budget_s = 0;  // 0: none; see ProblemOptions::budget_s
};

// `left_out`: groups that count as not recorded, ascending.
Explanation explain(const Problem& problem, const Options& options, const std::vector<std::size_t>& left_out = {});

// The first steps alone, noise, fair refit and the null test, exactly as explain() takes them: the chance of such
// structure in the residuals of the base model where nothing was left out. A mismatch is there at the level alpha where
// it is at most alpha.
double null_test(const Problem& problem, const Options& options);

}  // namespace gonio::inference
