// See signed_rank.h.
#include "stats/signed_rank.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "stats/distributions.h"

namespace gonio::stats {

namespace {

constexpr std::size_t exact_to = 24;

// P(W >= w) over all signs, of doubled ranks: those of equal sizes are then whole numbers, too.
double exact_upper(const std::vector<std::size_t>& doubled, std::size_t w) {
  std::vector<double> chance{1};  // of every sum
  for (const std::size_t rank : doubled) {
    std::vector<double> next(chance.size() + rank);
    for (std::size_t sum = 0; sum < chance.size(); ++sum)
      next[sum] += 0.5 * chance[sum], next[sum + rank] += 0.5 * chance[sum];
    chance = std::move(next);
  }
  double upper = 0;
  for (std::size_t sum = w; sum < chance.size(); ++sum) upper += chance[sum];
  return upper;
}

}  // namespace

double signed_rank_upper(std::span<const double> differences, std::size_t least) {
  std::vector<double> d;
  for (const double v : differences) {
    if (!std::isfinite(v)) return 1;
    if (v != 0) d.push_back(v);
  }
  if (d.empty() || d.size() < least) return 1;
  std::ranges::sort(d, {}, [](double v) { return std::abs(v); });
  std::vector<std::size_t> doubled;
  std::size_t positive = 0;
  for (std::size_t first = 0, last; first < d.size(); first = last) {
    last = first + 1;
    while (last < d.size() && std::abs(d[last]) == std::abs(d[first])) ++last;
    for (std::size_t k = first; k < last; ++k) {
      doubled.push_back(first + 1 + last);
      if (d[k] > 0) positive += doubled.back();
    }
  }
  if (d.size() <= exact_to) return exact_upper(doubled, positive);
  double sum = 0, squares = 0;
  for (const std::size_t rank : doubled)
    sum += static_cast<double>(rank), squares += static_cast<double>(rank) * static_cast<double>(rank);
  return normal_upper((2 * static_cast<double>(positive) - sum) / std::sqrt(squares));
}

}  // namespace gonio::stats
