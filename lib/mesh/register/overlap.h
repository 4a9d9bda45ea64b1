// Residuals between two views, and the sums over them that motions and figures are made of.
//
// A small motion of the point's view about `centre_m` is x = (length * rotation vector, translation): its entries are
// metres by which points move. Residual r = d + J x, J = ((p - centre) x n / length, n); of the surface's view, -x.
#pragma once
#include <Eigen/Core>
#include <compare>
#include <map>

#include "mesh/register.h"
#include "mesh/register/view_surface.h"

namespace gonio::mesh {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct OverlapPoint {
  OverlapResidual residual{};
  std::uint32_t point = 0;         // of the view
  double weight = 1;               // of the loss
  Vec3 normal{};                   // in the world, of the surface
  std::array<Vec3, 2> tangents{};  // of its error, with these variances: ViewFit
  std::array<double, 3> slope_covariance{};
};

struct ViewOverlap {
  std::size_t view = 0, other = 0;
  std::vector<OverlapPoint> points;
  std::size_t asked = 0;  // samples of `view`
};

// From `view` to the surface of `other`, both moved.
ViewOverlap overlap_of(const std::vector<ViewSurface>& surfaces, const std::vector<ViewMotion>& motions,
                       std::size_t view, std::size_t other, double reach_m);

// Views in ascending order, and their overlaps in both directions.
std::map<std::pair<std::size_t, std::size_t>, std::vector<const ViewOverlap*>> by_pair(
    const std::vector<ViewOverlap>& overlaps);

// By that much points of the two views may lie apart and still be taken as the same place of one surface.
double usual_reach_m(const std::vector<ViewSurface>& surfaces);

struct Patch {  // cell of a grid in the world
  int x = 0, y = 0, z = 0;
  auto operator<=>(const Patch&) const = default;
};
struct PatchSums {
  double residuals = 0, squares = 0;  // squares: of residuals over their sigma, weighted
  Vector6 pull = Vector6::Zero();     // -J'W d
  Matrix6 squared = Matrix6::Zero();  // J'W J
};
// Of two views, both directions together; x is the motion of `first` against `second`.
struct PairSums {
  std::size_t first = 0, second = 0;
  PatchSums all;
  Matrix6 by_noise = Matrix6::Zero();  // what errors of the normals alone add to `all.squared`
  std::map<Patch, PatchSums> patches;
};

struct MotionScale {
  Vec3 centre_m{};
  double length_m = 1;  // rms distance of the points from there
  double patch_m = 1;
};
// Patches hold several fits' width, and there are some hundred where points allow it.
MotionScale scale_of(const std::vector<ViewOverlap>& overlaps, const std::vector<ViewSurface>& surfaces);

// Huber's weights, `width` in robust standard deviations of the pair.
void weigh(std::vector<ViewOverlap>& overlaps, double width);
std::vector<PairSums> sums_of(const std::vector<ViewOverlap>& overlaps, const MotionScale& scale);

Vector6 slopes_of(Vec3 at, Vec3 normal, const MotionScale& scale);  // J

}  // namespace gonio::mesh
