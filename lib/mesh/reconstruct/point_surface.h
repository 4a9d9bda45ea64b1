// What surface measured points show beside any place: a quadratic over the tangent plane, by least squares weighted
// with the points' own variances along the normal, over as wide a neighbourhood as they bear.
//
// The neighbourhood grows while the height and both slopes agree with those of all narrower ones (intersection of
// confidence intervals, Goldenshluger & Nemirovski 1997) and while what the quadratic leaves is the noise's. The
// variance is that of the fit, more where even the narrowest one leaves more than noise. Points that were seen from
// behind the surface belong to another one, and do not count.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/reconstruct.h"
#include "mesh/reconstruct/point_tree.h"

namespace gonio::mesh {

struct PointFit {
  Vec3 point{}, normal{};
  double sigma_m = 0;        // along the normal
  double point_sigma_m = 0;  // of one point about here, likewise
  double leverage = 0;       // of the place, variance over that of one point: more than 1 beside all points
  bool good = false;         // no: too few points, or all on a line
};

class PointSurface {
 public:
  // Keeps references to both.
  PointSurface(const MeasuredPoints& points, const PointTree& tree);
  // Of the plane through the nearest points, turned to the point's camera.
  Vec3 plane_normal(std::uint32_t point) const;
  PointFit fit(Vec3 at, Vec3 normal) const;

  double spacing_m() const { return spacing_m_; }                             // median over all points
  double spacing_m(std::uint32_t point) const { return spacings_m_[point]; }  // from its sixth neighbour
  double noise_ratio() const { return noise_ratio_; }             // what points scatter by, over what they state; >= 1
  double variance_m2(std::uint32_t point, Vec3 direction) const;  // as stated, along a unit direction
  Vec3 towards_camera(std::uint32_t point) const;

 private:
  const MeasuredPoints& points_;
  const PointTree& tree_;
  std::vector<double> spacings_m_;
  double spacing_m_ = 0, noise_ratio_ = 1;
};

// Unit normal of the least-squares plane through `members`; which of both sides is open.
Vec3 normal_of_plane(const PointTree& points, const std::vector<PointTree::Neighbour>& members);

}  // namespace gonio::mesh
