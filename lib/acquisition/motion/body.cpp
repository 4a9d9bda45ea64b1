// See body.h. A plane with normal n lies between two convex bodies where the least of n . p over the one exceeds the
// largest over the other; the difference bounds their distance from below (Ericson 2005, Real-Time Collision Detection,
// 9.1), and equals it for the n along the shortest way between them. For long bodies that direction is close to the one
// between the nearest points of their backbones.
#include "acquisition/motion/body.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::acquisition {
namespace {

void bound_mesh(const Solid& solid, Body& body) {
  Vec3 low = solid.vertices_m.front(), high = low;
  for (const Vec3& v : solid.vertices_m) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  body.middle_m = (low + high) / 2;
  body.half_m = (high - low) / 2;
  for (const Vec3& v : solid.vertices_m) body.radius_m = std::max(body.radius_m, norm(v - body.middle_m));
}

// Of a box: along its longest side, and as much shorter as the second longest is.
Vec3 backbone(Vec3 half) {
  const double a = half.x, b = half.y, c = half.z;
  if (a >= b && a >= c) return {a - std::max(b, c), 0, 0};
  if (b >= c) return {0, b - std::max(a, c), 0};
  return {0, 0, c - std::max(a, b)};
}

Vec3 column(const Mat3& m, int i) {
  return {m(0, i), m(1, i), m(2, i)};
}

// Largest n . (p - middle) over the body, for unit n.
double reach_along(const Body& body, const PlacedBody& at, Vec3 n) {
  const double x = dot(n, column(at.rotation, 0)), y = dot(n, column(at.rotation, 1)),
               z = dot(n, column(at.rotation, 2));
  switch (body.solid->shape) {
    case Solid::Shape::ball: return body.radius_m;
    case Solid::Shape::cylinder:
      return std::fabs(z) * body.half_m.z + body.half_m.x * std::sqrt(std::max(0.0, 1 - z * z));
    default: return std::fabs(x) * body.half_m.x + std::fabs(y) * body.half_m.y + std::fabs(z) * body.half_m.z;
  }
}

// From the nearest point of segment a to that of segment b; each given by middle and half (Ericson 5.1.9).
Vec3 between_segments(Vec3 middle_a, Vec3 half_a, Vec3 middle_b, Vec3 half_b) {
  const Vec3 r = middle_a - middle_b;
  const double aa = dot(half_a, half_a), bb = dot(half_b, half_b), ab = dot(half_a, half_b), ar = dot(half_a, r),
               br = dot(half_b, r);
  const double det = aa * bb - ab * ab;
  double s = det > 1e-12 * aa * bb && det > 0 ? std::clamp((ab * br - ar * bb) / det, -1.0, 1.0) : 0;
  double t = bb > 0 ? (ab * s + br) / bb : 0;
  if (std::fabs(t) > 1 || !(bb > 0)) {
    t = std::clamp(t, -1.0, 1.0);
    s = aa > 0 ? std::clamp((ab * t - ar) / aa, -1.0, 1.0) : 0;
  }
  return (middle_b + half_b * t) - (middle_a + half_a * s);
}

}  // namespace

Body body_of(const Solid& solid, int arm) {
  Body body;
  body.solid = &solid;
  body.arm = arm;
  body.rotation = matrix_of(solid.placed.rotation);
  body.origin_m = solid.placed.translation_m;
  const Vec3 s = solid.sides_m;
  switch (solid.shape) {
    case Solid::Shape::box:
      body.half_m = s / 2;
      body.radius_m = norm(s) / 2;
      break;
    case Solid::Shape::ball:
      body.half_m = {s.x, s.x, s.x};
      body.radius_m = s.x;
      break;
    case Solid::Shape::cylinder:
      body.half_m = {s.x, s.x, s.y / 2};
      body.radius_m = std::hypot(s.x, s.y / 2);
      break;
    case Solid::Shape::mesh: bound_mesh(solid, body); break;
  }
  body.core_m = solid.shape == Solid::Shape::cylinder ? Vec3{0, 0, s.y / 2} : backbone(body.half_m);
  return body;
}

std::vector<Body> bodies_of(const Laboratory& laboratory) {
  std::vector<Body> bodies;
  int index = 0;
  for (const auto& [name, arm] : laboratory.arms) {
    for (const Solid& solid : arm.solids) bodies.push_back(body_of(solid, index));
    ++index;
  }
  for (const Solid& solid : laboratory.obstacles) bodies.push_back(body_of(solid, -1));
  return bodies;
}

