// See signed_rank.h.
#include "stats/signed_rank.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stats/distributions.h"

namespace gonio::stats {

double signed_rank_upper(std::span<const double> differences, std::size_t least) {
  std::vector<double> d;
  for (const double v : differences)
    if (v != 0) d.push_back(v);
  if (d.size() < least) return 1;
  std::ranges::sort(d, {}, [](double v) { return std::abs(v); });
  double sum = 0, squares = 0;
  for (std::size_t first = 0, last; first < d.size(); first = last) {
    last = first + 1;
    while (last < d.size() && std::abs(d[last]) == std::abs(d[first])) ++last;
    const double rank = 0.5 * static_cast<double>(first + 1 + last);
    for (std::size_t k = first; k < last; ++k) sum += std::copysign(rank, d[k]), squares += rank * rank;
  }
  return normal_upper(sum / std::sqrt(squares));
}

}  // namespace gonio::stats
