// optics.lens-shading: the share of the light that an aperture passes at a place of the picture, where the rim of a
// lens element cuts it. The same lens stopped down shades less.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& optics_lens_shading();
}

namespace gonio::equation {

// The area that two discs have in common, over pi.
double shared_by_discs(double radius, double other_radius, double distance);

// Over the share at the picture's centre. `radius`: of the place from the centre, in half widths of the picture; the
// rim is as wide as the aperture at `rim_f_number`, and a place at radius 1 sees it `shift` rim radii beside the
// aperture.
double optics_lens_shading(double rim_f_number, double shift, double f_number, double radius);

}  // namespace gonio::equation
