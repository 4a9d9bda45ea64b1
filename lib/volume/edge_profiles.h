// Profiles along the normals of a contour, and what the edges of one volume share: the parts of edges() (threshold.h).
#pragma once
#include <map>
#include <vector>

#include "volume/contour_shape.h"
#include "volume/sampling.h"
#include "volume/threshold.h"

namespace gonio::volume {

// Values along a normal, from behind the wall to before it, as far as one edge goes or two that are too near.
struct EdgeProfile {
  std::size_t vertex = 0;
  Place place{};
  double mean_curvature = 0;
  std::vector<double> s{}, values{};
  double inward = 0, outward = 0;          // distances to the next walls
  std::optional<double> inner{}, outer{};  // walls that are fitted too
  bool alone() const { return !inner && !outer; }
};

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

struct EdgeCommon {
  double width = 0, noise = 0;
  EdgeNeighbours neighbours{};
};

// With nothing known beyond `wish`, or with what edges share.
Edge fit_profile(const EdgeProfile& profile, const EdgeWish& wish, const EdgeCommon* common,
                 bool slope_is_free = false);
EdgeCommon common_of(const std::vector<EdgeProfile>& scouts, const EdgeWish& wish);

}  // namespace gonio::volume
