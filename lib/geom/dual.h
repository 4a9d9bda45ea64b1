// Dual numbers: a value and its derivatives by N unknowns, carried through arithmetic (forward-mode differentiation).
// Templates that compute with `T` give values alone for T = double and slopes as well for T = Dual<N>.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace gonio {

template <std::size_t N>
struct Dual {
  double v = 0;
  std::array<double, N> d{};

  constexpr Dual() = default;
  constexpr Dual(double value) : v(value) {}  // NOLINT: a constant has no slopes
  static constexpr Dual unknown(double value, std::size_t i) {
    Dual x(value);
    x.d[i] = 1;
    return x;
  }
  // f(x) with f(v) = value and f'(v) = slope.
  constexpr Dual chain(double value, double slope) const {
    Dual r(value);
    for (std::size_t i = 0; i < N; ++i) r.d[i] = slope * d[i];
    return r;
  }
  constexpr Dual operator-() const { return chain(-v, -1); }
  constexpr Dual& operator+=(const Dual& o) { return *this = *this + o; }

  friend constexpr Dual operator+(Dual a, const Dual& b) {
    a.v += b.v;
    for (std::size_t i = 0; i < N; ++i) a.d[i] += b.d[i];
    return a;
  }
  friend constexpr Dual operator-(Dual a, const Dual& b) {
    a.v -= b.v;
    for (std::size_t i = 0; i < N; ++i) a.d[i] -= b.d[i];
    return a;
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    Dual r(a.v * b.v);
    for (std::size_t i = 0; i < N; ++i) r.d[i] = a.d[i] * b.v + a.v * b.d[i];
    return r;
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const double over = 1 / b.v;
    Dual r(a.v / b.v);
    for (std::size_t i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.v * b.d[i]) * over;
    return r;
  }
  friend constexpr Dual operator+(Dual a, double b) { return a.v += b, a; }
  friend constexpr Dual operator+(double a, Dual b) { return b.v += a, b; }
  friend constexpr Dual operator-(Dual a, double b) { return a.v -= b, a; }
  friend constexpr Dual operator-(double a, const Dual& b) { return b.chain(a - b.v, -1); }
  friend constexpr Dual operator*(const Dual& a, double b) { return a.chain(a.v * b, b); }
  friend constexpr Dual operator*(double a, const Dual& b) { return b.chain(a * b.v, a); }
  friend constexpr Dual operator/(const Dual& a, double b) { return a.chain(a.v / b, 1 / b); }
  friend constexpr Dual operator/(double a, const Dual& b) { return b.chain(a / b.v, -a / (b.v * b.v)); }
  friend constexpr auto operator<=>(const Dual& a, const Dual& b) { return a.v <=> b.v; }
  friend constexpr bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
};

template <std::size_t N>
Dual<N> sqrt(const Dual<N>& x) {
  const double root = std::sqrt(x.v);
  return x.chain(root, root > 0 ? 0.5 / root : 0);
}
template <std::size_t N>
Dual<N> exp(const Dual<N>& x) {
  const double e = std::exp(x.v);
  return x.chain(e, e);
}
template <std::size_t N>
Dual<N> log(const Dual<N>& x) {
  return x.chain(std::log(x.v), 1 / x.v);
}
template <std::size_t N>
Dual<N> cos(const Dual<N>& x) {
  return x.chain(std::cos(x.v), -std::sin(x.v));
}
template <std::size_t N>
Dual<N> sin(const Dual<N>& x) {
  return x.chain(std::sin(x.v), std::cos(x.v));
}
template <std::size_t N>
Dual<N> atan2(const Dual<N>& y, const Dual<N>& x) {
  const double r2 = x.v * x.v + y.v * y.v;
  Dual<N> r(std::atan2(y.v, x.v));
  if (r2 > 0)
    for (std::size_t i = 0; i < N; ++i) r.d[i] = (x.v * y.d[i] - y.v * x.d[i]) / r2;
  return r;
}
template <std::size_t N>
Dual<N> hypot(const Dual<N>& x, const Dual<N>& y) {
  const double r = std::hypot(x.v, y.v);
  Dual<N> out(r);
  if (r > 0)
    for (std::size_t i = 0; i < N; ++i) out.d[i] = (x.v * x.d[i] + y.v * y.d[i]) / r;
  return out;
}
template <std::size_t N>
Dual<N> abs(const Dual<N>& x) {
  return x.v < 0 ? -x : x;
}

// The number alone.
inline double value_of(double x) {
  return x;
}
template <std::size_t N>
double value_of(const Dual<N>& x) {
  return x.v;
}

// Vectors of any such numbers, for geometry that depends on unknowns.
template <class T>
struct Vec3Of {
  T x, y, z;
};
template <class T>
T dot(const Vec3Of<T>& a, const Vec3Of<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace gonio
