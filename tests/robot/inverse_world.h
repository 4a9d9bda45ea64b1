// What the tests of inverse kinematics share: random joints, arms with a factory calibration, what answers must be.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/random.h"
#include "base/text.h"
#include "robot/inverse/inverse_kinematics.h"

namespace gonio::robot::inverse_world {

inline Joints random_joints(Random& random) {
  Joints joints;
  for (double& q : joints) q = random.uniform(-pi, pi);
  return joints;
}

inline double wrapped_difference(const Joints& a, const Joints& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 6; ++i) largest = std::max(largest, std::abs(std::remainder(a[i] - b[i], 2 * pi)));
  return largest;
}

inline const JointAnswer* nearest(const std::vector<JointAnswer>& answers, const Joints& joints) {
  const JointAnswer* best = nullptr;
  for (const JointAnswer& a : answers)
    if (best == nullptr || wrapped_difference(a.joints_rad, joints) < wrapped_difference(best->joints_rad, joints))
      best = &a;
  return best;
}

struct Miss {
  double position_m = 0, rotation_rad = 0;
};
// By the forward kinematics of the rows, which the inverse does not use.
inline Miss miss_of(std::span<const Link> links, const Joints& joints, const Rigid<frame::Base, frame::Tool>& pose) {
  const auto there = flange(links, joints);
  return {norm(there.translation_m - pose.translation_m),
          norm(rotation_vector_of(conjugate(pose.rotation) * there.rotation))};
}

// Statistics over poses of random joints.
struct Tally {
  int poses = 0, lost = 0, repeated = 0, wrong_branch = 0;
  double worst_m = 0, worst_rad = 0;
  std::vector<int> of_count = std::vector<int>(20);  // poses with that many answers

  // Every answer reaches the pose, the joints that made it are among them, no two are equal.
  void take(const InverseKinematics& inverse, std::span<const Link> links, const Joints& joints) {
    const auto pose = flange(links, joints);
    const std::vector<JointAnswer> answers = inverse.solve(pose);
    ++poses;
    ++of_count[std::min<std::size_t>(answers.size(), 19)];
    const JointAnswer* own = nearest(answers, joints);
    // Beside a singular posture angles are known to the root of rounding.
    const bool is_lost = own == nullptr || !own->exact || wrapped_difference(own->joints_rad, joints) > 1e-5;
    lost += is_lost;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (!answers[i].exact) continue;
      const Miss miss = miss_of(links, answers[i].joints_rad, pose);
      worst_m = std::max(worst_m, miss.position_m), worst_rad = std::max(worst_rad, miss.rotation_rad);
      wrong_branch += inverse.branch_of(answers[i].joints_rad) != answers[i].branch;
      if (i == 0) continue;
      repeated += wrapped_difference(answers[i].joints_rad, answers[i - 1].joints_rad) < 1e-7;
      repeated += answers[i].branch >= 0 && answers[i].branch == answers[i - 1].branch;
    }
  }
  std::string words() const {
    std::string w =
        format("%d poses, %d lost, %d repeated, %d of another branch, worst %.2g m %.2g rad; answers:", poses, lost,
               repeated, wrong_branch, worst_m, worst_rad);
    for (std::size_t i = 0; i < of_count.size(); ++i)
      if (of_count[i] > 0) w += format(" %zu: %d", i, of_count[i]);
    return w;
  }
};

// Poses an arm: a few thousand, or as many as GONIO_INVERSE_POSES says.
inline int poses_of_a_run(int usual) {
  const char* given = std::getenv("GONIO_INVERSE_POSES");
  return given != nullptr ? std::atoi(given) : usual;
}

}  // namespace gonio::robot::inverse_world
