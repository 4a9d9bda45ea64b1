// A travelling salesman among clusters: one candidate of every cluster, in the order that costs least, from home and
// back to it. Candidates are the ways in which arms can take one view, clusters the views.
//
//   order        nearest candidate next; then 2-opt on what is chosen (Croes 1958), neighbours only
//   candidates   along a given order the best ones are exact, by dynamic programming (Viterbi 1967)
//   both         parts of the tour are taken out and every cluster put back at its cheapest place with its cheapest
//                candidate, longer tours being kept less and less often (ruin and recreate: Schrimpf et al. 2000)
//
// Costs are symmetric. The result depends on the seed alone, not on threads or time. No optimum is promised.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace gonio::acquisition {

inline constexpr std::size_t tour_home = std::numeric_limits<std::size_t>::max();
// Between two candidates by their numbers, or tour_home. Infinite ones are avoided where they can be.
using TourCost = std::function<double(std::size_t from, std::size_t to)>;

// Candidates are numbered through; those of cluster c are first[c] .. first[c + 1] - 1, at least one.
struct Clusters {
  std::vector<std::size_t> first;
  std::size_t count() const { return first.size() - 1; }
  std::size_t of(std::size_t candidate) const;
};

// The candidates that cost least along an order of clusters, which may hold a cluster more than once.
std::vector<std::size_t> choose_along(const Clusters& clusters, std::span<const std::size_t> order,
                                      const TourCost& cost);
double tour_cost(std::span<const std::size_t> candidates, const TourCost& cost);

struct TourOptions {
  std::uint64_t seed = 1;
  std::size_t rounds = 2000;       // of ruin and recreate
  std::vector<std::size_t> start;  // candidates in order, one a cluster: a tour that is known; empty: none
};
std::vector<std::size_t> shortest_tour(const Clusters& clusters, const TourCost& cost, const TourOptions& options);

}  // namespace gonio::acquisition
