// A robot, a camera and a board in numbers: poses around a board, what the robot says of them and which corners are
// seen, with noise of stated size. Own projection, own generator of poses; the truth stays with the test.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "robot/handeye/views.h"

namespace gonio::tests {

namespace he = robot::handeye;

enum class Motion { rich, one_axis, planar, translation, half_turns, small };

struct HandEyeWorld {
  he::Kind kind = he::Kind::eye_in_hand;
  Motion motion = Motion::rich;
  int poses = 15, columns = 8, rows = 5;
  double square_m = 0.03, corner_px = 0.1, robot_m = 0.0005, robot_rad = 0.001;
  double claimed_px = 0.1;  // sigma_px beside the corners
  he::Solution truth{{normalized(Quaternion{0.3, 0.7, -0.5, 0.4}), {0.05, -0.08, 0.12}},
                     {normalized(Quaternion{0.1, 0.9, 0.2, -0.3}), {0.6, 0.2, -0.1}}};

  he::Setup setup() const {
    he::Setup s;
    s.kind = kind;
    s.lens.fx_px = 1000;
    s.lens.fy_px = 1005;
    s.lens.cx_px = 642;
    s.lens.cy_px = 479;
    s.lens.distortion[0] = -0.1;
    s.extent = {{(columns - 1) * square_m / 2, (rows - 1) * square_m / 2},
                {(columns - 1) * square_m / 2, (rows - 1) * square_m / 2}};
    s.width_px = 1280;
    s.height_px = 960;
    return s;
  }

  // The camera looks at the board's middle from about 0.6 m.
  Rigid<frame::Camera, frame::Board> true_pose(Random& random, int index) const {
    const Vec3 middle{(columns - 1) * square_m / 2, (rows - 1) * square_m / 2, 0};
    Vec3 turn{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-1.5, 1.5)};
    Vec3 shift{random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0.6 + random.uniform(-0.12, 0.12)};
    if (motion == Motion::one_axis) turn = {0.2, -0.1, 0};
    if (motion == Motion::planar || motion == Motion::translation) turn = {0.2, -0.1, 0};
    if (motion == Motion::small) turn = turn * 0.01;
    if (motion == Motion::half_turns) {
      turn = turn * 1e-3;
      shift = {0, 0, 0.6};
    }
    Rigid<frame::Camera, frame::Board> pose{quaternion_of_rotation_vector(turn), shift};
    if (motion == Motion::one_axis || motion == Motion::planar) {  // about one axis that is no coordinate's
      const Vec3 axis = normalized(Vec3{0.1, 0.2, 1});
      const double angle = random.uniform(-1.2, 1.2);
      pose.rotation = quaternion_of_rotation_vector(axis * angle) * pose.rotation;
      if (motion == Motion::planar) pose.translation_m = pose.translation_m - axis * dot(axis, shift - Vec3{0, 0, 0.6});
    }
    if (motion == Motion::half_turns) {  // motions of 180 degrees about z, seen from two sides
      pose.rotation = quaternion_of_rotation_vector({0, 0, index % 2 == 0 ? 0.0 : pi}) *
                      quaternion_of_rotation_vector({index % 4 < 2 ? 0.5 : -0.5, 0.1 * (index % 3), 0}) * pose.rotation;
    }
    pose.translation_m = pose.translation_m - pose.rotate(middle);
    return pose;
  }

  std::vector<he::View> views(std::uint64_t seed) const {
    Random random(seed, 7);
    std::vector<he::View> list;
    const he::Setup s = setup();
    for (int i = 0; i < poses; ++i) {
      const auto pose = true_pose(random, i);
      const auto stand_from_mount = truth.stand_from_board * inverse(pose) * inverse(truth.mount_from_camera);
      Rigid<frame::Base, frame::Tool> tool{stand_from_mount.rotation, stand_from_mount.translation_m};
      if (kind == he::Kind::eye_to_hand) {
        const auto other = inverse(stand_from_mount);
        tool = {other.rotation, other.translation_m};
      }
      const Vec3 w{random.normal(), random.normal(), random.normal()},
          d{random.normal(), random.normal(), random.normal()};
      tool.rotation = normalized(quaternion_of_rotation_vector(w * robot_rad) * tool.rotation);
      tool.translation_m += d * robot_m;
      he::View view{"view-" + std::to_string(i), tool, pose, {}};
      for (int k = 0; k < columns * rows; ++k) {
        const Vec2 at{k % columns * square_m, static_cast<double>(k / columns) * square_m};
        const Vec3 p = pose * Vec3{at.x, at.y, 0};
        const double x = p.x / p.z, y = p.y / p.z, r = 1 + s.lens.distortion[0] * (x * x + y * y);
        const double u = random.normal(), v = random.normal();
        view.corners.push_back(
            {at,
             {s.lens.fx_px * x * r + s.lens.cx_px + u * corner_px, s.lens.fy_px * y * r + s.lens.cy_px + v * corner_px},
             claimed_px});
      }
      view.camera_from_board.translation_m += Vec3{0.001, -0.001, 0.002};  // a start that is a little off
      view.camera_from_board = he::pose_by_camera(s, view);
      list.push_back(view);
    }
    return list;
  }
};

inline std::vector<he::PoseSample> exact_samples(HandEyeWorld world, std::uint64_t seed) {
  world.corner_px = 0;
  world.robot_m = world.robot_rad = 0;
  return he::samples_of(world.setup(), world.views(seed));
}

// [turn, shift] from the truth to an estimate, on the left as in covariances.
template <class To, class From>
std::vector<double> error_of(const Rigid<To, From>& found, const Rigid<To, From>& truth) {
  const Vec3 turn = rotation_vector_of(found.rotation * conjugate(truth.rotation));
  const Vec3 shift = found.translation_m - truth.translation_m;
  return {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z};
}

}  // namespace gonio::tests
