// Which of the fits is the surface, and why the others are not.
//
// Refused are fits that no start brought to an end, that return more light than arrives, or whose lobe is narrower than
// the directions tell. Of two whose predictions differ by less than a hundredth of what either errs, the one with more
// numbers says nothing new: it is the same as the other.
// Chosen is the fit of fewest numbers whose held-out mean square exceeds the least one by no more than
//   max(one standard error of the difference over folds (Breiman et al. 1984, section 3.4.3), material_gain of it)
// material_gain: the error of a surface is stated, like every uncertainty, in two digits at most (GUM, JCGM 100:2008,
// 7.2.6); one unit of the second one is a hundredth or more of the rms, two hundredths of the mean square. What gains
// less cannot be seen in the error that is stated, nor in a picture: predictions whose mean square gains a share q
// differ by sqrt(q) of what both err, a seventh. Where samples state their noise and the best fit errs by no more than
// that, what is gained is not an error of the model's, and there is no such limit.
// In either case a variant's own numbers (a second lobe's share, a direction, ...) have to be told from their neutral
// value: at least one 95 % interval, Bonferroni's where they are two, leaves it out.
#pragma once
#include <string>
#include <vector>

#include "goniometry/fit/fit_problem.h"
#include "goniometry/fit/selection.h"

namespace gonio::goniometry {

inline constexpr double alike = 1e-4;          // of the mean square: what rounding and steps decide
inline constexpr double material_gain = 0.02;  // of the held-out mean square

struct Run {  // of one candidate
  Candidate candidate;
  Solution solution;
  std::vector<Errors> folds;
  Fit fit;
};

// "glossy (two lobes)"
std::string name_of(const Fit& fit);
// Of what the variant frees, is anything told from the value at which it vanishes? A plain fit: yes.
bool tells_its_variant(const Run& run);
// Moves the fits into out.candidates, by held-out error, and says of each why it is not the chosen one.
void choose(const Problem& problem, std::vector<Run> runs, double least_alpha, const FitOptions& options, Fits& out);

}  // namespace gonio::goniometry
