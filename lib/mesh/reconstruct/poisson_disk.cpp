#include "mesh/reconstruct/poisson_disk.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"

namespace gonio::mesh {
namespace {

std::vector<std::uint32_t> thrown(const PointTree& tree, const std::vector<std::uint32_t>& order, double distance) {
  std::vector<char> taken(tree.size(), 0);
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t i : order) {
    if (taken[i]) continue;
    kept.push_back(i);
    tree.within(tree[i], distance, [&](std::uint32_t j) { taken[j] = 1; });
  }
  std::ranges::sort(kept);
  return kept;
}

}  // namespace

std::vector<std::uint32_t> poisson_disk(const PointTree& tree, std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(tree.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  if (order.size() <= count) return order;
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  // On a surface the number that stays falls with the square of the distance: a secant in logarithms.
  std::vector<double> spacing;
  std::vector<PointTree::Neighbour> near;
  for (std::size_t i = 0; i < std::min<std::size_t>(1000, order.size()); ++i) {
    tree.nearest(tree[order[i]], 7, near);
    spacing.push_back(std::sqrt(near.back().squared));
  }
  std::ranges::nth_element(spacing, spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2));
  double distance = 0.6 * std::max(spacing[spacing.size() / 2], 1e-12) *
                    std::sqrt(static_cast<double>(order.size()) / static_cast<double>(count));
  std::vector<std::uint32_t> best;
  const auto off = [&](const std::vector<std::uint32_t>& kept) {
    return std::abs(static_cast<double>(kept.size()) / static_cast<double>(count) - 1);
  };
  for (int round = 0; round < 8; ++round) {
    std::vector<std::uint32_t> kept = thrown(tree, order, distance);
    const double ratio = static_cast<double>(kept.size()) / static_cast<double>(count);
    if (best.empty() || off(kept) < off(best)) best = std::move(kept);
    if (off(best) < 0.02) break;
    distance *= std::sqrt(ratio);
  }
  return best;
}

}  // namespace gonio::mesh
