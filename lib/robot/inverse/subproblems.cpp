// See subproblems.h. Each angle enters as (cos t, sin t), linearly: R(k, t) p = k (k.p) + cos t p_ + sin t (k x p), p_
// the part of p across k.
#include "robot/inverse/subproblems.h"

#include <cmath>

namespace gonio::robot::subproblem {
namespace {

Vec3 across(Vec3 p, Vec3 k) {
  return p - k * dot(k, p);
}

Vec3 turned_point(Vec3 k, double t, Vec3 p) {
  return k * dot(k, p) + across(p, k) * std::cos(t) + cross(k, p) * std::sin(t);
}

// a . (cos t, sin t) = d
TwoTurns turns_of(Vec2 a, double d) {
  const double lever = norm(a), middle = std::atan2(a.y, a.x);
  const double inside = (lever - d) * (lever + d);
  const double half = inside > 0 ? std::atan2(std::sqrt(inside), d) : d > 0 ? 0 : pi;
  return {middle + half, middle - half, lever, lever - std::abs(d)};
}

}  // namespace

Turn sp1(Vec3 p1, Vec3 p2, Vec3 k) {
  const double sine = dot(cross(k, p1), p2), cosine = dot(across(p1, k), p2);
  return {std::atan2(sine, cosine), std::hypot(sine, cosine)};
}

TwoTurns sp4(Vec3 h, Vec3 p, Vec3 k, double d) {
  return turns_of({dot(h, across(p, k)), dot(h, cross(k, p))}, d - dot(h, k) * dot(k, p));
}

TwoTurns sp3(Vec3 p1, Vec3 p2, Vec3 k, double d) {
  return sp4(p2, p1, k, (dot(p1, p1) + dot(p2, p2) - d * d) / 2);
}

std::array<Pair, 2> sp2(Vec3 p1, Vec3 p2, Vec3 k1, Vec3 k2) {
  const TwoTurns first = sp4(k2, p1, k1, dot(k2, p2));
  const auto with = [&](double t) {
    return Pair{t, sp1(p2, turned_point(k1, t, p1), k2).angle_rad, first.margin >= 0};
  };
  return {with(first.falling_rad), with(first.rising_rad)};
}

Few<Pair, 2> sp2_extended(Vec3 p0, Vec3 p1, Vec3 p2, Vec3 k1, Vec3 k2) {
  // Lengths: p0 . R1 p1 = (p2^2 - p0^2 - p1^2) / 2; along k2: k2 . R1 p1 = k2 . (p2 - p0). Two equations in
  // (cos t1, sin t1), which need not be independent.
  const Vec3 q = across(p1, k1), r = cross(k1, p1);
  const Vec2 a{dot(p0, q), dot(p0, r)}, b{dot(k2, q), dot(k2, r)};
  const double da = (dot(p2, p2) - dot(p0, p0) - dot(p1, p1)) / 2 - dot(p0, k1) * dot(k1, p1);
  const double db = dot(k2, p2 - p0) - dot(k2, k1) * dot(k1, p1);
  Few<Pair, 2> answers;
  const auto add = [&](double t) {
    const Vec3 end = p0 + turned_point(k1, t, p1);
    const double u = sp1(p2, end, k2).angle_rad;
    answers.add({t, u, norm(end - turned_point(k2, u, p2)) < 1e-9 * (1 + norm(end))});
  };
  const double determinant = a.x * b.y - a.y * b.x;
  if (std::abs(determinant) > 1e-9 * norm(a) * norm(b)) {
    add(std::atan2(a.x * db - b.x * da, da * b.y - db * a.y) + (determinant < 0 ? pi : 0));
    return answers;
  }
  const TwoTurns turns = norm(a) > norm(b) ? turns_of(a, da) : turns_of(b, db);
  add(turns.falling_rad);
  add(turns.rising_rad);
  return answers;
}

PairEquation equation_of(const Arm6& first, const Arm6& second, double d) {
  const auto row = [](const Arm6& arm) {
    return Vec2{dot(arm.h, across(arm.p, arm.k)), dot(arm.h, cross(arm.k, arm.p))};
  };
  return {row(first), row(second),
          d - dot(first.h, first.k) * dot(first.k, first.p) - dot(second.h, second.k) * dot(second.k, second.p)};
}

Few<Pair, 4> sp6(const std::array<Arm6, 4>& arms, double d1, double d2) {
  return solve_pair(equation_of(arms[0], arms[1], d1), equation_of(arms[2], arms[3], d2));
}

Few<Triple, 4> sp5(Vec3 p0, Vec3 p1, Vec3 p2, Vec3 p3, Vec3 k1, Vec3 k2, Vec3 k3) {
  // Lengths of both sides, and both along k2: neither holds the second turn.
  const double along = dot(k2, p2) - dot(k2, p0);
  const double lengths = (dot(p2, p2) + dot(p3, p3) - dot(p0, p0) - dot(p1, p1)) / 2;
  const auto pairs =
      solve_pair(equation_of({k2, k1, p1}, {-k2, k3, p3}, along), equation_of({p0, k1, p1}, {-p2, k3, p3}, lengths));
  Few<Triple, 4> answers;
  for (const Pair& pair : pairs) {
    const Vec3 left = p0 + turned_point(k1, pair.first_rad, p1), right = p2 + turned_point(k3, pair.second_rad, p3);
    answers.add({pair.first_rad, sp1(right, left, k2).angle_rad, pair.second_rad, pair.exact});
  }
  return answers;
}

}  // namespace gonio::robot::subproblem
