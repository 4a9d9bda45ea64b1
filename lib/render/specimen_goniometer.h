// A built-in goniometer: lamps on an arc, a camera that goes around, a flat sample and a white tile beside it. Metres;
// world z the normal of both, the arc in the half plane y = 0, x > 0. Azimuths count from there.
//
// The arc of Stets et al. 2017: lamps every 7.5 degrees, the camera every 7.5 degrees, 2,783 images. What these steps
// give: inclinations strictly between the normal and the horizon are 7.5 to 82.5 degrees, 11 of them, for the lamps (at
// 90 degrees no light arrives) as for the camera. 2783 = 11 x 253 and 253 = 11 x 23, so that there were 23 azimuths for
// each of 11 inclinations: steps over 165 degrees, nearly a quarter of the sphere. (Over an octant, 0 to 90 degrees,
// there are 13 azimuths: 1573 images.) Here they end in the plane of the mirror directions, 180 degrees from the arc,
// and begin two steps beside it: 15 to 180 degrees.
#pragma once
#include <vector>

#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::render {

struct Arc {
  double step_rad = 7.5 * (pi / 180);
  double light_distance_m = 0.45, camera_distance_m = 0.5;
};
std::vector<double> arc_inclinations_rad(const Arc& arc);
std::vector<double> arc_azimuths_rad(const Arc& arc);

// The images to be taken, or rendered: "light-THETA_theta-THETA_phi-PHI", degrees. The sample is varnished, the tile
// Lambertian; both stand in the section "goniometer".
manifest::Document goniometer_specimen(const Arc& arc);

}  // namespace gonio::render
