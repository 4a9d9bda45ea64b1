// How wide the edge of a shadow is in the photograph itself, point by point along its rim.
//
// A lamp that is seen as a disc of radius r lets go of the ground's light along a semicircle's integral:
//   y(t) = dark + slope t + (lit - dark) F((t - c) / w),   F(u) = 1/2 + (u sqrt(1 - u^2) + asin u) / pi,
// t across the rim, px, positive outwards. The spread is the standard deviation of what F is the integral of, w / 2. A
// lens' blur is told by the same family, a quarter too narrow. Levels and slope are eliminated (variable
// projection, Golub & Pereyra 1973); the window grows until it holds the whole edge.
#pragma once
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "alignment/observed_rim.h"
#include "io/image.h"

namespace gonio::alignment {

// The mean of a picture's first three channels, or its only one.
class Luminance {
 public:
  explicit Luminance(const io::Image& picture);
  Luminance(int width, int height, std::vector<float> value)
      : width_(width), height_(height), value_(std::move(value)) {}
  // Between pixels, straight (bilinear); NaN within a pixel of the border and beyond.
  double at(Vec2 pixel) const;

 private:
  int width_, height_;
  std::vector<float> value_;
};

// One per point, px; NaN for points that do not count, beside which `hidden` says that something else is in the way,
// and where no such edge is: the shadow's side has to be the darker one. One point in three is asked.
std::vector<double> edge_spreads(const Luminance& picture, std::span<const RimPoint> points,
                                 const std::function<bool(Vec2)>& hidden);

}  // namespace gonio::alignment
