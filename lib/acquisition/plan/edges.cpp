#include "acquisition/plan/edges.h"

#include <algorithm>
#include <cmath>

#include "acquisition/motion/line.h"
#include "base/parallel.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

// What a detour is feared to cost on top of the line until it is searched: about a stop on the way.
constexpr double feared_detour_s = 1;
constexpr double straight_deviation_m = 5e-5;  // half of what is promised
constexpr int straight_attempts = 6;
constexpr int middle_draws = 48, middle_enough = 3;
// A joint that turns by more than a quarter turn between two views drags its cable along: what it turns beyond costs as
// if it took so much longer, so that it happens where nothing else does.
constexpr double ample_turn_rad = pi / 2, ample_s_per_rad = 1;

Way turned_round(Way way) {
  std::ranges::reverse(way);
  return way;
}

}  // namespace

PlanEdges::PlanEdges(const Laboratory& laboratory, const Surroundings& surroundings,
                     const Configurations& configurations, std::vector<PlanCandidate> candidates, std::uint64_t seed)
    : laboratory_(laboratory),
      surroundings_(surroundings),
      configurations_(configurations),
      candidates_(std::move(candidates)),
      home_{configurations.placed(configurations.home()), tour_home, 0, {}},
      seed_(seed),
      touched_(candidates_.size() + 1) {}

const PlanCandidate& PlanEdges::candidate(std::size_t number) const {
  return number == tour_home ? home_ : candidates_[number];
}
State PlanEdges::state(std::size_t number) const {
  return configurations_.state(candidate(number).at.joints);
}
PlanEdges::Key PlanEdges::stations(Key key) const {
  const std::size_t a = candidate(key.first).station, b = candidate(key.second).station;
  return {std::min(a, b), std::max(a, b)};
}

double PlanEdges::base(std::size_t from, std::size_t to) const {
  // A turntable of unknown speed: 0.2 rad/s, which matters for the order alone.
  const PlanCandidate &a = candidate(from), &b = candidate(to);
  const double turn = configurations_.largest_turn(a.at, b.at);
  return std::max(configurations_.time(a.at, b.at), std::abs(a.table_rad - b.table_rad) / 0.2) +
         ample_s_per_rad * std::max(0.0, turn - ample_turn_rad);
}

double PlanEdges::cost(std::size_t from, std::size_t to) const {
  if (from == to) return 0;
  if ((from == tour_home || touched_[from]) && (to == tour_home || touched_[to])) {
    const auto at = costs_s_.find(number({std::min(from, to), std::max(from, to)}));
    if (at != costs_s_.end()) return at->second;
  }
  return base(from, to);
}

bool PlanEdges::wants_straight(Key key) const {
  const PlanCandidate &a = candidate(key.first), &b = candidate(key.second);
  if (a.straight_arm.empty() || a.straight_arm != b.straight_arm || a.station == b.station) return false;
  const auto failures = straight_failures_.find(stations(key));
  return failures == straight_failures_.end() || failures->second < straight_attempts;
}

// The camera's arm on a line; the other arms in proportion beside it. It must end in the very candidate.
bool PlanEdges::straight(Key key, Edge& edge) const {
  const std::string& arm = candidate(key.first).straight_arm;
  const State from = state(key.first), to = state(key.second);
  const auto goal = world_from_tool(laboratory_.arms.at(arm), to.at(arm));
  std::string why;
  auto way = straight_way(laboratory_, from, arm, goal, straight_deviation_m, &why);
  if (!way || way->empty()) return false;
  for (std::size_t j = 0; j < to.at(arm).size(); ++j)
    if (std::abs(way->back().at(arm)[j] - to.at(arm)[j]) > 1e-6) return false;
  for (std::size_t k = 0; k < way->size(); ++k) {
    const double share = way->size() > 1 ? static_cast<double>(k) / static_cast<double>(way->size() - 1) : 1;
    for (auto& [name, joints] : (*way)[k])
      if (name != arm)
        for (std::size_t j = 0; j < joints.size(); ++j)
          joints[j] = from.at(name)[j] + share * (to.at(name)[j] - from.at(name)[j]);
  }
  way->back() = to;
  edge.way = {*way, judge(laboratory_, surroundings_, *way, walking_step_m), true, {}};
  return edge.way.figures.fault.empty();
}

PlanEdges::Edge PlanEdges::walked_line(Key key) const {
  Edge edge;
  if (wants_straight(key)) {
    if (straight(key, edge)) {
      edge.known = Edge::Known::open, edge.cost_s = edge.way.figures.duration_s;
      return edge;
    }
    // Other candidates may go straight; if none does, these may go otherwise.
    edge.cost_s = base(key.first, key.second) + feared_detour_s;
    return edge;
  }
  edge.way.states = {state(key.first), state(key.second)};
  edge.way.figures = judge(laboratory_, surroundings_, edge.way.states, walking_step_m);
  edge.cost_s = std::max(edge.way.figures.duration_s, base(key.first, key.second));
  if (edge.way.figures.fault.empty())
    edge.known = Edge::Known::open;
  else
    edge.cost_s += feared_detour_s;
  return edge;
}

