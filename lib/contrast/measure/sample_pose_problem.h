// What locate_sample() minimises (sample_pose.h), as a Model of room optim. For sources of this folder and for
// scripts/bench ceres.
//
// Parameters: the sample's pose as a quaternion and a shift, then six numbers for the error of every stated pose in
// `free`. Changes: a turn about the pattern's middle and a shift of that middle, then those six numbers each.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contrast/measure/sample_pose.h"
#include "optim/least_squares.h"

namespace gonio::contrast {

// A small turn about the axes of `To` through `pivot`, and a shift.
template <class To, class From>
Rigid<To, From> turned_about(const Rigid<To, From>& pose, const double* step, Vec3 pivot) {
  const Quaternion turn = quaternion_of_rotation_vector({step[0], step[1], step[2]});
  const Vec3 shift{step[3], step[4], step[5]};
  return {normalized(turn * pose.rotation), matrix_of(turn) * (pose.translation_m - pivot) + pivot + shift};
}
Vec3 pattern_corner(const CellPattern& pattern, int k);
Vec3 pattern_middle(const CellPattern& pattern);

struct SamplePoseProblem final : optim::Model {
  using Pose = Rigid<frame::World, frame::Object>;

  SamplePoseProblem(const CellPattern& of, const std::vector<camera::CameraModel>& seen_by,
                    const std::vector<CameraPose>& stated, const std::vector<PlacedMark>& seen);

  const CellPattern& pattern;
  const std::vector<camera::CameraModel>& cameras;
  const std::vector<CameraPose>& poses;
  const std::vector<PlacedMark>& marks;
  std::vector<std::size_t> free;  // images whose pose may move: those with marks, ascending

  Eigen::VectorXd parameters(const Pose& sample) const;  // no error of any stated pose
  static Pose pose(const Eigen::VectorXd& parameters);

  // False where a corner lies behind its camera.
  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const override;
  Eigen::Index freedoms(const Eigen::VectorXd& x) const override { return x.size() - of_pose + 6; }
  Eigen::VectorXd moved(const Eigen::VectorXd& x, const Eigen::VectorXd& change) const override;
  double difference(const Eigen::VectorXd&, Eigen::Index) const override { return 1e-6; }

 private:
  static constexpr Eigen::Index of_pose = 7;
};

}  // namespace gonio::contrast
