// solve_pair of subproblems.h. The two equations are one plane in the four-space of x = (cos t1, sin t1, cos t2, sin
// t2) that is to meet |(x1, x2)| = |(x3, x4)| = 1. With x = m + N z, m the point of the plane nearest to the origin and
// N orthonormal, |x|^2 = 2 makes z a circle, z = rho (cos s, sin s); what remains is one equation in s,
//
//   g(s) = A cos 2s + B sin 2s + C cos s + D sin s + E = 0,
//
// at most four roots (Elias & Wen 2025, section on subproblems 5 and 6, write it as a quartic; equations that hold one
// of the two angles only, as of parallel or meeting axes, need no case of their own here). Roots are those of a quartic
// in tan of half of s, counted from where |g| is large; each lies between two roots of the derivative, hence none is
// lost.
#include <algorithm>
#include <cmath>
#include <span>

#include "robot/inverse/subproblems.h"

namespace gonio::robot::subproblem {
namespace {

using Four = std::array<double, 4>;

double dot4(const Four& a, const Four& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Four minus(const Four& a, const Four& b, double s) {
  return {a[0] - s * b[0], a[1] - s * b[1], a[2] - s * b[2], a[3] - s * b[3]};
}

Four scaled(const Four& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s, a[3] * s};
}

struct Wave {  // g(s)
  double cos2 = 0, sin2 = 0, cos1 = 0, sin1 = 0, constant = 0;
  double operator()(double s) const {
    const double c = std::cos(s), n = std::sin(s);
    return cos2 * (c * c - n * n) + sin2 * 2 * c * n + cos1 * c + sin1 * n + constant;
  }
  double size() const { return std::hypot(cos2, sin2) + std::hypot(cos1, sin1) + std::abs(constant); }
  Wave from(double s) const {  // the same, with s counted from there
    const double c = std::cos(s), n = std::sin(s), c2 = c * c - n * n, n2 = 2 * c * n;
    return {cos2 * c2 + sin2 * n2, sin2 * c2 - cos2 * n2, cos1 * c + sin1 * n, sin1 * c - cos1 * n, constant};
  }
  Wave slope() const { return {2 * sin2, -2 * cos2, sin1, -cos1, 0}; }
};

double value_of(std::span<const double> polynomial, double x) {  // highest power first
  double v = 0;
  for (const double c : polynomial) v = v * x + c;
  return v;
}

double between(std::span<const double> p, double low, double high) {
  const bool rises = value_of(p, high) > 0;
  double x = low + (high - low) / 2;
  for (int i = 0; i < 200; ++i) {
    double v = 0, slope = 0;
    for (const double c : p) slope = slope * x + v, v = v * x + c;
    (v > 0) == rises ? high = x : low = x;
    double next = x - v / slope;
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (next == x || v == 0) break;
    x = next;
  }
  return x;
}

// Real roots, ascending; a place where the derivative vanishes and |p| <= touching counts as one.
Few<double, 8> real_roots(std::span<const double> p, double touching) {
  while (p.size() > 1 && p.front() == 0) p = p.subspan(1);
  Few<double, 8> roots;
  if (p.size() < 2) return roots;
  if (p.size() == 2) {
    roots.add(-p[1] / p[0]);
    return roots;
  }
  std::array<double, 5> derivative{};
  double bound = 0;  // Cauchy's
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    derivative[i] = p[i] * static_cast<double>(p.size() - 1 - i);
    bound = std::max(bound, std::abs(p[i + 1] / p[0]));
  }
  const auto turning = real_roots(std::span<const double>(derivative).first(p.size() - 1), 0);
  double low = -1 - bound;
  bool before = value_of(p, low) > 0, low_touches = false;
  for (int i = 0; i <= turning.count; ++i) {
    const double high = i < turning.count ? turning[i] : 1 + bound, v = value_of(p, high);
    const bool after = v > 0;
    // Beside a place that touches, the crossing is the other half of the same double root: both are kept.
    if (after != before)
      roots.add(between(p, low, high));
    else if (i < turning.count && std::abs(v) <= touching && !low_touches)
      roots.add(high);
    low_touches = after == before && std::abs(v) <= touching;
    low = high, before = after;
  }
  return roots;
}

double polished(const Wave& g, double s) {
  const Wave slope = g.slope();
  for (int i = 0; i < 3; ++i) {
    const double v = g(s), d = slope(s);
    if (std::abs(d) < 1e-7 * g.size()) break;
    s -= std::clamp(v / d, -0.1, 0.1);
  }
  return s;
}

struct Roots {
  Few<double, 4> at;
  bool exact = true;
};

double nearest_to_zero(const Wave& g) {
  constexpr int steps = 64;
  double best = 0;
  for (int i = 1; i < steps; ++i)
    if (std::abs(g(2 * pi * i / steps)) < std::abs(g(best))) best = 2 * pi * i / steps;
  const Wave slope = g.slope(), bend = slope.slope();
  for (int i = 0; i < 20; ++i) {
    const double d = slope(best), b = bend(best);
    if (b != 0) best -= std::clamp(d / std::abs(b) * (g(best) > 0 ? 1 : -1), -0.05, 0.05);
  }
  return best;
}

Roots roots_of(const Wave& g) {
  double far = 0;
  for (int i = 1; i < 8; ++i)
    if (std::abs(g(pi * i / 4)) > std::abs(g(far))) far = pi * i / 4;
  const Wave w = g.from(far + pi);  // infinite tangent where |g| is large
  // cos = (1 - x^2) / (1 + x^2), sin = 2 x / (1 + x^2), times (1 + x^2)^2
  const std::array<double, 5> quartic = {w.cos2 - w.cos1 + w.constant, 2 * w.sin1 - 4 * w.sin2,
                                         2 * w.constant - 6 * w.cos2, 4 * w.sin2 + 2 * w.sin1,
                                         w.cos2 + w.cos1 + w.constant};
  Roots roots;
  for (const double x : real_roots(quartic, 1e-13 * g.size())) roots.at.add(polished(g, far + pi + 2 * std::atan(x)));
  if (roots.at.count == 0) {
    roots.exact = false;
    roots.at.add(nearest_to_zero(g));
  }
  return roots;
}

Four direction_across(const Four& a, const Four& b, const Four& c) {
  Four best{};
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    Four e{};
    e[i] = 1;
    for (int twice = 0; twice < 2; ++twice)
      for (const Four* v : {&a, &b, &c}) e = minus(e, *v, dot4(e, *v));
    if (const double length = dot4(e, e); length > longest) longest = length, best = e;
  }
  return scaled(best, 1 / std::sqrt(longest));
}

}  // namespace