std::vector<PlacedBody> placed(const Laboratory& laboratory, const std::vector<Body>& bodies, const State& state) {
  std::vector<PlacedBody> at(bodies.size());
  std::size_t i = 0;
  const auto put = [&](const Mat3& rotation, Vec3 origin) {
    const Body& body = bodies[i];
    at[i].rotation = rotation * body.rotation;
    at[i].origin_m = rotation * body.origin_m + origin;
    at[i].middle_m = at[i].rotation * body.middle_m + at[i].origin_m;
    at[i].core_m = at[i].rotation * body.core_m;
    ++i;
  };
  for (const auto& [name, arm] : laboratory.arms) {
    const std::vector<robot::LinkFrame> frames = robot::link_frames(arm.links, joints_of(arm, state));
    const Mat3 base = matrix_of(arm.world_from_base.rotation);
    for (const Solid& solid : arm.solids) {
      const robot::LinkFrame& frame = frames[static_cast<std::size_t>(solid.link)];
      put(base * frame.rotation, base * frame.origin_m + arm.world_from_base.translation_m);
    }
  }
  while (i < bodies.size()) put({}, {});
  return at;
}

double ball_gap(const Body& a, const PlacedBody& at_a, const Body& b, const PlacedBody& at_b) {
  return norm(at_b.middle_m - at_a.middle_m) - a.radius_m - b.radius_m;
}

double plane_gap(const Body& a, const PlacedBody& at_a, const Body& b, const PlacedBody& at_b) {
  const Vec3 between = at_b.middle_m - at_a.middle_m;
  double best = -std::numeric_limits<double>::infinity();
  const auto try_normal = [&](Vec3 n) {
    const double length = norm(n);
    if (!(length > 1e-9)) return;
    n = n / length;
    best = std::max(best, std::fabs(dot(n, between)) - reach_along(a, at_a, n) - reach_along(b, at_b, n));
  };
  try_normal(between_segments(at_a.middle_m, at_a.core_m, at_b.middle_m, at_b.core_m));
  const auto try_sides = [&](const Body& body, const PlacedBody& at) {
    if (body.solid->shape == Solid::Shape::box || body.solid->shape == Solid::Shape::mesh)
      for (int k = 0; k < 3; ++k) try_normal(column(at.rotation, k));
    if (body.solid->shape == Solid::Shape::cylinder) try_normal(column(at.rotation, 2));
  };
  try_sides(a, at_a);
  try_sides(b, at_b);
  return best;
}

namespace {

// The point of the body nearest to a point of the world.
Vec3 nearest_in(const Body& body, const PlacedBody& at, Vec3 world) {
  const Vec3 p = transposed(at.rotation) * (world - at.origin_m), h = body.half_m;
  Vec3 q{};
  switch (body.solid->shape) {
    case Solid::Shape::ball: {
      const double r = norm(p);
      q = r > body.radius_m ? p * (body.radius_m / r) : p;
      break;
    }
    case Solid::Shape::cylinder: {
      const double r = std::hypot(p.x, p.y), share = r > h.x ? h.x / r : 1;
      q = {p.x * share, p.y * share, std::clamp(p.z, -h.z, h.z)};
      break;
    }
    default: q = {std::clamp(p.x, -h.x, h.x), std::clamp(p.y, -h.y, h.y), std::clamp(p.z, -h.z, h.z)};
  }
  return at.rotation * q + at.origin_m;
}

}  // namespace

Bounded bounded_distance(const Body& a, const PlacedBody& at_a, const Body& b, const PlacedBody& at_b, Vec3 on_b_m) {
  constexpr double settled_m = 1e-7;
  double below = std::max(ball_gap(a, at_a, b, at_b), plane_gap(a, at_a, b, at_b));
  double above = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1000; ++i) {
    const Vec3 on_a = nearest_in(a, at_a, on_b_m);
    on_b_m = nearest_in(b, at_b, on_a);
    const Vec3 across = on_b_m - on_a;
    const double length = norm(across);
    above = std::min(above, length);
    if (!(length > settled_m)) return {0, 0};
    const Vec3 n = across / length;
    below = std::max(below, dot(n, at_b.middle_m - at_a.middle_m) - reach_along(a, at_a, n) - reach_along(b, at_b, n));
    if (above - below < settled_m) break;
  }
  return {above, std::max(above - below, 0.0)};
}

}  // namespace gonio::acquisition
