// "plans": what to photograph, in which order, by which motions. "runs": what was done of them.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/pose.h"

namespace gonio::manifest {

// One photograph, or one bracket of them. What is asked stands in world_from_camera, light_m and turntable_rad; how the
// arms get there in `via` and at last joints_rad and other_arms. A step that is only asked has no joints yet: that is
// what `next_measurement` of explain and the calibrations writes, and what `acquire` completes.
struct PlanStep {
  std::string image{};    // id of the picture that it makes; brackets add -1, -2, ...
  std::string camera{};   // name in laboratory.cameras
  std::string purpose{};  // "view" | "repeat" | "reference" | "dark" | "board"
  std::vector<std::string> lamps{};
  std::vector<double> exposures_s{};
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera{};  // asked
  std::vector<double> light_m{};                                         // asked: where the held lamp is, world
  std::map<std::string, double> turntable_rad{};
  std::map<std::string, std::string> screens{};  // what each shows: pattern id or file id
  std::string robot{};                           // whose joints follow: the one that holds the camera
  std::vector<double> joints_rad{};
  std::map<std::string, std::vector<double>> other_arms{};                   // their joints, by robot
  std::vector<std::map<std::string, std::vector<double>>> via{};             // joints of the arms on the way, in order
  std::optional<bool> straight{};                                            // the tool follows a line
  std::optional<double> duration_s{}, smallest_singular_m{}, clearance_m{};  // of the way there
};

struct UnreachableView {
  std::string image{}, why{};
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera{};  // asked
  std::optional<PlanStep> nearest{};                                     // that can be reached
};

struct Plan {
  std::string id{};       // SHA-256 of what decides it: laboratory, request, seed, steps
  std::string pattern{};  // what was asked, in words
  std::optional<std::uint64_t> seed{};
  std::vector<PlanStep> steps{};
  std::vector<UnreachableView> unreachable{};
  std::map<std::string, double> figures{};  // the unit ends the name
};

struct Run {
  std::string plan{};     // id
  std::string journal{};  // file id
  std::int64_t frames = 0, retaken = 0, refused = 0;
};

}  // namespace gonio::manifest
