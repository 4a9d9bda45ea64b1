// Wilcoxon's signed-rank test (Biometrics Bulletin 1, 1945): are differences symmetric about zero?
//   z = sum over i of sign(d_i) rank(|d_i|) / sqrt(sum of rank^2)
// is standard normal under that hypothesis, whatever law their sizes have: a few that are huge weigh no more than their
// ranks. Differences of zero are left out; equal sizes share the mean of their ranks.
#pragma once
#include <span>

namespace gonio::stats {

// P-value of "no tendency to be positive", one-sided, by the normal law: to a few per cent of itself from twenty
// differences on; 1 where there are fewer than `least`.
double signed_rank_upper(std::span<const double> differences, std::size_t least = 20);

}  // namespace gonio::stats
