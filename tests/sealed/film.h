// Reflectance of a transparent film on a dielectric, layer by layer with characteristic matrices (Abeles 1950; Born &
// Wolf 1999, section 1.6.2), wavelength by wavelength over a band.
#pragma once

namespace gonio::sealed {

struct Film {
  double thickness_m = 0, index = 1.4;
};
// Of unpolarized light in air that meets facets at `cosine`; f0: of the bare dielectric at normal incidence. The band
// is 20 nm wide about `wavelength_m`.
double film_reflectance(const Film& film, double f0, double cosine, double wavelength_m);

}  // namespace gonio::sealed
