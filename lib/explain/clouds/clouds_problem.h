// Clouds of structured light against shapes that are known, as a problem for the engine.
//
// Observations: how far points lie off their shape. A point is seen at a pixel of the first camera, whose ray is one of
// its places; where along it the point lies, the second device said: the projector by its pixel, or another camera by
// its own. The prediction goes the other way, forward: the ray of that pixel through the camera as it is supposed to be
// meets the shape as it is supposed to stand; the place found there goes to the second device, lens and all, with what
// the physics in question does to the pixel that is told; and by how much that differs from the pixel that was told is
// what the point should be off by, along the shape's normal, metres (to first order about the stated rig, and exact in
// everything else). One group per cloud, blocks are tiles of the picture. Score: the root mean square distance.
//
// Free in the base model: where each shape stands (a plane's distance and two tilts, a ball's centre, a mesh's pose).
// Its form and size are known, and held.
//
// Frames: the rig's, which is that of its first camera; pixels as camera/camera_model.h has them. Metres, radians.
// Does not ask whether points are missing, compares clouds with no other clouds, and takes no clouds of a projector
// that showed bits alone: the steps of stripes are no noise.
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
  CloudShape shape;
  std::vector<scan::ScanPoint> points;       // those that are asked
  std::vector<std::uint32_t> tile;           // of each, from 0
  std::vector<equation::Neighbours> bright;  // of each, what white adds about its pixel; empty: not known
  double later_s = 0, warmer_K = 0;          // than the mean of all views; 0 where nothing is stated
};

// Clouds by one pair of devices and one projection.
struct CloudsInput {
  std::string first, second;  // names in cameras
  bool projector = false;     // the second one
  scan::Sequence sequence;
  std::vector<scan::Station> stations;  // the two
  std::vector<CloudView> views;
  std::vector<std::string> given;  // mechanisms that the manifest has switched on for these devices or clouds
  std::vector<std::pair<std::string, double>> given_values;  // of their parameters, "id.parameter" or "view/parameter"
};

bool has_known_shapes(const manifest::Document& document);
// Error(data | no_input) for files that cannot be read, shapes that their points lie nowhere near, fewer than
// `fewest_clouds` of one pair.
std::vector<CloudsInput> clouds_inputs(const manifest::Document& document);
std::unique_ptr<Problem> clouds_problem(CloudsInput input);

inline constexpr std::size_t fewest_clouds = 4;

}  // namespace gonio::explain
