// Clouds of structured light against shapes that are known, or against each other, as a problem for the engine.
//
// Observations: how far points lie off their shape. A point is seen at a pixel of the first camera, whose ray is one of
// its places; where along it the point lies, the second device said: the projector by its pixel, or another camera by
// its own. The prediction goes the other way, forward: the ray of that pixel through the camera as it is supposed to be
// meets the shape as it is supposed to stand; the place found there goes to the second device, lens and all, with what
// the physics in question does to the pixel that is told; and by how much that differs from the pixel that was told is
// what the point should be off by, along the shape's normal, metres (to first order about the stated rig, and exact in
// everything else). One group per cloud, blocks are tiles of the picture. Score: the root mean square distance.
//
// Where two clouds overlap, and no shape is known, what the other saw stands for it: a small flat patch for every
// point, which the first should be off by what the physics does to it less what it does to the other, along the normal.
// One group per overlap. What does the same to both cannot be told.
//
// Free in the base model: where each shape stands (a plane's distance and two tilts, a ball's centre, a mesh's pose),
// as far as points do not slide along it; of an overlap how one cloud stands to the other. Form and size are known, and
// held.
//
// Frames: the rig's, which is that of its first camera; pixels as camera/camera_model.h has them. Metres, radians.
// Does not ask whether points are missing, and takes no clouds of a projector that showed bits alone: the steps of
// stripes are no noise.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "explain/clouds/cloud_shape.h"
#include "explain/engine.h"
#include "manifest/sections/forward.h"
#include "scan/mechanisms/structured_light_edge.h"
#include "scan/sequence.h"
#include "scan/triangulate.h"

namespace gonio::explain {

struct CloudView {
  std::string name;
  std::size_t cloud = 0;  // which of CloudsInput::clouds
  CloudShape shape;
  std::vector<scan::ScanPoint> points{};       // those that are asked
  std::vector<std::uint32_t> tile{};           // of each, from 0
  std::vector<equation::Neighbours> bright{};  // of each, what white adds about its pixel; empty: not known
  std::vector<CloudShape> patches{};           // of each, in the place of `shape`: what another cloud saw there
  double later_s = 0, warmer_K = 0;            // than the mean of all views; 0 where nothing is stated
};

// Clouds by one pair of devices and one projection.
struct CloudsInput {
  std::string first, second;  // names in cameras
  bool projector = false;     // the second one
  scan::Sequence sequence;
  std::vector<scan::Station> stations;  // the two
  std::vector<std::string> clouds;      // names
  std::vector<CloudView> views;         // group by group
  // Of clouds of no known shape: what the other cloud of the overlap saw of the same points. Else empty.
  std::vector<CloudView> against;
  std::vector<std::string> given;  // mechanisms that the manifest has switched on for these devices or clouds
  std::vector<std::pair<std::string, double>> given_values;  // of their parameters, "id.parameter" or "view/parameter"
};

// Clouds of known shape, or enough by one pair of devices that were placed in the world from where they were taken.
bool has_clouds_to_ask(const manifest::Document& document);
// Error(data | no_input) for files that cannot be read, shapes that their points lie nowhere near, fewer than
// `fewest_clouds` (or overlaps) of one pair of devices.
std::vector<CloudsInput> clouds_inputs(const manifest::Document& document);
std::unique_ptr<Problem> clouds_problem(CloudsInput input);

inline constexpr std::size_t fewest_clouds = 4;  // or overlaps

}  // namespace gonio::explain
