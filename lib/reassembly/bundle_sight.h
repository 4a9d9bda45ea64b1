// One sighting of a sphere as three numbers in the world: two tangents of its axis and its half angle; and where
// several of them meet. For sources of this folder.
//
//   across = e.U / e.A,  down = e.W / e.A,  half angle = asin(rho / d)      e = (x - c) / d
//
// for a sphere at x of radius rho, a camera at c, the measured axis A and its tangents U, W. The camera's own
// uncertainty is one small motion (rotation, place) at its centre.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>

#include "reassembly/place.h"

namespace gonio::reassembly {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct Sight {
  Eigen::Vector3d origin, axis, across, down;  // world
  double half_angle = 0;
  bool sized = false;          // the half angle counts
  Eigen::Matrix3d covariance;  // of (across, down, half angle); where it does not count, its row is that of 1
  Matrix6 pose;                // covariance of the camera's
  bool firm = true;            // pose is zero
  double px_per_rad = 0;       // 0: not known
};
// Error(data) at `place` where a covariance is not positive definite or a number not finite.
Sight sight_of(const View& view, const Outline& outline, const std::string& place);
Sight moved(Sight sight, const Eigen::Matrix<double, 6, 1>& small_motion);  // with its camera

struct Misfit {  // predicted less measured
  Eigen::Vector3d r;
  Eigen::Matrix3d by_point;
  Eigen::Vector3d by_radius;
  Eigen::Matrix<double, 3, 6> by_pose;  // of the camera
};
// False where the point lies behind the camera, or the camera within the sphere.
bool misfit(const Sight& sight, const Eigen::Vector3d& point, double radius, Misfit& out);

// L with L L' = a, lower triangle; of a matrix that is not positive definite it is not finite.
Eigen::Matrix3d lower_root(const Eigen::Matrix3d& a);
Eigen::Matrix3d lower_inverse(const Eigen::Matrix3d& lower);
// The half angle is what blur and a part that is hidden distort first: beyond this many deviations it pulls linearly.
inline constexpr double size_width = 2.5;
double size_weight(double whitened);
double size_cost(double whitened);

struct Meeting {
  Eigen::Vector3d centre;
  Eigen::Matrix3d covariance;
  double radius = 0;   // as given, or as the half angles say
  bool sized = false;  // a radius is known
  double radius_variance = 0;
  double chi_square = 0;
  int degrees = 0;
};
// Nothing where the rays do not meet before the cameras, or are too near to parallel for their uncertainty. The search
// begins at `start`, by default at the point nearest to all rays; one sight alone of a known radius needs it.
std::optional<Meeting> meet(std::span<const Sight* const> sights, std::optional<double> radius,
                            std::optional<Eigen::Vector3d> start = {});

}  // namespace gonio::reassembly
