// Spheres and planes through measured points, and how sure they are.
//
// Least squares of the distances to the surface (orthogonal regression): a sphere by Gauss-Newton steps from its
// algebraic fit, a plane by the eigenvectors of the points' scatter. As VDI/VDE 2634 part 2 allows, up to 0.3 % of the
// points are left out: those that lie farthest from the surface, and only beyond three robust standard deviations
// (1.4826 times the median absolute deviation); then the surface is fitted anew, until the same points stay out.
//
// Uncertainty: neighbouring points of a scanner err together. The covariance is the cluster-robust one, A^-1 (sum over
// cells s s') A^-1 G / (G - p), s the sum of a cell's scores (Liang & Zeger, Biometrika 73(1), 1986; White 1980 for
// cells of one point), with cells of about 1/8 of the cloud's extent. It is honest for errors that are independent, and
// for those that are correlated over less than a cell; a form error of the whole surface is a bias that no scatter
// shows.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"

namespace gonio::metrology {

inline constexpr double rejected_share = 0.003, rejected_sigmas = 3;

struct Deviations {  // signed distances of all points, outside (or along the normal) positive
  std::vector<double> kept_m;
  std::vector<double> rejected_m;  // at most 0.3 %
  double still_beyond = 0;         // share of all points beyond three robust sigmas that had to stay
};
struct SphereFit {
  Vec3 centre_m;
  double radius_m = 0;
  std::array<double, 16> covariance{};  // of centre x, y, z and radius, m^2, row-major; held radius: zeros
  Deviations deviations;
  double radius_sigma_m() const { return std::sqrt(covariance[15]); }
};
struct PlaneFit {
  Vec3 centroid_m, normal;                 // normal: towards the origin, where the scanner is
  double offset_sigma_m = 0;               // of the plane's place at the centroid
  std::array<double, 2> tilt_sigma_rad{};  // about the two principal axes of the points, longer first
  Deviations deviations;
};

// Error(data) at `place` where the points do not determine the surface: too few, in a line, in a plane, too small a
// cap.
SphereFit fit_sphere(std::span<const Vec3> points_m, std::optional<double> held_radius_m, const std::string& place);
PlaneFit fit_plane(std::span<const Vec3> points_m, const std::string& place);

}  // namespace gonio::metrology
