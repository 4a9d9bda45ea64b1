// One view's points, and the surface that they show beside any place: a quadratic over the tangent plane of a fixed
// number of nearest points, weighted with their stated variances, so that its covariance is theirs. The number is the
// smallest of a few for which slopes are known well enough to tell a normal.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mesh/reconstruct.h"
#include "mesh/reconstruct/point_tree.h"

namespace gonio::mesh {

struct ViewFit {
  Vec3 point{}, normal{};                    // the normal towards the camera
  double variance_m2 = 0;                    // of the surface along it, as stated
  std::array<Vec3, 2> tangents{};            // the normal's error: sum of tangent times
  std::array<double, 3> slope_covariance{};  // slopes with these (uu, uv, vv), as found
  bool good = false;                         // no: a fold, a border, too few points
};

// By how much the surface's place along the normal moves with a point's.
struct FitMember {
  std::uint32_t point = 0;
  double share = 0;
};

class ViewSurface {
 public:
  struct Sample {
    std::uint32_t point = 0;
    Vec3 normal{};
  };
  // Of `points` those of `view`; at most `samples` of them, where the surface is good.
  ViewSurface(const MeasuredPoints& points, std::uint32_t view, std::size_t samples, std::uint64_t seed);

  ViewFit fit(Vec3 at, std::vector<FitMember>* members = nullptr) const;
  double variance_m2(std::uint32_t point, Vec3 direction) const;
  Vec3 operator[](std::uint32_t point) const { return tree_[point]; }
  Vec3 camera_m() const { return camera_m_; }
  const std::vector<Sample>& samples() const { return samples_; }
  double nearest_m(Vec3 at) const;
  double spacing_m() const { return spacing_m_; }
  double radius_m() const { return radius_m_; }  // usual, of a fit's points
  double sigma_m() const { return sigma_m_; }    // usual, of a point in its worst direction
  bool may_reach(Vec3 at, double reach_m) const;

 private:
  void choose_window();

  PointTree tree_;
  std::vector<std::array<double, 6>> covariance_m2_;
  Vec3 camera_m_, low_m_, high_m_;
  std::size_t window_ = 0;
  double spacing_m_ = 0, radius_m_ = 0, sigma_m_ = 0, chi_square_ = 1;
  std::vector<Sample> samples_;
};

}  // namespace gonio::mesh
