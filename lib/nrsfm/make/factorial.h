// The factorial design of Jensen et al. 2018 over motions: paths x projections x {with, without} missing data.
#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "nrsfm/make/camera_paths.h"
#include "nrsfm/make/occlusion.h"

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

// The camera's mean distance is `distance` times the radius of the motion's points: 4.3 gives the 1.6-fold range of
// depths that the benchmark has. Points that fewer than `least_seen` of the frames see are no tracks.
// `flow_width_px`: instead of the points themselves, what a tracker finds in pictures of that width (flow.h); 0: not.
struct ViewOptions {
  double distance = 4.3;
  double least_seen = 0.1;
  int flow_width_px = 0;
  std::vector<Vec3> places{};  // of the camera, PathOptions::places
};

// Neither a cell's points nor what a tracker finds of them make a sequence.
struct NoTracks : Error {
  using Error::Error;
};

// A path in front of a motion, and the points that can be followed there: those that enough frames see. The first
// `wanted` are, the same with and without missing data, so that these two cells differ in nothing else.
struct Take {
  std::string path, camera;
  Projection projection = Projection::orthographic;
  Pinhole pinhole;
  PathOptions place;
  std::vector<CameraFromObject> cameras;
  std::vector<Eigen::Index> points;  // columns of Motion::points_m
  std::size_t wanted = 0;            // no more than there are
  Visible visible;                   // F x points
};
Take take_of(const Motion& motion, const std::string& path, const std::string& camera, const ViewOptions& options);

// What a virtual camera sees of a take's points, or what a tracker finds of all: the first that it follows long
// enough.
Sequence film(const Motion& motion, const Take& take, const Cell& cell, std::uint64_t seed, const ViewOptions& options);
Sequence film(const Motion& motion, const Cell& cell, std::uint64_t seed, const ViewOptions& options);

}  // namespace gonio::nrsfm
