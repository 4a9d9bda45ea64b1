// An arm of a laboratory from its URDF.
#pragma once
#include <string>
#include <vector>

#include "acquisition/laboratory/solid.h"
#include "manifest/sections/forward.h"
#include "robot/urdf.h"

namespace gonio::acquisition {

struct DescribedArm {
  robot::UrdfArm kinematics;
  std::vector<Solid> solids;  // of its links: placed in the frames of the arm, named after the description's links
};
// `pointer`: of the robot in the document. Error(data) for a mesh that lies outside the manifest's folder, unless that
// is allowed, and for one that is neither PLY nor STL.
DescribedArm described_arm(const manifest::Document& document, const std::string& file_id, const std::string& pointer);

}  // namespace gonio::acquisition
