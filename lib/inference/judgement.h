// The last judgement: null, named, ambiguous or unknown, by the probabilities of the finalists (finalists.h).
//
// Rules that no probability mends are few: nothing is named without a significant mismatch, for what is smaller than
// what matters, for what ends at a bound, or where the groups that were never opened are not the better for it.
#pragma once
#include "inference/finalists.h"

namespace gonio::inference {

// Fills the verdict, `named`, `not_told_apart`, `instead`, `weighed`, `probability`, `significant`, `important` and the
// beginning of `outside`. The held-out scores must be there already. Says in the scoreboard why what was weighed and
// not named is less likely.
void judge(const Problem& problem, const Selection& selection, const Options& options, Explanation& e);

// Of mismatches that matter and that no set repairs, the share that the library does not have; the rest it has, and a
// simulation that errs, or the search, did not show it.
double share_outside(Simulator simulator);

}  // namespace gonio::inference
