// Rigid motions between named frames. `Rigid<World, Camera>` is world_from_camera: it takes camera coordinates to world
// coordinates, so letters cancel, p_world = world_from_camera * p_camera, and a wrong composition does not compile.
// Rotations are unit quaternions [w, x, y, z]; lengths are metres.
#pragma once
#include <array>

#include "geom/vector.h"

namespace gonio {

struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
  constexpr bool operator==(const Quaternion&) const = default;
};
Quaternion operator*(const Quaternion& a, const Quaternion& b);
Quaternion conjugate(const Quaternion& q);
Quaternion normalized(const Quaternion& q);
Mat3 matrix_of(const Quaternion& q);
Quaternion quaternion_of(const Mat3& rotation);       // rotation must be orthonormal; w >= 0
Quaternion quaternion_of_rotation_vector(Vec3 v);     // axis times angle, rad (Rodrigues)
Vec3 rotation_vector_of(const Quaternion& q);         // angle in [0, pi]

namespace frame {
struct World {};
struct Rig {};   // several cameras held together; the frame of the first
struct Base {};  // of a robot
struct Tool {};
struct Camera {};
struct Light {};
struct Object {};
struct Board {};
}  // namespace frame

template <class To, class From>
struct Rigid {
  Quaternion rotation;
  Vec3 translation_m;
  Vec3 operator*(Vec3 point) const { return matrix_of(rotation) * point + translation_m; }
  Vec3 rotate(Vec3 direction) const { return matrix_of(rotation) * direction; }
  template <class Earlier>
  Rigid<To, Earlier> operator*(const Rigid<From, Earlier>& o) const {
    return {normalized(rotation * o.rotation), (*this) * o.translation_m};
  }
  bool operator==(const Rigid&) const = default;
};
template <class To, class From>
Rigid<From, To> inverse(const Rigid<To, From>& a) {
  const Quaternion r = conjugate(a.rotation);
  return {r, -(matrix_of(r) * a.translation_m)};
}

}  // namespace gonio
