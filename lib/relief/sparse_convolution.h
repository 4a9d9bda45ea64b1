// The solid noise of Luongo et al. 2020, appendix A: sparse convolution (Lewis 1984, 1989; Frisvad & Wyvill 2007) as a
// closed function, for patterns that are to be those that were published. What relief(1) makes is another one
// (relief/noise.h), whose cells do not recur.
//
// The generator  t_(k+1) = (3125 t_k + 49) mod 65536,  t_0 = 0,  rnd(t_k) = t_(k+1) / 65536  (the appendix prints
// "mod n") makes one sequence of period 65536. Impulse j = 1 ... N of the cell q begins at its place
//   n = 4 (N q.a + j),  a = (1, 1000, 576),  N = 30,
// and takes four numbers: its height, rnd(t_n), of alternating sign (negative where j is odd), and its place in the
// cell, rnd(t_(n+1)), rnd(t_(n+2)), rnd(t_(n+3)). With the filter cubic(v) = (1 - 4 v.v)^3 for v.v < 1/4,
//   noise(p) = 4 / (5 N^(1/3)) sum over the eight cells about p and their impulses of height cubic(place - p).
// Places left of or below the sequence's first are taken modulo 65536 as well, upwards.
//
// The appendix calls n a seed and uses it as an index. As an index (four numbers an impulse, hence the factor 4) the
// noise has a standard deviation of 0.148 and no direction. Were n the generator's state, impulses side by side would
// go together: a deviation of 0.225, correlations of 0.54, 0.46 and -0.58 one cell further along x, y, z, and streaks,
// where the paper shows and claims none. The text alone does not settle it.
#pragma once
#include "geom/vector.h"

namespace gonio::relief {

double published_noise(Vec3 cells);
// As a grey value: A / 2 noise + 1/2, between 0 and 1. A: amplitude; `cells`: the place times B, the frequency.
double published_noise_grey(Vec3 cells, double amplitude);
double published_noise_grey(double noise, double amplitude);

}  // namespace gonio::relief
