// See film.h.
#include "sealed/film.h"

#include <cmath>
#include <complex>

#include "geom/vector.h"

namespace gonio::sealed {
namespace {

using Complex = std::complex<double>;

double one_wavelength(const Film& film, double below, double cosine, double wavelength_m) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const auto within = [&](double index) { return std::sqrt(1 - sine * sine / (index * index)); };
  const double phase = 2 * pi * film.index * film.thickness_m * within(film.index) / wavelength_m;
  double sum = 0;
  for (const bool across : {true, false}) {  // s, p: admittances n cos and n / cos
    const auto admittance = [&](double index) { return across ? index * within(index) : index / within(index); };
    const double air = admittance(1), layer = admittance(film.index), glass = admittance(below);
    const Complex b = std::cos(phase) + Complex(0, std::sin(phase) / layer) * glass,
                  c = Complex(0, std::sin(phase) * layer) + std::cos(phase) * glass;
    sum += 0.5 * std::norm((air * b - c) / (air * b + c));
  }
  return sum;
}

}  // namespace

double film_reflectance(const Film& film, double f0, double cosine, double wavelength_m) {
  const double below = (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
  double sum = 0;
  for (int k = -5; k <= 5; ++k) sum += one_wavelength(film, below, cosine, wavelength_m + 2e-9 * k) / 11;
  return sum;
}

}  // namespace gonio::sealed
