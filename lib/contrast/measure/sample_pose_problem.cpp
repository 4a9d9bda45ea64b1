#include "contrast/measure/sample_pose_problem.h"

#include <algorithm>

namespace gonio::contrast {

Vec3 pattern_corner(const CellPattern& pattern, int k) {
  const Vec2 p = pattern.corner_m(k);
  return {p.x, p.y, 0};
}

Vec3 pattern_middle(const CellPattern& pattern) {
  const Vec2 size = pattern.size_m();
  return {size.x / 2, size.y / 2, 0};
}

SamplePoseProblem::SamplePoseProblem(const CellPattern& of, const std::vector<camera::CameraModel>& seen_by,
                                     const std::vector<CameraPose>& stated, const std::vector<PlacedMark>& seen)
    : pattern(of), cameras(seen_by), poses(stated), marks(seen) {
  for (const PlacedMark& mark : marks) free.push_back(mark.image);
  std::ranges::sort(free);
  free.erase(std::ranges::unique(free).begin(), free.end());
}

Eigen::VectorXd SamplePoseProblem::parameters(const Pose& sample) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(of_pose + 6 * static_cast<Eigen::Index>(free.size()));
  const auto& [q, t] = sample;
  x.head<of_pose>() << q.w, q.x, q.y, q.z, t.x, t.y, t.z;
  return x;
}

SamplePoseProblem::Pose SamplePoseProblem::pose(const Eigen::VectorXd& x) {
  return {{x[0], x[1], x[2], x[3]}, {x[4], x[5], x[6]}};
}

Eigen::VectorXd SamplePoseProblem::moved(const Eigen::VectorXd& x, const Eigen::VectorXd& change) const {
  const Pose sample = pose(x);
  Eigen::VectorXd next = parameters(turned_about(sample, change.data(), sample * pattern_middle(pattern)));
  next.tail(x.size() - of_pose) = x.tail(x.size() - of_pose) + change.tail(x.size() - of_pose);
  return next;
}

bool SamplePoseProblem::residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const {
  r.resize(static_cast<Eigen::Index>(2 * marks.size() + 6 * free.size()));
  const Pose sample = pose(x);
  Eigen::Index row = 0;
  for (const PlacedMark& mark : marks) {
    const auto slot = std::ranges::lower_bound(free, mark.image) - free.begin();
    const auto seen = poses[mark.image].camera_from_world * sample;
    const auto with_error = turned_about(seen, x.data() + of_pose + 6 * slot, {});
    const auto at = cameras[mark.image].project(with_error * pattern_corner(pattern, mark.corner));
    if (!at) return false;
    r(row++) = (at->x - mark.pixel.x) / mark.sigma_px;
    r(row++) = (at->y - mark.pixel.y) / mark.sigma_px;
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    const CameraPose& stated = poses[free[i]];
    for (Eigen::Index k = 0; k < 6; ++k)
      r(row++) =
          x[of_pose + 6 * static_cast<Eigen::Index>(i) + k] / std::max(k < 3 ? stated.sigma_rad : stated.sigma_m, 1e-9);
  }
  return true;
}

}  // namespace gonio::contrast
