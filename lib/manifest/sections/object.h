// "objects": a mesh with a surface, somewhere in the world.
#pragma once
#include <optional>
#include <string>

#include "manifest/pose.h"

namespace gonio::manifest {

struct Object {  // "objects"
  std::string id, mesh, surface;
  std::optional<Pose<frame::World, frame::Object>> world_from_object;
  std::optional<int> priority{};  // where objects that let light through overlap, the highest one fills the space
};

}  // namespace gonio::manifest
