// How sure a fit's numbers are.
//
// With s^2 = sum r^2 / (n - p) the mean square of what is left (1 at least where samples state their noise),
//   C = s^2 H^-1
// holds where residuals are independent. Blocks of neighbouring samples test that: with M the sum over blocks of u u',
// u = J'(I - H_b)^-1/2 r the score of a block freed of its own pull (Bell & McCaffrey 2002), the variance of a number
// is that of H^-1 M H^-1 with Student's t of d degrees, d by Satterthwaite from what each block brings, wherever it
// exceeds s^2 H^-1 by more than the 95 % point of chi^2_d / d: one look in twenty at independent noise widens an
// interval that needs it not.
#pragma once
#include "goniometry/fit/fit_problem.h"

namespace gonio::goniometry {

// Blocks of neighbouring samples: series cut across the long axis of their directions into some twenty in all.
std::vector<Rows> blocks_of(const Problem& problem);

// Fills numbers, covariance.
void state_uncertainty(const Problem& problem, const Candidate& candidate, const Solution& solution,
                       const std::vector<Rows>& blocks, Fit& fit);

}  // namespace gonio::goniometry
