#include "ct/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::ct {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

// Ray against |p| = 1 in coordinates where the ray's parameter is unchanged.
bool unit_ball_crossings(Vec3 o, Vec3 d, double& enter, double& leave) {
  const double a = dot(d, d), b = dot(o, d), c = dot(o, o) - 1, root = b * b - a * c;
  if (!(root > 0)) return false;
  const double s = std::sqrt(root);
  enter = (-b - s) / a, leave = (-b + s) / a;
  return true;
}

class Ellipsoid final : public Shape {
 public:
  Ellipsoid(Vec3 centre, Vec3 radii) : centre_(centre), radii_(radii) {}
  void cut(const Ray& ray, Spans& into) const override {
    double enter = 0, leave = 0;
    if (unit_ball_crossings(scaled(ray.origin - centre_), scaled(ray.direction), enter, leave)) into.add(enter, leave);
  }
  double distance(Vec3 p) const override {
    const Vec3 q = p - centre_;
    if (radii_.x == radii_.y && radii_.y == radii_.z) return norm(q) - radii_.x;
    const double value = norm(scaled(q)), slope = norm(scaled(scaled(q)));  // of |q / radii|: slope / value
    return slope > 0 ? value * (value - 1) / slope : -std::min({radii_.x, radii_.y, radii_.z});
  }
  Ball bound() const override { return {centre_, max_component(radii_)}; }

 private:
  Vec3 scaled(Vec3 v) const { return {v.x / radii_.x, v.y / radii_.y, v.z / radii_.z}; }
  Vec3 centre_, radii_;
};

// lo <= value + slope t <= hi
void clip(double value, double slope, double lo, double hi, double& enter, double& leave) {
  if (slope == 0) {
    if (!(value >= lo && value <= hi)) leave = -endless;
    return;
  }
  const double a = (lo - value) / slope, b = (hi - value) / slope;
  enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
}

class Cylinder final : public Shape {
 public:
  Cylinder(Vec3 from, Vec3 to, double radius)
      : centre_((from + to) * 0.5), axis_(normalized(to - from)), half_(norm(to - from) / 2), radius_(radius) {}
  void cut(const Ray& ray, Spans& into) const override {
    const Vec3 o = ray.origin - centre_;
    const double oz = dot(o, axis_), dz = dot(ray.direction, axis_);
    const Vec3 across = o - axis_ * oz, slope = ray.direction - axis_ * dz;
    double enter = -endless, leave = endless;
    const double a = dot(slope, slope), b = dot(across, slope), c = dot(across, across) - radius_ * radius_;
    if (a > 1e-18) {
      const double root = b * b - a * c;
      if (!(root > 0)) return;
      enter = (-b - std::sqrt(root)) / a, leave = (-b + std::sqrt(root)) / a;
    } else if (c > 0) {
      return;
    }
    clip(oz, dz, -half_, half_, enter, leave);
    into.add(enter, leave);
  }
  double distance(Vec3 p) const override {
    const Vec3 q = p - centre_;
    const double z = dot(q, axis_), beyond = std::abs(z) - half_, wide = norm(q - axis_ * z) - radius_;
    return std::min(std::max(beyond, wide), 0.0) + std::hypot(std::max(beyond, 0.0), std::max(wide, 0.0));
  }
  Ball bound() const override { return {centre_, std::hypot(half_, radius_)}; }

 private:
  Vec3 centre_, axis_;
  double half_, radius_;
};

class Box final : public Shape {
 public:
  Box(Vec3 centre, Vec3 half) : centre_(centre), half_(half) {}
  void cut(const Ray& ray, Spans& into) const override {
    const Vec3 o = ray.origin - centre_;
    double enter = -endless, leave = endless;
    for (int axis = 0; axis < 3; ++axis) clip(o[axis], ray.direction[axis], -half_[axis], half_[axis], enter, leave);
    into.add(enter, leave);
  }
  double distance(Vec3 p) const override {
    const Vec3 q = p - centre_, over{std::abs(q.x) - half_.x, std::abs(q.y) - half_.y, std::abs(q.z) - half_.z};
    const Vec3 out{std::max(over.x, 0.0), std::max(over.y, 0.0), std::max(over.z, 0.0)};
    return std::min(max_component(over), 0.0) + norm(out);
  }
  Ball bound() const override { return {centre_, norm(half_)}; }

 private:
  Vec3 centre_, half_;
};

class HalfSpace final : public Shape {
 public:
  HalfSpace(Vec3 point, Vec3 outward) : normal_(normalized(outward)), offset_(dot(point, normal_)) {}
  void cut(const Ray& ray, Spans& into) const override {
    constexpr double far = 1e6;
    double enter = -far, leave = far;
    clip(dot(ray.origin, normal_) - offset_, dot(ray.direction, normal_), -endless, 0, enter, leave);
    into.add(enter, leave);
  }
  double distance(Vec3 p) const override { return dot(p, normal_) - offset_; }
  Ball bound() const override { return {{}, endless}; }

 private:
  Vec3 normal_;
  double offset_;
};

class Turned final : public Shape {
 public:
  Turned(ShapePtr shape, const Mat3& rotation, Vec3 shift)
      : shape_(std::move(shape)), forth_(rotation), back_(transposed(rotation)), shift_(shift) {}
  void cut(const Ray& ray, Spans& into) const override {
    shape_->cut({back_ * (ray.origin - shift_), back_ * ray.direction}, into);
  }
  double distance(Vec3 p) const override { return shape_->distance(back_ * (p - shift_)); }
  Ball bound() const override {
    const Ball b = shape_->bound();
    return {forth_ * b.centre + shift_, b.radius};
  }

