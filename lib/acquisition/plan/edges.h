// Ways between candidates of a plan, walked when a tour wants them and remembered.
//
// An edge is first the line in joint space, at the time that its joints need. Once walked it is that, or it costs what
// a detour may cost until a tour still wants it: then the arms are moved one after the other, and where that is not
// free either a way is searched for. What is not found is closed. Where the camera is to go straight, straightness
// comes first, and is given up for a pair of views after some pairs of their candidates failed.
#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "acquisition/motion/way.h"
#include "acquisition/plan/configurations.h"
#include "acquisition/plan/tour.h"

namespace gonio::acquisition {

// Ways are judged in steps of this: nothing on them is nearer than their clearance by more (motion/way.h).
inline constexpr double walking_step_m = 0.001;

struct PlanCandidate {
  Configurations::Placed at;
  std::size_t station = 0;
  double table_rad = 0;      // sum of what turntables have turned
  std::string straight_arm;  // that goes straight to and from other candidates of the same arm; or empty
};
struct WalkedWay {
  Way states;  // both ends included
  WayFigures figures;
  bool straight = false;
  std::string fault;  // why it is closed; empty: it can be gone
};

class PlanEdges {
 public:
  PlanEdges(const Laboratory& laboratory, const Surroundings& surroundings, const Configurations& configurations,
            std::vector<PlanCandidate> candidates, std::uint64_t seed);

  static constexpr double closed_s = 1e6;               // an edge that cannot be gone
  double cost(std::size_t from, std::size_t to) const;  // as plan/tour.h numbers them

  // Walks what is not yet known of a tour's edges, home to home. True: all can be gone, at the cost they had.
  bool walk(const std::vector<std::size_t>& candidates);
  WalkedWay way(std::size_t from, std::size_t to) const;  // walked before

 private:
  using Key = std::pair<std::size_t, std::size_t>;  // the smaller number first
  struct Edge {
    enum class Known { line_fails, open, closed } known = Known::line_fails;
    double cost_s = 0;
    WalkedWay way;
  };
  const PlanCandidate& candidate(std::size_t number) const;
  State state(std::size_t number) const;
  double base(std::size_t from, std::size_t to) const;
  bool wants_straight(Key key) const;
  Edge walked_line(Key key) const;
  Edge detour(Key key) const;
  Way round_the_middle(const State& from, const State& to, std::uint64_t stream) const;
  bool straight(Key key, Edge& edge) const;
  Key stations(Key key) const;
  std::size_t number(Key key) const {
    return key.first * (candidates_.size() + 1) + std::min(key.second, candidates_.size());
  }

  const Laboratory& laboratory_;
  const Surroundings& surroundings_;
  const Configurations& configurations_;
  std::vector<PlanCandidate> candidates_;
  PlanCandidate home_;
  std::uint64_t seed_;
  std::map<Key, Edge> edges_;
  std::unordered_map<std::size_t, double> costs_s_;  // theirs, by number(): what tours ask for most
  std::vector<bool> touched_;                        // candidates that have an edge in edges_
  std::map<Key, int> straight_failures_;             // of pairs of stations
};

}  // namespace gonio::acquisition
