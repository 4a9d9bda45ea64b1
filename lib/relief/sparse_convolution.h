// The solid noise of Luongo et al. 2020, appendix A, to the bit: sparse convolution (Lewis 1984, 1989; Frisvad & Wyvill
// 2007) as a closed function, for patterns that are to be those that were published. What relief(1) makes is another
// one (relief/noise.h), whose cells do not recur.
//
// Impulse j = 1 ... N of the cell q has the seed n = 4 (N q.a + j), a = (1, 1000, 576), N = 30, of the generator
//   t <- (3125 t + 49) mod 65536,   rnd = t / 65536   (the appendix prints "mod n"),
// and takes four numbers of it in turn: its height, of alternating sign (negative where j is odd), and its place in the
// cell. With the filter cubic(v) = (1 - 4 v.v)^3 for v.v < 1/4,
//   noise(p) = 4 / (5 N^(1/3)) sum over the eight cells about p and their impulses of height cubic(place - p).
// Seeds of cells left of or below the origin are taken modulo 65536 as well, upwards.
// Seeds of neighbouring impulses are four apart and their numbers go together: the noise's standard deviation is 0.225,
// where independent impulses make 0.154; and cells recur. One cell further it goes with itself by 0.54, 0.46 and -0.58
// along x, y and z: a slice shows streaks along x. Read as places in one sequence from t = 0 (n the index, not the
// seed; four numbers an impulse) the same formula has a standard deviation of 0.148 and no such correlation: the text
// leaves open which is meant.
#pragma once
#include "geom/vector.h"

namespace gonio::relief {

double published_noise(Vec3 cells);
// As a grey value: A / 2 noise + 1/2, between 0 and 1. A: amplitude; `cells`: the place times B, the frequency.
double published_noise_grey(Vec3 cells, double amplitude);

}  // namespace gonio::relief
