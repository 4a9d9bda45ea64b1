// Where the arms stand at a plan's steps, and the ways between them (planner.h).
#include "acquisition/plan/planner.h"
#include "base/error.h"

namespace gonio::acquisition {
namespace {

State home_state(const Laboratory& laboratory) {
  State state;
  for (const auto& [name, arm] : laboratory.arms) state[name] = arm.home;
  return state;
}

void stand(State& state, const std::map<std::string, std::vector<double>>& arms) {
  for (const auto& [name, joints] : arms) {
    if (!state.contains(name) || state.at(name).size() != joints.size())
      throw Error(Exit::data, "plan", "names arm \"" + name + "\", which the laboratory does not have so",
                  "plan again for this laboratory");
    state[name] = joints;
  }
}

}  // namespace

State state_at(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t index) {
  State state = home_state(laboratory);
  const manifest::PlanStep& step = plan.steps.at(index);
  stand(state, step.other_arms);
  if (!step.robot.empty()) stand(state, {{step.robot, step.joints_rad}});
  return state;
}

Way way_to(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t index) {
  Way way{index == 0 ? home_state(laboratory) : state_at(laboratory, plan, index - 1)};
  for (const auto& arms : plan.steps.at(index).via) {
    way.push_back(way.back());
    stand(way.back(), arms);
  }
  const State end = state_at(laboratory, plan, index);
  if (end != way.back()) way.push_back(end);
  return way;
}

}  // namespace gonio::acquisition
