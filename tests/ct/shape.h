// Closed bodies by what a ray has of them: the pieces of the ray that lie within, exact for every shape, and the signed
// distance to the surface (negative inside), for truths.
//
// The distance of balls, cylinders, boxes, half-spaces, lathes and meshes is exact; that of ellipsoids to first order
// in the distance; that of combined shapes is exact where one of their surfaces is nearest and they do not meet within
// that distance, a bound elsewhere, and its zero set always is the surface.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "geom/vector.h"

namespace gonio::ct {

struct Ray {
  Vec3 origin, direction;  // direction of length 1
  Vec3 at(double t) const { return origin + direction * t; }
};

// Disjoint intervals of t in ascending order.
class Spans {
 public:
  static constexpr int most = 24;
  void clear() { count_ = 0; }
  void add(double enter, double leave) {  // behind all others
    if (!(leave > enter)) return;
    if (count_ == most) throw std::length_error("a ray meets a shape more often than simulated");
    ends_[2 * count_] = enter, ends_[2 * count_ + 1] = leave, ++count_;
  }
  int count() const { return static_cast<int>(count_); }
  double enter(int k) const { return ends_[2 * static_cast<std::size_t>(k)]; }
  double leave(int k) const { return ends_[2 * static_cast<std::size_t>(k) + 1]; }
  double length() const {
    double sum = 0;
    for (std::size_t k = 0; k < count_; ++k) sum += ends_[2 * k + 1] - ends_[2 * k];
    return sum;
  }

 private:
  std::size_t count_ = 0;
  std::array<double, 2 * most> ends_;
};
enum class Combine { unite, intersect, subtract };
Spans combined(const Spans& a, const Spans& b, Combine how);

struct Ball {
  Vec3 centre{};
  double radius = 0;
};

class Shape {
 public:
  virtual ~Shape() = default;
  virtual void cut(const Ray& ray, Spans& into) const = 0;  // `into` is empty
  virtual double distance(Vec3 p) const = 0;
  virtual Ball bound() const = 0;  // infinite radius: none
};
using ShapePtr = std::shared_ptr<const Shape>;

ShapePtr ball(Vec3 centre, double radius);
ShapePtr ellipsoid(Vec3 centre, Vec3 radii);
ShapePtr cylinder(Vec3 from, Vec3 to, double radius);  // with flat ends
ShapePtr box(Vec3 centre, Vec3 half);
ShapePtr half_space(Vec3 point, Vec3 outward);
// A closed polygon of (r, z), r >= 0, turned round the z axis through `base`. Sides on the axis are no surface.
ShapePtr lathe(Vec3 base, std::vector<Vec2> profile);
ShapePtr turned(ShapePtr shape, const Mat3& rotation, Vec3 shift);  // p -> rotation p + shift
ShapePtr united(std::vector<ShapePtr> shapes);
ShapePtr shared(ShapePtr a, ShapePtr b);   // intersection
ShapePtr without(ShapePtr a, ShapePtr b);  // difference
// A closed, oriented triangle mesh (counter-clockwise seen from outside).
ShapePtr of_mesh(std::vector<Vec3> positions, std::vector<std::array<std::uint32_t, 3>> triangles);

// Rotation by `angle` about a unit axis.
Mat3 rotation_about(Vec3 axis, double angle);

}  // namespace gonio::ct
