// What full pixels gave their neighbours in a stack of exposures (sensor.blooming).
//
// Readings beside clipped pixels count for nothing else (stack_input.h). Here each is held against its own radiance,
// which pictures show in which nothing around it is clipped, and against what its four neighbours gathered beyond full
// scale, which shorter exposures tell. What the camera's response, a shutter or a lamp does to readings of one
// brightness is the same away from clipped pixels: it is taken off, as the median there, picture by picture, and its
// scatter is the noise. Along the column, as along the row, what flows over comes from both sides: pictures that do not
// lie on each other give to one side what they take from the other, and are no blooming. Errors count tiles of
// 16 pixels as independent, over all pictures, not readings (sandwich), and those of the medians.
#pragma once
#include <string>

#include "explain/engine.h"
#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

struct Overflow {
  double along = 0, across = 0;  // share that each neighbour in the column, in the row gets
  double sigma_along = 0, sigma_across = 0;
  double full_scale = 0;         // linear reading from which on it flows
  std::size_t readings = 0;      // that were looked at
  double p = 1;                  // chance of so much without blooming
  double with = 0, without = 0;  // relative RMSE of these readings in parts of the pictures that were not fitted,
                                 // before and after
  double repaired = 0;  // of what these readings depart by beyond the noise, in squares: 1 where the law is this one
  double effect = 0;    // root mean square of what flowed over that of all readings
  bool found() const { return p < 1; }
};

// Nothing is found where fewer than 200 readings can be held against their radiance, or at p > 1e-4.
Overflow find_overflow(const Stack& stack, const ReadingNoise& noise);
// Into a finished explanation: its numbers, and its name where it matters.
void conclude_overflow(const Problem& problem, const Overflow& overflow, std::size_t candidate, Explanation& e);
std::string overflow_remark(const Overflow& overflow);

}  // namespace gonio::explain::stacks
