// Straight lines in joint space, looked at.
#pragma once
#include <string>

#include "acquisition/motion/way.h"

namespace gonio::acquisition {

// From `from` (0) to `to` (1), every joint in proportion; names every arm of the laboratory.
State between(const Laboratory& laboratory, const State& from, const State& to, double t);
// The largest turn of any joint.
double largest_turn(const Laboratory& laboratory, const State& from, const State& to);

double smallest_singular(const Laboratory& laboratory, const State& state);  // infinite: no arm of six joints
// Of one state, but for clearance: the limit that is broken, in words; empty: none.
std::string broken_at(const Laboratory& laboratory, const State& state, double singular_m);

}  // namespace gonio::acquisition
