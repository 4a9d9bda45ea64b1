// What a set of directions can tell of a model's numbers, whatever is measured there.
//
// A number is told by what the slopes of the fit's other numbers leave of its own. With columns J of slopes on the
// scale of the fit, P the projection on the others,
//   share = |(1 - P) j| / |j|
// at the points where fits begin; the largest counts. A number without any slope has none. Told is a share of 1e-3 or
// more. Of a direction of the sample (anisotropy and its axis) limits.h asks for more: no lobe is exactly what a model
// says, and a fit that may turn its facets takes that for a direction.
#pragma once
#include <string>
#include <vector>

#include "goniometry/fit/fit_problem.h"

namespace gonio::goniometry {

struct Telling {
  std::string number;  // of the model's parameter
  double share = 0;
};
// Of each number that the candidate's variant frees (a second lobe, light sent back, a direction, a rough base).
std::vector<Telling> telling(const Problem& problem, const Candidate& candidate,
                             const std::vector<std::vector<double>>& points);
// The numbers among them that these directions do not tell, and what to measure, as a reason not to offer the
// candidate; empty: all are told.
std::string untold_numbers(const std::vector<Telling>& telling);
// Why no surface with a direction is offered: told_direction() is too small.
std::string untold_direction(const Samples& samples);

}  // namespace gonio::goniometry
