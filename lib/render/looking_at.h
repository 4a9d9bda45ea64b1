// Camera poses for built-in scenes.
#pragma once
#include "geom/rigid.h"

namespace gonio::render {

// A camera at `position_m` that looks at `target_m`; axes x right, y down, z forward; the world's z is up in the
// picture. Not for views along z.
inline Rigid<frame::World, frame::Camera> looking_at(Vec3 position_m, Vec3 target_m) {
  const Vec3 forward = normalized(target_m - position_m), right = normalized(cross(forward, {0, 0, 1}));
  const Vec3 down = cross(forward, right);
  Mat3 rotation;
  for (int axis = 0; axis < 3; ++axis) {
    rotation(axis, 0) = right[axis];
    rotation(axis, 1) = down[axis];
    rotation(axis, 2) = forward[axis];
  }
  return {quaternion_of(rotation), position_m};
}

}  // namespace gonio::render
