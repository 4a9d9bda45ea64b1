// Luminaire files IES LM-63 (1986, 1991, 1995, 2002, 2019): candela over two angles.
//
// After the keywords, from the line "TILT=..." on (whose table, if any, is for lamps that hang askew and is read past):
//   lamps lumens multiplier vertical-count horizontal-count type unit width length height
//   ballast-factor future-use watts
//   vertical angles, horizontal angles, candela for each horizontal angle, degrees; blanks, commas and ends of lines
//   alike separate numbers.
// Photometric types (IES LM-75-01), in the lamp's frame of light/aimed.h, n the aim:
//   C (1)  the pole is n; vertical angles from it, 0 .. 90, 90 .. 180 or 0 .. 180; horizontal ones from `up`, counter-
//          clockwise for who looks along n (from above at a lamp that shines down). Horizontal angles end at 0 (the
//          same all round), 90 (the same in all quadrants), 180 (mirrored at the plane of `up`), from 90 to 270
//          (mirrored at the plane across), or 360.
//   B (2)  the pole is x, horizontal; horizontal angle = latitude, vertical angle = turn about the pole, up positive.
//   A (3)  the pole is up; vertical angle = latitude, up positive, horizontal angle = turn about the pole, right
//          positive. Tables of A and B that begin at 0 are mirrored to the other side.
#pragma once
#include <string>

#include "light/spherical_table.h"

namespace gonio::light {

// The brightest direction has 1. Error(data) at `place`: what is missing, out of order or too much.
SphericalGrid ies_grid(const std::string& text, const std::string& place);

}  // namespace gonio::light
