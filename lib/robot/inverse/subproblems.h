// The geometric subproblems of Paden, Kahan, and Elias & Wen: angles of one to three turns that bring given points
// together. Axes are unit vectors; R(k, t) is the turn by t about k. Where nothing solves a subproblem exactly its
// answer comes nearest, hence goes over continuously into the exact one.
#pragma once
#include <array>

#include "geom/vector.h"

namespace gonio::robot::subproblem {

// A few answers without the heap.
template <class T, int Capacity>
struct Few {
  std::array<T, Capacity> values{};
  int count = 0;
  void add(const T& value) {
    if (count < Capacity) values[static_cast<std::size_t>(count++)] = value;
  }
  const T* begin() const { return values.data(); }
  const T* end() const { return values.data() + count; }
  const T& operator[](int i) const { return values[static_cast<std::size_t>(i)]; }
};

// 1: R(k, t) p1 = p2.
struct Turn {
  double angle_rad = 0;
  double lever = 0;  // product of the distances of p1 and p2 from the axis: 0 leaves the angle undetermined
};
Turn sp1(Vec3 p1, Vec3 p2, Vec3 k);

// 4: h . R(k, t) p = d. Always two angles, at which the left side falls and rises; equal where d is out of reach.
struct TwoTurns {
  double falling_rad = 0, rising_rad = 0;
  double lever = 0;   // half of what the left side can change by
  double margin = 0;  // lever - |what d asks of it|: negative out of reach, 0 where both angles meet
};
TwoTurns sp4(Vec3 h, Vec3 p, Vec3 k, double d);

// 3: |R(k, t) p1 - p2| = d; as subproblem 4 of p2 . R(k, t) p1 = (p1^2 + p2^2 - d^2) / 2.
TwoTurns sp3(Vec3 p1, Vec3 p2, Vec3 k, double d);

struct Pair {
  double first_rad = 0, second_rad = 0;
  bool exact = true;
};
// 2: R(k1, t1) p1 = R(k2, t2) p2, |p1| = |p2|. Two pairs, equal where the circles do not meet.
std::array<Pair, 2> sp2(Vec3 p1, Vec3 p2, Vec3 k1, Vec3 k2);
// 2 extended: p0 + R(k1, t1) p1 = R(k2, t2) p2.
Few<Pair, 2> sp2_extended(Vec3 p0, Vec3 p1, Vec3 p2, Vec3 k1, Vec3 k2);

// Two equations a . (cos t1, sin t1) + b . (cos t2, sin t2) = d: up to four pairs; where there is none, the pair that
// comes nearest, marked as not exact.
struct PairEquation {
  Vec2 a, b;
  double d = 0;
};
Few<Pair, 4> solve_pair(PairEquation one, PairEquation two);

// 6: h1 . R(k1, t1) p1 + h2 . R(k2, t2) p2 = d1 and h3 . R(k3, t1) p3 + h4 . R(k4, t2) p4 = d2.
struct Arm6 {
  Vec3 h, k, p;
};
PairEquation equation_of(const Arm6& first, const Arm6& second, double d);
Few<Pair, 4> sp6(const std::array<Arm6, 4>& arms, double d1, double d2);

// 5: p0 + R(k1, t1) p1 = R(k2, t2) (p2 + R(k3, t3) p3).
struct Triple {
  double first_rad = 0, second_rad = 0, third_rad = 0;
  bool exact = true;
};
Few<Triple, 4> sp5(Vec3 p0, Vec3 p1, Vec3 p2, Vec3 p3, Vec3 k1, Vec3 k2, Vec3 k3);

}  // namespace gonio::robot::subproblem
