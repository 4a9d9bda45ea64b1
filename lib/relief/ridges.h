// Geometry of parallel ridges with the profile of a saw, as milled: long facets tilted by the ridge angle, walls at
// right angles to them, edges rounded by the tool, burrs left on the crests. Ridges run along +x; the frame and the
// facets' tilt, towards +y, are those of surface/ridges.h with u = x, v = y, so that the analytic model and this
// geometry can be laid beside each other.
//
// Over the period L, from the crest at y = 0: the facet falls with slope -tan t over L cos^2 t, the wall rises with
// slope cot t over L sin^2 t; the crest is L sin t cos t above the trough. An edge of radius r is a circle's arc that
// touches both flanks r from where they would meet (they meet at right angles).
//
// Burrs: residue that is pushed over the crest's edge. Lumps of a length along x and a width across, centred on a
// crest, are thrown there with a Poisson density such that `burr_share` of the crests' length lies under one or more:
// density = -ln(1 - share) / length. Each adds its height times (1 - s^2)^2 (1 - t^2)^2, s and t the distances from its
// centre over half its length and width; where several overlap the highest counts. Heights are `burr_height_m` times a
// uniform number in [0.5, 1.5].
#pragma once
#include <cstdint>

#include "relief/relief.h"

namespace gonio::relief {

struct RidgeShape {
  double ridge_rad = 0.17;  // (0, pi / 4]
  double pitch_m = 100e-6;
  double crest_radius_m = 0, trough_radius_m = 0;  // their sum at most the wall, pitch sin t
  double burr_share = 0;                           // of the crests' length, [0, 1)
  double burr_height_m = 0, burr_width_m = 0, burr_length_m = 0;
  int ridges = 1;       // in the period
  double length_m = 0;  // of the period along the ridges; 0: 32 burrs, or one pitch without any
  std::uint64_t seed = 0;
};
// Points across a pitch and along the period; 0: so fine that walls, edges and burrs are resolved by six cells or more,
// 16 at least and 4096 at most.
struct RidgeSampling {
  int across = 0, along = 0;
};

// Error(usage) at "ridges" for shapes that cannot be.
void check_ridges(const RidgeShape& shape);
Relief ridges(const RidgeShape& shape, const RidgeSampling& sampling = {});
double ridge_profile_m(const RidgeShape& shape, double y_m);  // without burrs; 0 at the sharp crest

// z = A sin(2 pi x / lx) sin(2 pi y / ly), periodic: depth 2 A; a wave of length 0 is left out (its sine is 1).
// Thesis D, equation 3.
Relief sinusoid(double amplitude_m, double wave_x_m, double wave_y_m, int points_per_wave = 128);

}  // namespace gonio::relief
