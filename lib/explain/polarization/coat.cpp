// See coat.h.
#include "explain/polarization/coat.h"

#include "optics/mueller_algebra.h"
#include "surface/thin_film.h"

namespace gonio::explain::polarization {
namespace {

constexpr double wavelength_m = 555e-9;

}  // namespace

// thin_film.h has waves exp(+i w t) and indices n - i k: conjugates.
std::array<double, 4> coated(const std::array<double, 4>& stokes, double cosine, double s_axis_rad,
                             std::complex<double> index, const Film& film) {
  const surface::FilmAmplitudes bare = surface::film_amplitudes(cosine, std::conj(index), film.eta, 0, wavelength_m),
                                under = surface::film_amplitudes(cosine, std::conj(index), film.eta, film.thickness_m,
                                                                 wavelength_m);
  const optics::Mueller change = optics::mueller_of(std::conj(under.s / bare.s), std::conj(under.p / bare.p));
  return (optics::element_turned_by(change, s_axis_rad) * optics::Stokes{stokes}).s;
}

}  // namespace gonio::explain::polarization
