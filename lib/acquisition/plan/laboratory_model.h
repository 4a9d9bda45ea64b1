// The laboratory as a model that moves (io/moving_model.h): what pages and other programs show of it. Arms hang on
// their joints, what they hold on their flanges; every arm's joints and every turntable are hinges.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "io/moving_model.h"
#include "report/mesh_view.h"

namespace gonio::acquisition {

// Places in the palette of every such model.
enum class Tint {
  surroundings,
  first_arm,  // arms take four in turn
  carried = 5,
  camera,
  lamp,
  lit,
  turntable,
  screen,
  to_take,
  taken,
  unreachable
};

struct LaboratoryModel {
  io::MovingModel model;    // at home, without keys beyond that
  std::vector<int> solids;  // the nodes of the bodies, in the order of bodies_of (motion/body.h)
  std::map<std::string, int> cameras, lamps, turntables, screens;  // their nodes; without those that stand nowhere
};
LaboratoryModel laboratory_model(const manifest::Document& document, const Laboratory& laboratory);

// Angles of the hinges: of the arms as State has it, of turntables 0 where they are not named.
std::vector<double> hinge_angles(const manifest::Document& document, const Laboratory& laboratory, const State& state,
                                 const std::map<std::string, double>& turntables);

// What a camera sees of a point `depth_m` before it: the corners of its picture there, camera coordinates; of a camera
// whose lens is not described, those of a usual one.
std::vector<Vec3> picture_corners(const manifest::Document& document, const std::string& camera, double depth_m);

report::MeshView view_of(io::MovingModel model);

}  // namespace gonio::acquisition
