// Beyond the library: a sparse law over known conditions for the structure that no mechanism repairs.
//
// Candidate terms are direction * product of conditions^powers (one or two conditions, small rational powers),
// exp(-x/L) with a length L to be fitted, sines and cosines of angles, and one wave whose period is fitted
// (law_wave.h); a coefficient carries the unit that makes its term a residual, so that every law is dimensionally
// sound. Sparse regression in the manner of SINDy (Brunton, Proctor & Kutz, PNAS 113, 2016) for what a model leaves
// over (Kaheman et al. 2019; Ebers, Steele & Kutz 2024), but by forward selection with exchange, on columns from which
// all that the free parameters could absorb has been projected out, and with a price for every coefficient, second
// condition and odd power (Schwarz, Ann. Stat. 6, 1978).
//
// A law is kept only if it extrapolates: fitted where its condition is small it must repair what lies beyond, and the
// reverse, by at least half of what a fit in that place would repair, beyond two standard errors over blocks, and more
// than a free curve that continues with its last value; and it must lower the score of held-out groups. On the judged
// side the free parameters are refitted, since what they absorb is no evidence for or against anything.
#pragma once
#include "inference/explanation.h"
#include "inference/system.h"

namespace gonio::inference {

// Completes `e.outside` (which names the condition that carries most of the structure left): the law and how far it
// extrapolates, or no terms.
void find_law(const System& system, Explanation& e);

}  // namespace gonio::inference
