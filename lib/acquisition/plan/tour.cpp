#include "acquisition/plan/tour.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"

namespace gonio::acquisition {
namespace {

constexpr std::size_t neighbour_count = 10, largest_ruin = 10;

struct TourSearch {
  const Clusters& clusters;
  const TourCost& cost;
  std::vector<std::size_t> tour;                     // candidates in order
  std::vector<std::size_t> cluster;                  // of each candidate
  std::vector<std::vector<std::size_t>> neighbours;  // of each cluster, nearest first

  TourSearch(const Clusters& c, const TourCost& f) : clusters(c), cost(f), cluster(c.first.back()) {
    for (std::size_t k = 0; k < c.count(); ++k)
      for (std::size_t i = c.first[k]; i < c.first[k + 1]; ++i) cluster[i] = k;
  }

  void nearest_next() {
    std::vector<std::size_t> left(clusters.count());
    std::iota(left.begin(), left.end(), 0);
    tour.clear();
    while (!left.empty()) {
      const std::size_t from = tour.empty() ? tour_home : tour.back();
      std::size_t best = 0, best_candidate = clusters.first[left[0]];
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < left.size(); ++k)
        for (std::size_t i = clusters.first[left[k]]; i < clusters.first[left[k] + 1]; ++i) {
          const double c = cost(from, i);
          if (c < least) least = c, best = k, best_candidate = i;
        }
      tour.push_back(best_candidate);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
  }

  std::size_t at(std::size_t place) const { return place < tour.size() ? tour[place] : tour_home; }
  std::size_t before(std::size_t place) const { return place == 0 ? tour_home : tour[place - 1]; }
  std::vector<std::size_t> places() const {
    std::vector<std::size_t> place(clusters.count(), tour_home);
    for (std::size_t p = 0; p < tour.size(); ++p) place[cluster[tour[p]]] = p;
    return place;
  }

  // By what is chosen now.
  void find_neighbours() {
    neighbours.assign(clusters.count(), {});
    std::vector<std::pair<double, std::size_t>> others;
    for (const std::size_t i : tour) {
      others.clear();
      for (const std::size_t j : tour)
        if (j != i) others.emplace_back(cost(i, j), cluster[j]);
      const std::size_t n = std::min(neighbour_count, others.size());
      std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(n), others.end());
      for (std::size_t k = 0; k < n; ++k) neighbours[cluster[i]].push_back(others[k].second);
    }
  }

  // Reverses pieces as long as that helps: the edges (a, a+1) and (b, b+1) become (a, b) and (a+1, b+1).
  void two_opt() {
    std::vector<std::size_t> place = places();
    bool better = true;
    for (int sweep = 0; better && sweep < 50; ++sweep) {
      better = false;
      for (std::size_t c = 0; c < clusters.count(); ++c)
        for (const std::size_t d : neighbours[c]) {
          for (const bool after : {true, false}) {
            // The piece to reverse: from behind a to b, or from a to before b.
            std::size_t a = std::min(place[c], place[d]), b = std::max(place[c], place[d]);
            if (after)
              ++a;
            else if (b > 0)
              --b;
            if (a >= b) continue;
            const double now = cost(before(a), tour[a]) + cost(tour[b], at(b + 1));
            const double then = cost(before(a), tour[b]) + cost(tour[a], at(b + 1));
            if (!(then < now - 1e-9)) continue;
            std::reverse(tour.begin() + static_cast<std::ptrdiff_t>(a),
                         tour.begin() + static_cast<std::ptrdiff_t>(b) + 1);
            for (std::size_t p = a; p <= b; ++p) place[cluster[tour[p]]] = p;
            better = true;
          }
        }
    }
  }

  void choose() {
    std::vector<std::size_t> order;
    for (const std::size_t i : tour) order.push_back(cluster[i]);
    tour = choose_along(clusters, order, cost);
  }

  void insert_cheapest(std::size_t c) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t where = tour.size(), which = clusters.first[c];
    const auto attempt = [&](std::size_t p) {
      const double gap = cost(before(p), at(p));
      for (std::size_t i = clusters.first[c]; i < clusters.first[c + 1]; ++i) {
        const double more = cost(before(p), i) + cost(i, at(p)) - (std::isfinite(gap) ? gap : 0);
        if (more < least) least = more, where = p, which = i;
      }
    };
    const std::vector<std::size_t> place = places();
    for (const std::size_t d : neighbours[c])
      if (place[d] != tour_home) attempt(place[d]), attempt(place[d] + 1);
    attempt(0), attempt(tour.size());
    tour.insert(tour.begin() + static_cast<std::ptrdiff_t>(where), which);
  }

