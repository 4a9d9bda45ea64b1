// Periodic laws: direction * A cos(2 pi x / P - phase), a ripple, rings, a beat. Private to the law.
//
// The period is sought among all that the range holds at least three of, by least squares beside the free parameters
// (Lomb, Astrophys. Space Sci. 39, 1976; Scargle, Astrophys. J. 263, 1982), four steps to the frequency that the range
// resolves, and then ever finer. Fewer than three periods are a bend like any other.
#pragma once
#include <functional>
#include <vector>

#include "inference/law_data.h"
#include "inference/law_terms.h"

namespace gonio::inference {

// A cosine and a sine with one scale, the period over 2 pi; no terms where no period is significant at `level` among
// all that were looked at.
struct Wave {
  std::vector<Term> terms;
  double fall = 0;  // of chi-square, that it brings on all rows
  // The same wave with the period that the rows of a mask want, near the one of all rows: what is judged elsewhere has
  // no part in it.
  std::function<std::vector<Term>(const Mask&)> tuned;
};
Wave find_wave(const LawData& data, const std::vector<std::size_t>& conditions, double level);

}  // namespace gonio::inference
