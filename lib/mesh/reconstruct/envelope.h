// The envelope of what was seen: light came straight from every point to the cameras and projectors that saw it, so the
// space between is empty, and no surface stands there.
//
// Each viewpoint gets a picture of its points' nearest distances, on a plane before it, with pixels as wide as its
// points lie apart. A place was seen through where its pixel and all eight about it hold points, and all of them lie
// farther away, by more than `margin`. A place beside the points' pictures, or behind any of them, may hold anything.
#pragma once
#include <vector>

#include "mesh/reconstruct.h"

namespace gonio::mesh {

class Envelope {
 public:
  explicit Envelope(const MeasuredPoints& points);
  bool seen_through(Vec3 place_m, double margin_m) const;

 private:
  struct Picture {
    Vec3 viewpoint{};
    Basis basis{{0, 0, 1}};  // n: the way it looks
    double left = 0, low = 0, pixel = 1;
    int width = 0, height = 0;
    std::vector<float> nearest;  // distance along n, of the points in a pixel; 0: none
  };
  static Picture picture_of(const MeasuredPoints& points, Vec3 viewpoint, const std::vector<std::uint32_t>& members);
  static bool sees_through(const Picture& picture, Vec3 place_m, double margin_m);

  std::vector<Picture> pictures_;
};

}  // namespace gonio::mesh
