// Things in space that hang on one another by hinges, over time: what pages draw (report/mesh_view.h) and what other
// programs are handed (scene/exchange/moving_gltf.h).
//
// A node stands in its parent's frame, or in the world, and turns about its own z by the angle of its hinge:
// parent_from_node(t) = placed * Rz(angle(t)). Between two keys all angles run in proportion, before the first and
// after the last they stay. World: z up, right-handed. Metres, radians, seconds.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geom/rigid.h"
#include "io/ply.h"

namespace gonio::io {

struct ModelLens {  // of a camera that looks along its node's z, y down: a centred projection
  double aspect = 4.0 / 3, yfov_rad = 0.5;
  bool orthographic = false;
  double half_height_m = 0;  // orthographic
};
struct ColourChange {
  double from_s = 0;
  int colour = 0;  // in the palette
};
struct ModelNode {
  std::string name{};
  int parent = -1;                               // an earlier node; -1: the world
  Rigid<frame::Object, frame::Object> placed{};  // parent_from_node while the hinge is at 0
  int hinge = -1;                                // place in the angles of a key; -1: fixed
  int mesh = -1;                                 // -1: shows nothing
  int colour = 0;                                // in the palette, until the first of `changes`
  std::vector<ColourChange> changes{};           // in the order of time
  std::string label{};                           // written beside its origin; empty: nothing
  bool surroundings = false;                     // need not fit into the picture
  std::optional<ModelLens> lens{};               // a camera
  std::optional<Vec3> watt_per_sr{};             // a lamp: red, green, blue
};
struct ModelKey {
  double time_s = 0;
  std::vector<double> angles_rad;  // one a hinge
};
struct ModelWords {
  double from_s = 0;
  std::string words;
  bool stop = false;  // where a reader would stop to look: a photograph
};
struct MovingModel {
  std::vector<TriangleMesh> meshes;  // positions and triangles alone
  std::vector<std::array<float, 3>> palette;
  std::vector<ModelNode> nodes;
  std::vector<ModelKey> keys;     // at least one; times do not fall
  std::vector<ModelWords> words;  // what goes on, in the order of time
};

struct PlacedNode {  // world_from_node
  Mat3 rotation;
  Vec3 origin_m;
};
std::vector<double> angles_at(const MovingModel& model, double time_s);
std::vector<PlacedNode> placed_nodes(const MovingModel& model, double time_s);  // one a node
int colour_at(const ModelNode& node, double time_s);

}  // namespace gonio::io
