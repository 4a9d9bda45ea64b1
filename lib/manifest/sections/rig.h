// "rigs": cameras that are held together.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/pose.h"

namespace gonio::manifest {

struct RigMember {
  std::string camera;
  Pose<frame::Rig, frame::Camera> rig_from_camera;
};
struct Rig {  // "rigs": cameras that are held together; the first defines the frame
  std::vector<RigMember> cameras;
  std::optional<double> rms_px;
};

}  // namespace gonio::manifest
