// Camera poses by where they stand and what they look at.
#pragma once
#include "geom/rigid.h"

namespace gonio::render {

// A camera at `position_m` that looks at `target_m`; axes x right, y down, z forward; `up` points up in the picture.
// Along `up` itself (to 1e-9 rad) that says nothing: the picture's right is then the part of `right` across `up`, so
// that a camera may go over the pole of a hemisphere: at azimuth a, right is (-sin a, cos a, 0) there as beside it.
inline Rigid<frame::World, frame::Camera> looking_at(Vec3 position_m, Vec3 target_m, Vec3 up = {0, 0, 1},
                                                     Vec3 right_where_along_up = {0, 1, 0}) {
  const Vec3 forward = normalized(target_m - position_m);
  Vec3 across = cross(forward, up);
  if (!(norm(across) > 1e-9 * norm(up))) across = right_where_along_up - forward * dot(right_where_along_up, forward);
  const Vec3 right = normalized(across), down = cross(forward, right);
  Mat3 rotation;
  for (int axis = 0; axis < 3; ++axis) {
    rotation(axis, 0) = right[axis];
    rotation(axis, 1) = down[axis];
    rotation(axis, 2) = forward[axis];
  }
  return {quaternion_of(rotation), position_m};
}

}  // namespace gonio::render
