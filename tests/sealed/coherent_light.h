// Partly polarized light by its coherency matrix <E E*> in space (Wolf 1959; three by three, no frames), and mirrors of
// metal and black glass that it meets. Waves exp(-i w t). Nothing of this is the arithmetic that explain has.
#pragma once
#include <array>
#include <complex>

#include "geom/vector.h"

namespace gonio::sealed {

using Complex = std::complex<double>;
using Field = std::array<Complex, 3>;
struct Coherency {
  std::array<std::array<Complex, 3>, 3> c{};
  double along(const Field& analyser) const;  // mean of |analyser* E|^2
};

// Light along the unit `d` of this radiance: a share of it swings along the unit `e`, the rest in no direction.
Coherency sent(Vec3 d, double radiance, Vec3 e, double share);
Coherency sum(const Coherency& a, const Coherency& b, double weight);

struct Mirror {
  Complex index{1.5, 0};
  double film_m = 0, film_index = 1.38;
};
struct Pair {  // of the fields along s and p = s x d, before and after
  Complex s, p;
};
Pair amplitudes(double cosine, const Mirror& mirror, double wavelength_m);
// Reflected into the unit `out` at a facet of unit normal n; light arrived along `in`.
Coherency reflected(const Coherency& light, Vec3 in, Vec3 out, Vec3 n, const Mirror& mirror, double wavelength_m);

}  // namespace gonio::sealed
