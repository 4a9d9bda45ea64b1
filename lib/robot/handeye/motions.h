// Samples in canonical order and the motions between all pairs of them, as the closed forms take them. For sources of
// this folder only.
//
// A motion from sample j to sample i: A = (stand_from_mount j)^-1 (stand_from_mount i) in the mount's frame and
// B = (camera_from_board j) (camera_from_board i)^-1 in the camera's, A X = X B. Their quaternions have the signs under
// which they are most nearly conjugate: q_a x = x q_b. Lengths are divided by `length_m`, the size of the motions, so
// that equations for rotations and for lengths weigh alike whatever the unit.
#pragma once
#include <vector>

#include "robot/handeye/matrices.h"
#include "robot/handeye/samples.h"

namespace gonio::robot::handeye {

struct Motion {
  Eigen::Vector4d a, b;  // quaternions w, x, y, z
  Matrix3 rotation_a, rotation_b;
  Vector3 shift_a, shift_b;  // in units of length_m
};
struct Motions {
  std::vector<PoseSample> samples;
  std::vector<Motion> pairs;
  double length_m = 1;
};
Motions motions_of(std::span<const PoseSample> samples);

// Camera's place on the mount from its rotation: (R_A - 1) t = R_X t_B - t_A over all pairs, least squares.
Rigid<Mount, frame::Camera> with_translation(const Motions& motions, const Matrix3& rotation_x);
// Adds the board's place: the mean of where the samples see it (rotations: eigenvector of summed quaternions, Markley
// et al., J. Guidance 30(4), 2007).
Solution with_board(const Motions& motions, const Rigid<Mount, frame::Camera>& mount_from_camera);
// Both places from both rotations: t_Z - R_A t_X = t_A - R_Z t_B over all samples, least squares.
Solution with_translations(const Motions& motions, const Matrix3& rotation_x, const Matrix3& rotation_z);

// Quaternion products as matrices: left(p) q = p q, right(q) p = p q.
Eigen::Matrix4d left_product(const Eigen::Vector4d& p);
Eigen::Matrix4d right_product(const Eigen::Vector4d& q);
Matrix3 rotation_of(const Eigen::Vector4d& quaternion);

Solution tsai(const Motions&);
Solution park(const Motions&);
Solution horaud(const Motions&);
Solution andreff(const Motions&);
Solution daniilidis(const Motions&);
Solution shah(const Motions&);
Solution li(const Motions&);

}  // namespace gonio::robot::handeye
