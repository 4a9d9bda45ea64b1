// Wilcoxon's signed-rank test (Biometrics Bulletin 1, 1945): are differences symmetric about zero?
//   W = sum of rank(|d_i|) over the positive d_i
// whose law under that hypothesis, every sign as likely as the other, does not depend on how large they are: a few that
// are huge weigh no more than their ranks. Differences of zero are left out; equal sizes share the mean of their ranks.
#pragma once
#include <span>

namespace gonio::stats {

// P-value of "no tendency to be positive", one-sided: exact up to 24 differences, by the normal law beyond (to a few
// per cent of itself); 1 where there are fewer than `least`, or one is no finite number.
double signed_rank_upper(std::span<const double> differences, std::size_t least = 20);

}  // namespace gonio::stats
