// The way home from a plan's step (planner.h).
#include "acquisition/plan/planner.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {

Way way_home(const Laboratory& laboratory, const manifest::Plan& plan, std::size_t from) {
  const Surroundings surroundings(laboratory);
  const State start = state_at(laboratory, plan, from), home = [&] {
    State state;
    for (const auto& [name, arm] : laboratory.arms) state[name] = arm.home;
    return state;
  }();
  if (start == home) return {home};
  const auto way = joint_way(laboratory, surroundings, start, home, plan.seed.value_or(1));
  if (!way)
    throw Error(Exit::data, "plan", format("no way home was found from step %zu", from + 1),
                "lead the arms home by hand");
  return *way;
}

}  // namespace gonio::acquisition