 private:
  ShapePtr shape_;
  Mat3 forth_, back_;
  Vec3 shift_;
};

bool misses(const Ray& ray, const Ball& bound) {
  const Vec3 to = bound.centre - ray.origin;
  const double along = dot(to, ray.direction);
  return dot(to, to) - along * along > bound.radius * bound.radius;
}

class Combined final : public Shape {
 public:
  Combined(std::vector<ShapePtr> shapes, Combine how) : shapes_(std::move(shapes)), how_(how) {
    if (shapes_.empty()) throw std::invalid_argument("nothing to combine");
    for (const ShapePtr& s : shapes_) bounds_.push_back(s->bound());
    bound_ = whole();
  }
  void cut(const Ray& ray, Spans& into) const override {
    if (!misses(ray, bounds_[0])) shapes_[0]->cut(ray, into);
    for (std::size_t k = 1; k < shapes_.size(); ++k) {
      if (how_ != Combine::unite && into.count() == 0) return;
      Spans more;
      if (!misses(ray, bounds_[k])) shapes_[k]->cut(ray, more);
      if (how_ == Combine::intersect || more.count() > 0) into = combined(into, more, how_);
    }
  }
  double distance(Vec3 p) const override {
    double d = shapes_[0]->distance(p);
    for (std::size_t k = 1; k < shapes_.size(); ++k) {
      const double e = shapes_[k]->distance(p);
      d = how_ == Combine::unite ? std::min(d, e) : std::max(d, how_ == Combine::subtract ? -e : e);
    }
    return d;
  }
  Ball bound() const override { return bound_; }

 private:
  Ball whole() const {
    if (how_ == Combine::subtract) return bounds_[0];
    if (how_ == Combine::intersect)
      return *std::min_element(bounds_.begin(), bounds_.end(), [](auto& a, auto& b) { return a.radius < b.radius; });
    Vec3 lo{endless, endless, endless}, hi = -lo;
    for (const Ball& b : bounds_) {
      if (std::isinf(b.radius)) return b;
      const Vec3 r{b.radius, b.radius, b.radius}, l = b.centre - r, h = b.centre + r;
      lo = {std::min(lo.x, l.x), std::min(lo.y, l.y), std::min(lo.z, l.z)};
      hi = {std::max(hi.x, h.x), std::max(hi.y, h.y), std::max(hi.z, h.z)};
    }
    return {(lo + hi) * 0.5, norm(hi - lo) / 2};
  }

  std::vector<ShapePtr> shapes_;
  std::vector<Ball> bounds_;
  Ball bound_;
  Combine how_;
};

}  // namespace

// One walk over the ends of both: inside the result is a truth table of inside a and inside b.
Spans combined(const Spans& a, const Spans& b, Combine how) {
  Spans result;
  int ia = 0, ib = 0;  // next end: 2 k enters, 2 k + 1 leaves
  bool in_a = false, in_b = false, in = false;
  double from = 0;
  const auto end_of = [](const Spans& s, int end) { return end % 2 == 0 ? s.enter(end / 2) : s.leave(end / 2); };
  while (ia < 2 * a.count() || ib < 2 * b.count()) {
    const double ta = ia < 2 * a.count() ? end_of(a, ia) : endless, tb = ib < 2 * b.count() ? end_of(b, ib) : endless;
    const double t = std::min(ta, tb);
    if (ta <= tb) in_a = ia++ % 2 == 0;
    if (tb <= ta) in_b = ib++ % 2 == 0;
    const bool now = how == Combine::unite ? in_a || in_b : how == Combine::intersect ? in_a && in_b : in_a && !in_b;
    if (now && !in) from = t;
    if (!now && in) result.add(from, t);
    in = now;
  }
  return result;
}

ShapePtr ball(Vec3 centre, double radius) {
  return std::make_shared<Ellipsoid>(centre, Vec3{radius, radius, radius});
}
ShapePtr ellipsoid(Vec3 centre, Vec3 radii) {
  return std::make_shared<Ellipsoid>(centre, radii);
}
ShapePtr cylinder(Vec3 from, Vec3 to, double radius) {
  return std::make_shared<Cylinder>(from, to, radius);
}
ShapePtr box(Vec3 centre, Vec3 half) {
  return std::make_shared<Box>(centre, half);
}
ShapePtr half_space(Vec3 point, Vec3 outward) {
  return std::make_shared<HalfSpace>(point, outward);
}
ShapePtr turned(ShapePtr shape, const Mat3& rotation, Vec3 shift) {
  return std::make_shared<Turned>(std::move(shape), rotation, shift);
}
ShapePtr united(std::vector<ShapePtr> shapes) {
  return std::make_shared<Combined>(std::move(shapes), Combine::unite);
}
ShapePtr shared(ShapePtr a, ShapePtr b) {
  return std::make_shared<Combined>(std::vector<ShapePtr>{std::move(a), std::move(b)}, Combine::intersect);
}
ShapePtr without(ShapePtr a, ShapePtr b) {
  return std::make_shared<Combined>(std::vector<ShapePtr>{std::move(a), std::move(b)}, Combine::subtract);
}

Mat3 rotation_about(Vec3 k, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
  return {{c + k.x * k.x * d, k.x * k.y * d - k.z * s, k.x * k.z * d + k.y * s,  //
           k.y * k.x * d + k.z * s, c + k.y * k.y * d, k.y * k.z * d - k.x * s,  //
           k.z * k.x * d - k.y * s, k.z * k.y * d + k.x * s, c + k.z * k.z * d}};
}

}  // namespace gonio::ct
