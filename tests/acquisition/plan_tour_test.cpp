// Tours among clusters: exact along an order, close to the best where all orders can be tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ranges>

#include "acquisition/plan/tour.h"
#include "base/random.h"
#include "geom/vector.h"

namespace gonio::acquisition {
namespace {

struct Points {
  Clusters clusters;
  std::vector<Vec2> at;
  TourCost cost() const {
    return [this](std::size_t a, std::size_t b) {
      const Vec2 home{0, 0};
      return norm((a == tour_home ? home : at[a]) - (b == tour_home ? home : at[b]));
    };
  }
};

Points random_points(std::size_t clusters, std::size_t candidates, std::uint64_t seed) {
  Random random(seed);
  Points points;
  points.clusters.first = {0};
  for (std::size_t c = 0; c < clusters; ++c) {
    for (std::size_t k = 0; k < candidates; ++k) points.at.push_back({random.uniform(), random.uniform()});
    points.clusters.first.push_back(points.at.size());
  }
  return points;
}

double least_of_all(const Points& points) {
  std::vector<std::size_t> order(points.clusters.count());
  std::iota(order.begin(), order.end(), 0);
  double least = 1e300;
  do least = std::min(least, tour_cost(choose_along(points.clusters, order, points.cost()), points.cost()));
  while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(Tour, CandidatesAlongAnOrderAreTheBest) {
  const Points points = random_points(4, 3, 5);
  const std::vector<std::size_t> order{2, 0, 3, 1};
  double least = 1e300;
  for (std::size_t k = 0; k < 81; ++k) {
    const std::vector<std::size_t> chosen{6 + k % 3, k / 3 % 3, 9 + k / 9 % 3, 3 + k / 27};
    least = std::min(least, tour_cost(chosen, points.cost()));
  }
  EXPECT_NEAR(tour_cost(choose_along(points.clusters, order, points.cost()), points.cost()), least, 1e-12);
}

TEST(Tour, FindsTheShortestOfSevenClusters) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Points points = random_points(7, 3, seed);
    const auto tour = shortest_tour(points.clusters, points.cost(), {.seed = 1, .rounds = 300});
    EXPECT_LT(tour_cost(tour, points.cost()), least_of_all(points) * 1.001) << seed;
  }
}

// Every cluster once; within what is known of random points: the shortest tour through n of them in a unit square is
// 0.7124 sqrt(n) + 0.33 or so (Johnson & McGeoch 1996); a tenth above it is allowed. Walls are avoided.
TEST(Tour, VisitsEveryClusterOnceAndIsShort) {
  const Points points = random_points(200, 1, 9);
  const TourOptions options{.seed = 1, .rounds = 1500};
  const auto tour = shortest_tour(points.clusters, points.cost(), options);
  std::vector<std::size_t> seen = tour;
  std::ranges::sort(seen);
  EXPECT_TRUE(std::ranges::equal(seen, points.clusters.first | std::views::take(200)));
  EXPECT_LT(tour_cost(tour, points.cost()), 1.1 * (0.7124 * std::sqrt(200.0) + 0.33));
  EXPECT_EQ(tour, shortest_tour(points.clusters, points.cost(), options));
  const TourCost walled = [&](std::size_t a, std::size_t b) {
    const bool left = a == tour_home || points.at[a].x < 0.5, left_too = b == tour_home || points.at[b].x < 0.5;
    return points.cost()(a, b) + (left == left_too ? 0 : 1e6);
  };
  EXPECT_LT(tour_cost(shortest_tour(points.clusters, walled, options), walled), 2.1e6);
}

}  // namespace
}  // namespace gonio::acquisition
