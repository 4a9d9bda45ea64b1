// Rays through a lens of two spherical surfaces behind a stop, by Snell's law alone: no polynomial. A lens behind its
// stop bends steep rays more than its paraxial power says: barrel distortion that grows with the distance to the stop
// (Kingslake & Johnson 2010, Lens Design Fundamentals, ch. 12).
#pragma once

namespace gonio::sealed {

struct Singlet {
  double stop_m = 1e-3;                                             // from the stop's centre to the first vertex
  double front_m = 6.2e-3, back_m = -6.2e-3, thickness_m = 1.5e-3;  // radii of curvature, positive: bulging to the stop
  double index = 1.5168;                                            // BK7 at 587.6 nm
};

// Height on the image plane over its paraxial height, for a ray through the stop's centre at tan(angle) = t.
double image_height_ratio(const Singlet& lens, double t);

// Magnification in a colour for which the glass has another index, over that in the lens's own, on the plane where its
// own is sharp, for a ray through the stop's centre at tan(angle) = t.
double colour_ratio(const Singlet& lens, double index, double t);
double crown_glass(double wavelength_um);  // index of BK7 (Sellmeier's equation, Schott's coefficients)

// Where a ray that leaves through the lens at tan(angle) = t towards the scene seems to come from, along the axis
// towards the scene, counted from where those near the axis do: the stop's centre seen through the lens (m).
double pupil_shift(const Singlet& lens, double t);

}  // namespace gonio::sealed
