// geometry.pose: about the middle of the object.
#include <algorithm>

#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& geometry_pose();
}

namespace gonio::scene::edits {
namespace {

Vec3 middle_of(const Instance& instance) {  // of the box in the object's frame, in the world
  const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
  if (!mesh || (*mesh)->positions_m.empty()) return instance.world_from_object.translation_m;
  Vec3 lower = (*mesh)->positions_m[0], upper = lower;
  for (const Vec3& p : (*mesh)->positions_m) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  return instance.world_from_object * ((lower + upper) * 0.5);
}

void move(Instance& instance, std::span<const double> a) {
  const Vec3 middle = middle_of(instance);
  const Quaternion turn = quaternion_of_rotation_vector({a[3], a[4], a[5]});
  auto& pose = instance.world_from_object;
  pose.translation_m = middle + matrix_of(turn) * (pose.translation_m - middle) + Vec3{a[0], a[1], a[2]};
  pose.rotation = normalized(turn * pose.rotation);
}

}  // namespace

const Edit& geometry_pose() {
  static const Edit edit{.mechanism = mechanism::geometry_pose, .instance = move};
  return edit;
}

}  // namespace gonio::scene::edits
