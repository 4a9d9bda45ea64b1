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
  std::optional<double> roll_rad{};  // asked: the camera may be turned about its axis by up to so much to either side
  std::vector<double> light_m{};     // asked: where the held lamp is, world
  std::map<std::string, double> turntable_rad{};
  std::map<std::string, std::string> screens{};  // what each shows: pattern id or file id
  std::string projection{};                      // name in projections, of which a screen shows a frame
  std::optional<std::int64_t> shows{};           // place in its frames, from 0
  std::string group{};                           // view that its picture belongs to; empty: one of its own
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

// Where a camera was found to stand at a step, in the joints that the step has: measured once, by any run of the plan.
struct MeasuredView {
  std::string image{}, by{};  // of the step; the program that found it
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera{};
  std::string board{};                                                   // that it saw, as follows
  std::optional<Pose<frame::Camera, frame::Board>> camera_from_board{};  // with what is uncertain of it
};
// A board's corners as the first run of the plan found them at a step: what later check views are held against.
struct CheckView {
  std::string image{}, board{};
  std::vector<int> corners{};
  std::vector<double> u_px{}, v_px{}, sigma_px{};  // of each
};

struct Plan {
  std::string id{};       // SHA-256 of what decides it: laboratory, request, seed, steps
  std::string pattern{};  // what was asked, in words
  std::optional<std::uint64_t> seed{};
  std::vector<PlanStep> steps{};
  std::vector<UnreachableView> unreachable{};
  std::map<std::string, double> figures{};  // the unit ends the name
  std::vector<MeasuredView> measured{};     // by its runs; no part of the id
  std::vector<CheckView> checks{};          // no part of the id either
};

// How closely a run came back to where it had been, by the board's views in between: standard deviations of one
// coordinate over takes, beyond what the corners' noise makes, with the interval that holds them at 95 %.
struct Repeatability {
  std::int64_t views = 0;  // in which the board was found
  std::optional<double> position_m{}, rotation_rad{};
  std::vector<double> position_interval_m{}, rotation_interval_rad{};
  std::optional<double> corners_m{}, corners_rad{};  // what the corners' noise makes, root mean square
};

// Frames at an end of which a check view had moved: nobody knows from where they were taken.
struct DriftedFrames {
  std::string check{}, against{};          // the view that had moved; the one it is held against
  std::optional<double> value{}, sigma{};  // by how much; left out: no board was found
  double limit = 0;
  std::string unit{};  // "m" | "rad" | "px"
  std::vector<std::string> images{};
};

struct Run {
  std::string plan{};     // id
  std::string journal{};  // file id
  std::int64_t frames = 0, retaken = 0, refused = 0;
  std::int64_t measured = 0;  // frames that stand where the plan's `measured` says
  std::optional<Repeatability> repeatability{};
  std::vector<DriftedFrames> drifted{};
};

}  // namespace gonio::manifest
