// Profiles along the normals of a contour, and what the edges of one volume share: the parts of edges() (threshold.h).
#pragma once
#include <cmath>
#include <map>
#include <vector>

#include "volume/contour_shape.h"
#include "volume/sampling.h"
#include "volume/threshold.h"

namespace gonio::volume {

// Values along a normal, from behind the wall to before it, as far as one edge goes or two that are too near: means
// over the voxels of a cylinder round the normal, by their distance from the surface through the vertex.
struct EdgeProfile {
  std::size_t vertex = 0;
  Place place{};
  double mean_curvature = 0, sharpest = 0;      // sharpest: the largest of the two curvatures, whatever its sign
  std::vector<double> s{}, values{}, voxels{};  // voxels: that a mean is of
  std::vector<double> covariance{};             // of the means for a noise of one, row by row
  double inward = 0, outward = 0;               // distances to the next walls
  std::optional<double> inner{}, outer{};       // walls that are fitted too
  bool alone() const { return !inner && !outer; }
};
// Fills s, values, voxels and covariance with the voxels whose distance from the surface lies between `first` and
// `last`. Nothing is interpolated, so that edges are no wider than the volume has them, and a cylinder's voxels say
// more than the few round one line.
void pool_voxels(const Block& block, const LocalShape& shape, double first, double last, Vec3 scale,
                 double noise_correlation, EdgeProfile& into);
constexpr double pool_radius = edges_alike_voxels / 2;
constexpr double pool_step = 0.25;    // voxels along the normal that one mean is of

// What edges near one another, and facing alike, have in common: means over boxes of ten voxels and the boxes round.
class EdgeNeighbours {
 public:
  struct Plateaus {
    Known air{}, object{};
    double slope = 0;
  };
  void add(const EdgeProfile& profile, const Edge& edge, Vec3 scale);
  std::optional<Plateaus> near(const Place& place, Vec3 scale) const;

 private:
  struct Sums {
    double count = 0, weight = 0, air = 0, air2 = 0, object = 0, object2 = 0;
    double noise_air = 0, noise_object = 0;  // sums of weighted variances of the fits
    double slopes = 0, slope = 0;
  };
  using Key = std::array<int, 4>;
  static Key key_of(const Place& place, Vec3 scale);
  std::map<Key, Sums> boxes_{};
};

// The sd of the spread function, which need not be the same along the rotation axis (k) as across it: a detector's rows
// are not what a reconstruction's kernel does within a slice.
struct EdgeSpread {
  double across2 = 0, along2 = 0;  // squares, voxels^2
  double share = 0;                // sd of the width, as a share of it
  double width(Vec3 normal) const { return std::sqrt(across2 + (along2 - across2) * normal.z * normal.z); }
};

struct EdgeCommon {
  EdgeSpread spread{};
  double noise = 0;
  EdgeNeighbours neighbours{};
};

// With nothing known beyond `wish`, or with what edges share.
Edge fit_profile(const EdgeProfile& profile, const EdgeWish& wish, const EdgeCommon* common,
                 bool slope_is_free = false);
EdgeCommon common_of(const std::vector<EdgeProfile>& scouts, const EdgeWish& wish);

}  // namespace gonio::volume
