// Held-out error: each fold is predicted by a fit that did not see it. Folds are whole series where there are four or
// more, dealt out by incidence, else blocks of neighbouring directions.
#pragma once
#include <vector>

#include "goniometry/fit/fit_problem.h"

namespace gonio::goniometry {

std::vector<Rows> folds_of(const Problem& problem, const std::vector<Rows>& blocks, int count);

struct Errors {  // sums of squares
  double scaled = 0, log1p = 0, decades = 0;
  std::size_t count = 0, bright = 0;  // bright: above zero
  std::vector<double> band_log1p;     // and per band
  std::vector<std::size_t> band_count;
  FitError rms() const;
  void add(const Errors& other);
};
Errors errors_of(const Problem& problem, const Candidate& candidate, const std::vector<double>& x, const Rows& rows);

// One per fold; fits begin at `solution`.
std::vector<Errors> held_out(const Problem& problem, const Candidate& candidate, const Solution& solution,
                             const std::vector<Rows>& folds);

// Excess of a's mean square over b's, with its standard error over folds.
struct Excess {
  double mean = 0, sigma = 0;
};
Excess excess(const std::vector<Errors>& a, const std::vector<Errors>& b);

}  // namespace gonio::goniometry
