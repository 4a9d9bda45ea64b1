#include "robot/handeye/samples.h"

#include <cmath>

namespace gonio::robot::handeye {

std::string_view name_of(Kind kind) {
  return kind == Kind::eye_in_hand ? "eye-in-hand" : "eye-to-hand";
}

PoseSample sample_of(Kind kind, const Rigid<frame::Base, frame::Tool>& base_from_tool,
                     const Rigid<frame::Camera, frame::Board>& camera_from_board) {
  if (kind == Kind::eye_in_hand) {
    return {{base_from_tool.rotation, base_from_tool.translation_m}, camera_from_board};
  }
  const auto tool_from_base = inverse(base_from_tool);
  return {{tool_from_base.rotation, tool_from_base.translation_m}, camera_from_board};
}

Rigid<Stand, frame::Board> board_seen(const PoseSample& sample, const Rigid<Mount, frame::Camera>& mount_from_camera) {
  return sample.stand_from_mount * mount_from_camera * sample.camera_from_board;
}

PoseError difference(const Rigid<Stand, frame::Board>& a, const Rigid<Stand, frame::Board>& b, Vec3 middle_m) {
  return {norm(a * middle_m - b * middle_m), norm(rotation_vector_of(conjugate(a.rotation) * b.rotation))};
}

PoseError scatter(std::span<const PoseSample> samples, const Solution& solution, Vec3 middle_m) {
  PoseError sum;
  for (const PoseSample& sample : samples) {
    const PoseError e = difference(board_seen(sample, solution.mount_from_camera), solution.stand_from_board, middle_m);
    sum.translation_m += e.translation_m * e.translation_m;
    sum.rotation_rad += e.rotation_rad * e.rotation_rad;
  }
  const double n = samples.empty() ? 1 : static_cast<double>(samples.size());
  return {std::sqrt(sum.translation_m / n), std::sqrt(sum.rotation_rad / n)};
}

}  // namespace gonio::robot::handeye
