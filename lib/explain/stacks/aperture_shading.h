// How the lens shades a stack's widest aperture beside its others: a start for optics.lens-shading, whose fit finds no
// way from far off (where the whole aperture lies within the rim, nothing depends on either).
#pragma once
#include "explain/stacks/stack_input.h"

namespace gonio::explain::stacks {

struct ApertureShading {
  double shift = 0, rim_f_number = 0;  // of equation::optics_lens_shading()
};

// Of those on a grid, the one that fits best to medians of the logarithm of the widest aperture's light over that of
// each other one, in rings about the picture's centre; what an aperture passes at the centre is free. Of stacks with at
// least two apertures.
ApertureShading aperture_shading(const Stack& stack);

}  // namespace gonio::explain::stacks
