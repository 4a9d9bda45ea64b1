// The factorial design of Jensen et al. 2018 over motions: paths x projections x {with, without} missing data.
#pragma once
#include <string>
#include <vector>

#include "nrsfm/camera_paths.h"
#include "nrsfm/occlusion.h"

namespace gonio::nrsfm {

struct Cell {                                      // of the design
  std::string deformation, path, camera, missing;  // "bending", "circle", "perspective", "with"
};
// "bending-circle-perspective-with"; seeds beyond 1 are told apart: "...-seed2".
std::string name_of(const Cell& cell, std::uint64_t seed);
// Every combination, the last factor fastest.
std::vector<Cell> design(const std::vector<std::string>& deformations, const std::vector<std::string>& paths,
                         const std::vector<std::string>& cameras, const std::vector<std::string>& missing);

// 1280 x 960 pixels; a scene of the radius at the distance fills two thirds of the height.
inline constexpr int view_width_px = 1280, view_height_px = 960;
Pinhole view_pinhole(double distance_m, double radius_m);

// What a virtual camera sees. The camera's mean distance is `distance` times the radius of the motion's points: 4.3
// gives the 1.6-fold range of depths that the benchmark has.
// Points that fewer than `least_seen` of the frames see are no tracks; with missing data they are left out.
// `flow_width_px`: instead of the points themselves, what a tracker finds in pictures of that width (flow.h); 0: not.
struct ViewOptions {
  double distance = 4.3;
  double least_seen = 0.1;
  int flow_width_px = 0;
};
Sequence film(const Motion& motion, const Cell& cell, std::uint64_t seed, const ViewOptions& options);

}  // namespace gonio::nrsfm
