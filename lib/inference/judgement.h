// The last judgement: null, named, ambiguous or unknown.
//
// "Unknown" competes too. A mechanism is not the physics that was left out where
// - structure that matters remains over its own conditions, more than a small share of what it repaired: it imitates;
// - a free curve over one condition repairs clearly more on unseen groups than it does;
// - more remains anywhere than it repaired; or
// - the groups that were never opened are not the better for it.
#pragma once
#include "inference/race.h"

namespace gonio::inference {

// What speaks against the selection's model while others could take its place: one of the first three; empty: nothing.
// The groups that were never opened are not asked. Stricter than judge(), which asks once no other is left, about
// structure over a mechanism's own condition: a right law in another form may stand where nothing does better.
std::string objection(const Problem& problem, const Selection& selection, const Options& options);

// Fills the verdict, `named`, `not_told_apart`, `significant`, `important` and the beginning of `outside`. The held-out
// scores must be there already. Marks what only imitates in the scoreboard.
void judge(const Problem& problem, Selection& selection, const Options& options, Explanation& e);

}  // namespace gonio::inference
