// See way.h. The space that is searched holds the joints that move, each times how far it carries solids (reach.h): a
// distance there is a distance in metres. OMPL's own random numbers come from one sequence for the whole program, so
// that the planner gets a sampler of ours, and neighbours are found without any.
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>

#include "acquisition/motion/line.h"
#include "acquisition/motion/reach.h"
#include "acquisition/motion/way.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

namespace ob = ompl::base;

constexpr double longest_branch_m = 0.8;  // of the search trees
constexpr int shortcuts = 80;

struct MovingJoint {
  const LaboratoryArm* arm;
  std::size_t joint;
  double metres_per_rad;
  double lower_rad, upper_rad;  // of the search
};

class SearchSpace {
 public:
  SearchSpace(const Laboratory& laboratory, const Surroundings& surroundings, const State& from, const State& to)
      : laboratory_(laboratory), surroundings_(surroundings), rest_(between(laboratory, from, from, 0)) {
    for (const auto& [name, arm] : laboratory.arms) {
      const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
      if (a == b) continue;
      std::vector<double> reach(a.size(), 0.01);  // the last joint carries little
      for (const std::vector<double>& of_solid : reaches(arm))
        for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = std::max(reach[i], of_solid[i]);
      for (std::size_t i = 0; i < a.size(); ++i)  // half a turn beyond both ends leads round anything
        joints_.push_back({&arm, i, reach[i], std::max(arm.limits[i].lower_rad, std::min(a[i], b[i]) - pi),
                           std::min(arm.limits[i].upper_rad, std::max(a[i], b[i]) + pi)});
    }
  }
  const std::vector<MovingJoint>& joints() const { return joints_; }

  State state_of(const double* values) const {
    State state = rest_;
    for (std::size_t k = 0; k < joints_.size(); ++k)
      state[joints_[k].arm->name][joints_[k].joint] = values[k] / joints_[k].metres_per_rad;
    return state;
  }
  void put(const State& state, double* values) const {
    for (std::size_t k = 0; k < joints_.size(); ++k)
      values[k] = joints_of(*joints_[k].arm, state)[joints_[k].joint] * joints_[k].metres_per_rad;
  }
  bool open(const State& state) const {
    return broken_at(laboratory_, state, smallest_singular(laboratory_, state)).empty() &&
           surroundings_.free(state, laboratory_.margin_m);
  }
  bool open(const State& from, const State& to) const { return open_line(laboratory_, surroundings_, from, to); }
  const Laboratory& laboratory() const { return laboratory_; }

 private:
  const Laboratory& laboratory_;
  const Surroundings& surroundings_;
  State rest_;
  std::vector<MovingJoint> joints_;
};

double* values_of(ob::State* state) {
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}
const double* values_of(const ob::State* state) {
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}

class SeededSampler : public ob::StateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, const SearchSpace& search, std::uint64_t seed)
      : ob::StateSampler(space), search_(search), random_(seed, 21) {}
  void sampleUniform(ob::State* state) override {
    double* values = values_of(state);
    for (std::size_t k = 0; k < search_.joints().size(); ++k) {
      const MovingJoint& j = search_.joints()[k];
      values[k] = random_.uniform(j.lower_rad, j.upper_rad) * j.metres_per_rad;
    }
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    for (std::size_t k = 0; k < search_.joints().size(); ++k)
      values_of(state)[k] = values_of(near)[k] + random_.uniform(-distance, distance);
    space_->enforceBounds(state);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    for (std::size_t k = 0; k < search_.joints().size(); ++k)
      values_of(state)[k] = values_of(mean)[k] + random_.normal() * deviation;
    space_->enforceBounds(state);
  }

 private:
  const SearchSpace& search_;
  Random random_;
};

class LineValidator : public ob::MotionValidator {
 public:
  LineValidator(const ob::SpaceInformationPtr& information, const SearchSpace& search)
      : ob::MotionValidator(information), search_(search) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return search_.open(search_.state_of(values_of(from)), search_.state_of(values_of(to)));
  }
  // How far it stays open is not asked by RRT-Connect.
  bool checkMotion(const ob::State* from, const ob::State* to, std::pair<ob::State*, double>& last) const override {
    last.second = 0;
    return checkMotion(from, to);
  }

 private:
  const SearchSpace& search_;
};

