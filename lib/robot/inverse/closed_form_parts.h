// What the closed forms share; private to them.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "robot/inverse/closed_forms.h"

namespace gonio::robot::closed_form {

inline constexpr int right_bit = 4, down_bit = 2, flip_bit = 1;
// Lengths over the arm's size: below this a turn is called undetermined, rounding alone moves it.
inline constexpr double no_lever = 1e-10;
// Sines, and lengths over the arm's size: below these an arm cannot turn or stretch as its closed form asks.
inline constexpr double no_turn = 1e-3, no_triangle = 1e-4;

inline Vec3 across(Vec3 p, Vec3 h) {
  return p - h * dot(h, p);
}

inline double angle_between(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

// Both angles at least `apart` from where they meet, 0 or pi from their middle.
inline subproblem::TwoTurns spread(subproblem::TwoTurns t, double apart_rad) {
  const double middle = (t.falling_rad + t.rising_rad) / 2;
  const double half = std::clamp((t.falling_rad - t.rising_rad) / 2, apart_rad, pi - apart_rad);
  t.falling_rad = middle + half, t.rising_rad = middle - half;
  return t;
}

// A direction replaces two or three that are nearly its own, in either sense: joints turn the other way about -axis,
// hence the sense of each is kept. -1: too far apart.
inline double align(std::span<Vec3> axes) {
  const Vec3 first = axes.front();
  Vec3 sum;
  for (const Vec3& a : axes) sum += dot(a, first) < 0 ? -a : a;
  const Vec3 mean = normalized(sum);
  double angle = 0;
  for (Vec3& a : axes) {
    const Vec3 to = dot(a, first) < 0 ? -mean : mean;
    angle = std::max(angle, angle_between(a, to));
    a = to;
  }
  return angle <= near_angle_rad ? angle : -1;
}

// The angle of a turn about k that is known as a matrix.
inline double angle_about(Vec3 k, const Mat3& turn) {
  const Vec3 u = Basis(k).t;
  return subproblem::sp1(u, turn * u, k).angle_rad;
}

}  // namespace gonio::robot::closed_form
