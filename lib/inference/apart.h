// What a problem has tested on its own (Problem::tested_apart) joins a finished explanation.
#pragma once
#include "inference/explanation.h"
#include "inference/problem.h"

namespace gonio::inference {

struct Apart {
  std::size_t candidate = 0;
  std::vector<Estimate> estimates;
  double p = 1;                  // chance of what was found without any physics
  double effect = 0;             // as the problem's importance counts it
  double with = 0, without = 0;  // score of all observations, and without those that were set aside
  std::string refused{};         // why it is not named all the same
};
// Enters it on the scoreboard; names it, beside what is named already, where nothing refuses it and it matters.
void join(const Problem& problem, const Apart& apart, Explanation& explanation);

}  // namespace gonio::inference
