// "frames": rigid motions between named frames.
#pragma once
#include <optional>
#include <string>

#include "geom/rigid.h"
#include "manifest/pose.h"

namespace gonio::manifest {

struct Link {  // "frames": a rigid motion between two named frames
  std::string to, from;
  Quaternion rotation;
  Vec3 translation_m;
  std::optional<PoseSigma> sigma;
};

}  // namespace gonio::manifest
