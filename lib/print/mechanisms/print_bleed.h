// print.bleed: light that reaches neighbours, beside what is stated of it. How it spreads: print/bleed.h.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"
#include "print/bleed.h"

namespace gonio::mechanism {
const Mechanism& print_bleed();
}

namespace gonio::equation {

// One spread after the other: variances of cores add up. Of two tails the wider share is kept for both.
inline print::Bleed print_bleed(const print::Bleed& stated, double sigma_m, double tail_share, double tail_m) {
  if (sigma_m == 0 && tail_share == 0) return stated;
  print::Bleed all = stated;
  all.sigma_m = std::hypot(stated.sigma_m, sigma_m);
  all.tail_share = 1 - (1 - stated.tail_share) * (1 - tail_share);
  if (tail_share > stated.tail_share) all.tail_m = tail_m;
  return all;
}

}  // namespace gonio::equation
