// A null distribution without a noise model: under "no effect" the contribution of every block to a score is as likely
// as its negative, so flipping the signs of whole blocks at random draws from the null (Wu 1986, wild bootstrap;
// Hemerik, Goeman & Finos 2020 for the score test). Correlation inside a block is kept, because a block flips as one.
//
// A family is a set of directions that are tested together (the parameters of one mechanism, the knots of one curve).
// Its statistic is the squared length of the summed contributions, standardised by their own covariance, turned into a
// p-value by the chi-square law. All families are flipped with the same signs, and the smallest p of each draw
// calibrates the smallest p observed: looks at many correlated families cost no more than they must (Westfall & Young
// 1993).
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gonio::stats {

struct ScoreFamily {
  std::size_t directions = 0;
  std::vector<double> contributions;  // blocks x directions, row-major: what each block adds to each score
};
struct SignFlipResult {
  std::vector<double> statistic;  // one per family, chi-square with `rank` degrees under the null
  std::vector<std::size_t> rank;
  std::vector<double> p;           // per family, uncorrected, from the chi-square law
  std::vector<double> adjusted_p;  // per family, corrected for all looks by the flips
  double global_p = 1;             // of the smallest p
};

// `inflation` >= 1 widens the null for residuals that a fit has shortened (rows / degrees of freedom).
SignFlipResult sign_flip_test(const std::vector<ScoreFamily>& families, std::size_t blocks, double inflation, int draws,
                              std::uint64_t seed);

}  // namespace gonio::stats