std::optional<Way> searched(const SearchSpace& search, const State& from, const State& to, std::uint64_t seed,
                            int tries) {
  ompl::msg::noOutputHandler();
  const auto dimensions = static_cast<unsigned>(search.joints().size());
  const auto space = std::make_shared<ob::RealVectorStateSpace>(dimensions);
  ob::RealVectorBounds bounds(dimensions);
  for (unsigned k = 0; k < dimensions; ++k) {
    const MovingJoint& j = search.joints()[k];
    bounds.setLow(k, j.lower_rad * j.metres_per_rad - 1e-6);
    bounds.setHigh(k, j.upper_rad * j.metres_per_rad + 1e-6);
  }
  space->setBounds(bounds);
  space->setStateSamplerAllocator(
      [&](const ob::StateSpace* s) { return std::make_shared<SeededSampler>(s, search, seed); });
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&](const ob::State* s) { return search.open(search.state_of(values_of(s))); });
  information->setMotionValidator(std::make_shared<LineValidator>(information, search));
  information->setup();
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<> start(space), goal(space);
  search.put(from, values_of(start.get()));
  search.put(to, values_of(goal.get()));
  problem->setStartAndGoalStates(start, goal);
  ompl::geometric::RRTConnect planner(information);
  planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();
  planner.setRange(longest_branch_m);
  planner.setProblemDefinition(problem);
  planner.setup();
  ob::IterationTerminationCondition until(static_cast<unsigned>(std::max(tries, 1)));
  if (planner.solve(until) != ob::PlannerStatus::EXACT_SOLUTION) return std::nullopt;
  Way way;
  for (const ob::State* state : problem->getSolutionPath()->as<ompl::geometric::PathGeometric>()->getStates())
    way.push_back(search.state_of(values_of(state)));
  way.front() = from;
  way.back() = to;
  return way;
}

// Straight lines across, between random places of the way, where that saves time.
Way shortened(const SearchSpace& search, Way way, std::uint64_t seed) {
  const Laboratory& laboratory = search.laboratory();
  Random random(seed, 22);
  double time = way_time(laboratory, way);
  for (int k = 0; k < shortcuts && way.size() > 2; ++k) {
    double a = random.uniform(0, static_cast<double>(way.size() - 1));
    double b = random.uniform(0, static_cast<double>(way.size() - 1));
    if (k % 2 == 0) a = std::floor(a), b = std::ceil(b);  // whole corners as often as places between them
    if (a > b) std::swap(a, b);
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(std::ceil(b));
    if (j < i + 2) continue;
    const State from = between(laboratory, way[i], way[i + 1], a - static_cast<double>(i));
    const State to = between(laboratory, way[j - 1], way[j], b - static_cast<double>(j - 1));
    Way across(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    if (a > static_cast<double>(i)) across.push_back(from);
    if (b < static_cast<double>(j)) across.push_back(to);
    across.insert(across.end(), way.begin() + static_cast<std::ptrdiff_t>(j), way.end());
    const double shorter = way_time(laboratory, across);
    if (shorter >= time || !search.open(from, to)) continue;
    way = std::move(across);
    time = shorter;
  }
  return way;
}

}  // namespace

std::optional<Way> joint_way(const Laboratory& laboratory, const Surroundings& surroundings, const State& from,
                             const State& to, std::uint64_t seed, int tries) {
  const State begin = between(laboratory, from, from, 0), end = between(laboratory, to, to, 0);
  const SearchSpace search(laboratory, surroundings, begin, end);
  if (search.joints().empty() || open_line(laboratory, surroundings, begin, end)) {
    Way line{begin, end};
    if (judge(laboratory, surroundings, line).fault.empty()) return line;
    return std::nullopt;
  }
  if (!search.open(begin) || !search.open(end)) return std::nullopt;
  std::optional<Way> way = searched(search, begin, end, seed, tries);
  if (!way) return std::nullopt;
  way = shortened(search, std::move(*way), seed);
  if (!judge(laboratory, surroundings, *way).fault.empty()) return std::nullopt;
  return way;
}

}  // namespace gonio::acquisition
