// Cosines that other parts of a known shape send on to a point. Private to clouds/.
//
// The shape is matt and of one albedo. Of a pattern exp(i theta) that the projector shows, a point p sends on
//   E(p) exp(i theta(p)) + sum over n >= 1 of albedo^n mean of E(q_n) exp(i theta(q_n)),
// E the irradiance by the projector, zero in its shadow, and q_1, ..., q_n the points that a path meets which leaves p
// in a direction spread by its cosine, and every further point likewise (Kajiya 1986; the cosine and 1 / pi of the
// matt law are that spread). What stands here are those means over E(p) exp(i theta(p)), which know no albedo; of the
// rig and shapes as stated.
#pragma once
#include <complex>
#include <span>
#include <vector>

#include "explain/clouds/cloud_shape.h"
#include "scan/triangulate.h"

namespace gonio::explain {

class IndirectLight {
 public:
  static constexpr std::size_t bounces = 4;
  struct Point {  // of the shape, rig frame
    Vec3 at, normal;
    Vec2 told;  // the projector's pixel
  };
  IndirectLight() = default;  // of a shape that does not light itself
  // `periods_x`, `periods_y`: numbers of periods that are shown along each axis of the projector's picture.
  IndirectLight(const CloudShape& shape, std::span<const Point> points, const scan::Station& projector,
                std::span<const double> periods_x, std::span<const double> periods_y);

  bool any() const { return any_; }
  // Share of directions in which the point meets another part, 0 to 1.
  double hidden(std::size_t point) const { return any_ ? hidden_[point] : 0; }
  // By how much the phase is turned, radians.
  double turn(std::size_t point, std::size_t axis, std::size_t periods, double albedo) const;

 private:
  struct Series {
    std::array<std::complex<double>, bounces> term{};
  };
  bool any_ = false;
  std::array<std::size_t, 2> counts_{};
  std::vector<Series> series_;  // point by point, those of x before those of y
  std::vector<double> hidden_;
};

}  // namespace gonio::explain
