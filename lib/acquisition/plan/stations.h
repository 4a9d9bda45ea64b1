// Steps gathered by what they ask of arms and turntables, and the stops that a plan makes.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "acquisition/plan/planner.h"

namespace gonio::acquisition {

// Steps with the same camera pose, place of the lamp and turntables.
struct Station {
  std::vector<std::size_t> steps;  // of those asked, in their order
  std::string between;             // "reference", "board": met again and again between views; empty: a view
};
std::vector<Station> stations_of(const std::vector<manifest::PlanStep>& asked, const PlanOptions& options);

// A stop of the plan: which station, and the pictures taken there.
struct Frame {
  std::size_t step = 0;  // of those asked
  std::string image, purpose;
};
struct Visit {
  std::size_t station = 0;
  std::vector<Frame> frames;
};
// One visit for each station of `order`, with all its steps.
std::vector<Visit> visits_of(const std::vector<manifest::PlanStep>& asked, const std::vector<Station>& stations,
                             const std::vector<std::size_t>& order);
// In the order asked: a station whose steps are no neighbours is visited more than once. Without those not `reachable`.
std::vector<Visit> visits_as_asked(const std::vector<manifest::PlanStep>& asked, const std::vector<Station>& stations,
                                   const std::vector<bool>& reachable);

// `views` with repeats, reference, board and dark frames between them (PlanOptions). A repeat is taken at least a
// quarter of the plan away from the first take; among those that may stand at a place the one with the least `far`
// from what is there.
std::vector<Visit> interleaved(std::vector<Visit> views, const std::vector<manifest::PlanStep>& asked,
                               const std::vector<Station>& stations, const std::vector<bool>& reachable,
                               const PlanOptions& options, const std::function<double(std::size_t, std::size_t)>& far);

// Equal of steps of a finished plan that have the same camera in the same joints and turntables: takes of one view.
std::string place_key(const manifest::PlanStep& step);

// The point nearest to the axes of all cameras; of one camera, or of parallel ones, half a metre before it.
Vec3 common_target(const std::vector<manifest::PlanStep>& asked);
// The point of the camera's axis that is nearest to `target_m`, in front of it.
Vec3 looked_at(const manifest::PlanStep& step, Vec3 target_m);

}  // namespace gonio::acquisition
