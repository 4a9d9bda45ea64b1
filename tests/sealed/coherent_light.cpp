#include "sealed/coherent_light.h"

#include <algorithm>
#include <cmath>

namespace gonio::sealed {
namespace {

double of(Vec3 v, int k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

// By one interface, from above.
Pair step(Complex above, Complex below, Complex cos_above, Complex cos_below) {
  return {(above * cos_above - below * cos_below) / (above * cos_above + below * cos_below),
          (below * cos_above - above * cos_below) / (below * cos_above + above * cos_below)};
}

}  // namespace

// A film's by its round trips.
Pair amplitudes(double cosine, const Mirror& m, double wavelength_m) {
  const double square = 1 - cosine * cosine;
  const auto inside = [&](Complex n) { return std::sqrt(1.0 - square / (n * n)); };
  if (m.film_m == 0) return step(1, m.index, cosine, inside(m.index));
  const Complex film = m.film_index, c1 = inside(film);
  const Pair first = step(1, film, cosine, c1), second = step(film, m.index, c1, inside(m.index));
  const Complex round = std::exp(Complex(0, 4 * pi * m.film_m / wavelength_m) * film * c1);
  const auto all = [&](Complex a, Complex b) { return (a + b * round) / (1.0 + a * b * round); };
  return {all(first.s, second.s), all(first.p, second.p)};
}

double Coherency::along(const Field& a) const {
  Complex total = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) total += std::conj(a[i]) * c[i][j] * a[j];
  return total.real();
}

Coherency sent(Vec3 d, double radiance, Vec3 e, double share) {
  Coherency light;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      light.c[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          radiance * (0.5 * (1 - share) * ((i == j ? 1.0 : 0.0) - of(d, i) * of(d, j)) + share * of(e, i) * of(e, j));
  return light;
}

Coherency sum(const Coherency& a, const Coherency& b, double weight) {
  Coherency all = a;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) all.c[i][j] += weight * b.c[i][j];
  return all;
}

Coherency reflected(const Coherency& light, Vec3 in, Vec3 out, Vec3 n, const Mirror& mirror, double wavelength_m) {
  const double cosine = std::clamp(-dot(in, n), 0.0, 1.0);
  Vec3 s = cross(in, n);
  s = norm(s) > 1e-9 ? normalized(s) : normalized(cross(in, std::abs(in.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 p_in = cross(s, in), p_out = cross(s, out);
  const Pair r = amplitudes(cosine, mirror, wavelength_m);
  std::array<std::array<Complex, 3>, 3> m{}, half{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      m[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          r.s * (of(s, i) * of(s, j)) + r.p * (of(p_out, i) * of(p_in, j));
  Coherency result;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) half[i][j] += m[i][k] * light.c[k][j];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) result.c[i][j] += half[i][k] * std::conj(m[j][k]);
  return result;
}

}  // namespace gonio::sealed