  // Takes out some neighbours of one cluster, or a piece of the tour, and puts them back.
  void ruin_and_recreate(Random& random) {
    const auto n = static_cast<std::uint32_t>(tour.size());
    const std::size_t size = std::min<std::size_t>(2 + random.below(largest_ruin - 1), n);
    std::vector<std::size_t> out;
    const std::size_t p = random.below(n);
    if (random.below(2) == 0) {
      out.push_back(cluster[tour[p]]);
      for (const std::size_t d : neighbours[out[0]])
        if (out.size() < size) out.push_back(d);
    } else {
      for (std::size_t k = p; k < std::min<std::size_t>(p + size, n); ++k) out.push_back(cluster[tour[k]]);
    }
    std::erase_if(tour, [&](std::size_t i) { return std::ranges::find(out, cluster[i]) != out.end(); });
    for (std::size_t k = out.size(); k > 1; --k)
      std::swap(out[k - 1], out[random.below(static_cast<std::uint32_t>(k))]);
    for (const std::size_t c : out) insert_cheapest(c);
  }
};

}  // namespace

std::size_t Clusters::of(std::size_t candidate) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(first, candidate) - first.begin()) - 1;
}

double tour_cost(std::span<const std::size_t> candidates, const TourCost& cost) {
  if (candidates.empty()) return 0;
  double sum = cost(tour_home, candidates.front()) + cost(candidates.back(), tour_home);
  for (std::size_t k = 1; k < candidates.size(); ++k) sum += cost(candidates[k - 1], candidates[k]);
  return sum;
}

std::vector<std::size_t> choose_along(const Clusters& clusters, std::span<const std::size_t> order,
                                      const TourCost& cost) {
  if (order.empty()) return {};
  std::vector<std::vector<std::size_t>> came_from(order.size());
  std::vector<double> least, next;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t first = clusters.first[order[k]], count = clusters.first[order[k] + 1] - first;
    came_from[k].assign(count, 0), next.assign(count, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      if (k == 0) {
        next[i] = cost(tour_home, first + i);
        continue;
      }
      const std::size_t earlier = clusters.first[order[k - 1]];
      for (std::size_t j = 0; j < least.size(); ++j) {
        if (!(least[j] < next[i])) continue;  // costs are not negative
        // A cluster that is met twice in a row stays where it is.
        const double c = least[j] + (earlier + j == first + i ? 0 : cost(earlier + j, first + i));
        if (c < next[i]) next[i] = c, came_from[k][i] = j;
      }
    }
    std::swap(least, next);
  }
  const std::size_t last = clusters.first[order.back()];
  std::size_t best = 0;
  double total = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < least.size(); ++i) {
    const double c = least[i] + cost(last + i, tour_home);
    if (c < total) total = c, best = i;
  }
  std::vector<std::size_t> chosen(order.size());
  for (std::size_t k = order.size(); k-- > 0;) {
    chosen[k] = clusters.first[order[k]] + best;
    best = came_from[k][best];
  }
  return chosen;
}

std::vector<std::size_t> shortest_tour(const Clusters& clusters, const TourCost& cost, const TourOptions& options) {
  TourSearch search(clusters, cost);
  if (clusters.count() == 0) return {};
  search.tour = options.start;
  if (search.tour.empty()) search.nearest_next();
  search.choose();
  search.find_neighbours();
  search.two_opt();
  search.choose();
  std::vector<std::size_t> best = search.tour;
  double best_cost = tour_cost(best, cost), now_cost = best_cost;
  Random random(options.seed, 0x70757);
  for (std::size_t round = 0; round < options.rounds && clusters.count() > 2; ++round) {
    if (round % 500 == 0) search.find_neighbours();
    const std::vector<std::size_t> now = search.tour;
    search.ruin_and_recreate(random);
    const double then = tour_cost(search.tour, cost);
    // Threshold falling to nothing: a tenth of a mean edge at first.
    const double patience = std::isfinite(now_cost)
                                ? 0.1 * now_cost / static_cast<double>(now.size()) *
                                      (1 - static_cast<double>(round) / static_cast<double>(options.rounds))
                                : 0;
    if (then < now_cost - patience * std::log(random.uniform())) {
      now_cost = then;
      if (then < best_cost) best_cost = then, best = search.tour;
    } else {
      search.tour = now;
    }
  }
  search.tour = best;
  search.find_neighbours();
  search.two_opt();
  search.choose();
  return tour_cost(search.tour, cost) < best_cost ? search.tour : best;
}

}  // namespace gonio::acquisition
