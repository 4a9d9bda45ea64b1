// surface.coating on a smooth metal that is seen without detour: what it sends back of all that it receives, under a
// film, from what it sends back bare. With amplitudes r' of the coated mirror and r of the bare one
// (surface/thin_film.h) the field seen becomes (r_s' / r_s) E_s, (r_p' / r_p) E_p; metals have no angle at which r_p
// vanishes. In one wavelength, that to which the luminance's curve is centred.
#pragma once
#include <array>
#include <complex>

#include "explain/polarization/polarization_state.h"

namespace gonio::explain::polarization {

// `s_axis_rad`: of the axis across the plane of incidence, in the Stokes vector's frame.
std::array<double, 4> coated(const std::array<double, 4>& stokes, double cosine, double s_axis_rad,
                             std::complex<double> index, const Film& film);

}  // namespace gonio::explain::polarization