Few<Pair, 4> solve_pair(PairEquation one, PairEquation two) {
  Four r1 = {one.a.x, one.a.y, one.b.x, one.b.y}, r2 = {two.a.x, two.a.y, two.b.x, two.b.y};
  const double l1 = std::sqrt(dot4(r1, r1)), l2 = std::sqrt(dot4(r2, r2));
  if (!(l1 > 0) || !(l2 > 0)) return {};
  r1 = scaled(r1, 1 / l1), r2 = scaled(r2, 1 / l2);
  double d1 = one.d / l1, d2 = two.d / l2;
  const double common = dot4(r1, r2);
  r2 = minus(r2, r1, common), d2 -= common * d1;
  const double l = std::sqrt(dot4(r2, r2));
  if (l < 1e-12) return {};  // one equation for two angles
  r2 = scaled(r2, 1 / l), d2 /= l;
  const Four nearest = minus(scaled(r1, d1), r2, -d2);
  const Four u = direction_across(r1, r2, Four{}), v = direction_across(r1, r2, u);
  const double square = 2 - dot4(nearest, nearest), rho = std::sqrt(std::max(square, 0.0));
  const double uu = u[0] * u[0] + u[1] * u[1], vv = v[0] * v[0] + v[1] * v[1], uv = u[0] * v[0] + u[1] * v[1];
  const double mm = nearest[0] * nearest[0] + nearest[1] * nearest[1];
  const Wave g{square / 2 * (uu - vv) * (square > 0), rho * rho * uv, 2 * rho * (nearest[0] * u[0] + nearest[1] * u[1]),
               2 * rho * (nearest[0] * v[0] + nearest[1] * v[1]), mm + rho * rho / 2 * (uu + vv) - 1};
  const Roots roots = roots_of(g);
  Few<Pair, 4> answers;
  for (const double s : roots.at) {
    const Four x = minus(minus(nearest, u, -rho * std::cos(s)), v, -rho * std::sin(s));
    answers.add({std::atan2(x[1], x[0]), std::atan2(x[3], x[2]), roots.exact && square >= 0});
  }
  return answers;
}

}  // namespace gonio::robot::subproblem
