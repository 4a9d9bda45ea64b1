// One recording that spoils the others: a frame whose tracks slipped, a view of another board. Left in, it bends every
// fit and every held-out score, and nothing passes.
//
// For each hypothesis by itself, and for none, all groups but one are fitted, each left out in turn. Where one group is
// the trouble, the sum of squares per row of the others falls when it goes, and with no other: it is named where the
// least sum is under a tenth of the median one, and the second least is not below half of it. (Deletion of a group at a
// time: Belsley, Kuh & Welsch, Regression Diagnostics, 1980, chapter 2, here with the cost instead of a coefficient.)
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace gonio::inference {

class Race;
class System;

// Are there five to forty groups, and would the fits take seconds only?
bool odd_group_can_be_asked(const System& system);
// Among the groups of the race's system.
std::optional<std::size_t> odd_group(const Race& race, const std::vector<double>& start);

}  // namespace gonio::inference