// Through a state near the middle of the line, drawn wider and wider about it: what a line misses by little is gone
// round so at a tenth of a search's cost. The fastest of the first that are open.
Way PlanEdges::round_the_middle(const State& from, const State& to, std::uint64_t stream) const {
  Random random(seed_, stream);
  const State middle = between(laboratory_, from, to, 0.5);
  Way best;
  double least = closed_s;
  int found = 0;
  for (int k = 0; k < middle_draws && found < middle_enough; ++k) {
    State via = middle;
    for (auto& [name, joints] : via)
      for (double& q : joints) q += 0.04 * (1 + k / 8) * random.normal();
    const Way way{from, via, to};
    const double time = way_time(laboratory_, way);
    if (time >= least || !open_line(laboratory_, surroundings_, from, via) ||
        !open_line(laboratory_, surroundings_, via, to))
      continue;
    best = way, least = time, ++found;
  }
  return best;
}

PlanEdges::Edge PlanEdges::detour(Key key) const {
  Edge best;
  best.known = Edge::Known::closed, best.cost_s = closed_s;
  const State from = state(key.first), to = state(key.second);
  const double least = base(key.first, key.second);
  const auto attempt = [&](Way way) {
    if (way.size() < 2) return;
    const WayFigures figures = judge(laboratory_, surroundings_, way, walking_step_m);
    if (best.way.fault.empty()) best.way.fault = figures.fault;
    if (!figures.fault.empty() || std::max(figures.duration_s, least) >= best.cost_s) return;
    best.known = Edge::Known::open, best.cost_s = std::max(figures.duration_s, least);
    best.way = {std::move(way), figures, false, {}};
  };
  attempt({from, to});
  if (best.known == Edge::Known::open) return best;
  for (const auto& [first, joints] : to) {  // one arm first, then the others
    if (to.size() < 2) break;
    State apart = from;
    apart[first] = joints;
    attempt({from, apart, to});
  }
  attempt(round_the_middle(from, to, key.first * candidates_.size() + key.second));
  if (best.known == Edge::Known::open) return best;
  if (const auto way = joint_way(laboratory_, surroundings_, from, to, seed_)) attempt(*way);
  if (best.known == Edge::Known::closed && best.way.fault.empty()) best.way.fault = "no way was found";
  return best;
}

bool PlanEdges::walk(const std::vector<std::size_t>& tour) {
  std::vector<Key> wanted;
  std::size_t before = tour_home;
  const auto want = [&](std::size_t to) {
    const Key key{std::min(before, to), std::max(before, to)};
    before = to;
    if (key.first == key.second) return;
    const auto at = edges_.find(key);
    if (at == edges_.end() || at->second.known == Edge::Known::line_fails) wanted.push_back(key);
  };
  for (const std::size_t c : tour) want(c);
  want(tour_home);
  std::ranges::sort(wanted);
  wanted.erase(std::ranges::unique(wanted).begin(), wanted.end());
  std::vector<Edge> found(wanted.size());
  parallel_for(0, wanted.size(), [&](std::size_t k) {
    found[k] = edges_.contains(wanted[k]) && !wants_straight(wanted[k]) ? detour(wanted[k]) : walked_line(wanted[k]);
  });
  bool open = true;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (found[k].known != Edge::Known::open && wants_straight(wanted[k])) ++straight_failures_[stations(wanted[k])];
    open = open && found[k].known == Edge::Known::open;
    for (const std::size_t c : {wanted[k].first, wanted[k].second})
      if (c != tour_home) touched_[c] = true;
    costs_s_[number(wanted[k])] = found[k].cost_s;
    edges_[wanted[k]] = std::move(found[k]);
  }
  // Edges that were closed before.
  before = tour_home;
  for (std::size_t k = 0; k <= tour.size(); ++k) {
    const std::size_t to = k < tour.size() ? tour[k] : tour_home;
    open = open && cost(before, to) < closed_s;
    before = to;
  }
  return open;
}

WalkedWay PlanEdges::way(std::size_t from, std::size_t to) const {
  if (from == to) return {{state(from)}, {}, false, {}};
  WalkedWay way = edges_.at({std::min(from, to), std::max(from, to)}).way;
  if (from > to) way.states = turned_round(std::move(way.states));
  return way;
}

}  // namespace gonio::acquisition
