// Resin that light turns into a gel, in finite volumes of x, y and z, layer by layer: Beer and Lambert's attenuation
// from the membrane downwards, oxygen that takes the first radicals, radicals that spread and decay, conversion, and
// the gel where it is critical. Nothing of this is the model that explain has.
//
// Lengths: across the field in pixels, in depth in layers. What gels hangs at the membrane and settles on the floor of
// its layer; what does not is washed away when fresh resin comes in, unless it is told to stay.
#pragma once
#include <cstddef>
#include <vector>

#include "base/random.h"

namespace gonio::sealed {

using Greys = std::vector<double>;  // 0 to 1, row after row

struct Cure {
  int side_px = 96, layers = 6;
  double penetration = 0.57;  // layers
  double leak = 0.012;        // light where the picture is black
  double white = 0.985;       // thickness of what white gels, in layers
  double oxygen = 0.3;        // of what is critical for the gel, taken by oxygen
  double spread_px = 0.08;    // of radicals, while the lamp is on
  // What can go wrong.
  double lamp = 1;                                  // times the light
  double core_px = 0, tail_share = 0, tail_px = 1;  // of the projector's spread
  double defocus_px = 0;                            // of it at the far side of the field
  int defocus_side = 0;                             // which: 0 right, 1 left, 2 bottom, 3 top
  int shifted_from = 0;                             // layer; 0: none
  double shift_x_px = 0, shift_y_px = 0;
  bool stays = false;                                       // resin that has not gelled
  double bulge = 0;                                         // of the membrane into the gap, layers
  double side_oxygen = 0;                                   // more of it beside open resin, of the critical
  double drift = 0;                                         // of the rate, from layer to layer
  double scratch = 0, scratch_angle = 0, scratch_at = 0.5;  // layers; of the membrane, across the field
};

inline constexpr int cells_per_pixel = 3;
// Heights over the platform in layers, 3 x 3 for each pixel, seen from the projector; `pictures`: one for each layer,
// the first on the platform.
std::vector<double> cured(const Cure& cure, const std::vector<Greys>& pictures);

// Thickness in layers of a single large field of each grey, of a printer with which nothing is wrong.
std::vector<double> wedge(const Cure& cure, const std::vector<double>& greys);

// A field of `side` x `side` numbers under a Gaussian of standard deviation `sigma` cells; dark beyond it.
void smoothed(std::vector<double>& field, int side, double sigma);

}  // namespace gonio::sealed
