// Structure in the product of two conditions: where the effect of one turns round with the other, a curve over either
// of them is flat and sees nothing.
//
// For each pair the column direction * u v, with u and v the conditions' ranks from -1 to 1, less what the free
// parameters imitate, is held against the residuals: T = (sum of scores of blocks)^2 / sum of their squares. Under the
// null every block's score has a sign of its own, and the tail of T is not heavier than that of chi-square with one
// degree, whatever the noise (Efron, J. Am. Stat. Assoc. 64, 1969).
#pragma once
#include <optional>

#include "inference/engine.h"
#include "inference/fit.h"

namespace gonio::inference {

struct Interaction {
  std::size_t first = 0, second = 0;  // conditions
  double p = 1;                       // among all pairs
  double power = 0;                   // mean square of the structure in noise units
  double effect = 0;                  // what --smallest-effect is held against
};
// The pair that tells most; nothing where there are no two conditions.
std::optional<Interaction> interaction(const System& system, const Fit& fit);

}  // namespace gonio::inference
