// OMPL's own random numbers come from one sequence for the whole program, so that the planner gets a sampler of ours,
// and neighbours are found without any.
#include "acquisition/motion/joint_way_module.h"

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace gonio::acquisition {
namespace {

namespace ob = ompl::base;

constexpr double longest_branch_m = 0.8;  // of the search trees

double* values_of(ob::State* state) {
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}
const double* values_of(const ob::State* state) {
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}

class SeededSampler : public ob::StateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, const SearchedSpace& search, std::uint64_t seed)
      : ob::StateSampler(space), search_(search), random_(seed, 21) {}
  void sampleUniform(ob::State* state) override {
    for (unsigned k = 0; k < search_.dimensions(); ++k) values_of(state)[k] = search_.drawn(k, random_);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    for (unsigned k = 0; k < search_.dimensions(); ++k)
      values_of(state)[k] = values_of(near)[k] + random_.uniform(-distance, distance);
    space_->enforceBounds(state);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    for (unsigned k = 0; k < search_.dimensions(); ++k)
      values_of(state)[k] = values_of(mean)[k] + random_.normal() * deviation;
    space_->enforceBounds(state);
  }

 private:
  const SearchedSpace& search_;
  Random random_;
};

class LineValidator : public ob::MotionValidator {
 public:
  LineValidator(const ob::SpaceInformationPtr& information, const SearchedSpace& search)
      : ob::MotionValidator(information), search_(search) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return search_.open(values_of(from), values_of(to));
  }
  // How far it stays open is not asked by RRT-Connect.
  bool checkMotion(const ob::State* from, const ob::State* to, std::pair<ob::State*, double>& last) const override {
    last.second = 0;
    return checkMotion(from, to);
  }

 private:
  const SearchedSpace& search_;
};

}  // namespace
}  // namespace gonio::acquisition

bool gonio_joint_way(const gonio::acquisition::SearchedSpace& search, const std::vector<double>& from,
                     const std::vector<double>& to, std::uint64_t seed, int tries,
                     std::vector<std::vector<double>>& way) {
  using namespace gonio::acquisition;
  ompl::msg::noOutputHandler();
  const unsigned dimensions = search.dimensions();
  const auto space = std::make_shared<ob::RealVectorStateSpace>(dimensions);
  ob::RealVectorBounds bounds(dimensions);
  for (unsigned k = 0; k < dimensions; ++k) {
    bounds.setLow(k, search.lower(k) - 1e-6);
    bounds.setHigh(k, search.upper(k) + 1e-6);
  }
  space->setBounds(bounds);
  space->setStateSamplerAllocator(
      [&](const ob::StateSpace* s) { return std::make_shared<SeededSampler>(s, search, seed); });
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&](const ob::State* s) { return search.open(values_of(s)); });
  information->setMotionValidator(std::make_shared<LineValidator>(information, search));
  information->setup();
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<> start(space), goal(space);
  std::copy(from.begin(), from.end(), values_of(start.get()));
  std::copy(to.begin(), to.end(), values_of(goal.get()));
  problem->setStartAndGoalStates(start, goal);
  ompl::geometric::RRTConnect planner(information);
  planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();
  planner.setRange(longest_branch_m);
  planner.setProblemDefinition(problem);
  planner.setup();
  ob::IterationTerminationCondition until(static_cast<unsigned>(std::max(tries, 1)));
  if (planner.solve(until) != ob::PlannerStatus::EXACT_SOLUTION) return false;
  for (const ob::State* state : problem->getSolutionPath()->as<ompl::geometric::PathGeometric>()->getStates())
    way.emplace_back(values_of(state), values_of(state) + dimensions);
  return true;
}
