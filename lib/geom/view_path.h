// Six ways of a camera past a scene: Jensen, Doest, Aanæs & Del Bue 2018, "A benchmark and evaluation of non-rigid
// structure from motion", figure 4. The figure draws them and gives no numbers: those are ours.
//   circle      around the scene            line    sideways, past the scene    zigzag  to and fro, changes of depth
//   half-circle half of that, on one side   flyby   past and over it            tricky  small, mostly along the axis
#pragma once
#include <span>
#include <string>

#include "geom/vector.h"

namespace gonio {

std::span<const std::string> view_path_names();

// The camera's place at s, 0 to 1, about the scene's centre, in units of its mean distance; z up. e = 20 degrees is the
// height over the horizon, so low that what lies there hides parts of itself:
//   circle        (cos a cos e, sin a cos e, sin e),  a = 2 pi s - pi / 2
//   half-circle   the same,  a = pi s - pi
//   line          (2 s - 1, -cos e, sin e)
//   flyby         (0.35, 2 s - 1, 0.9):  beside the zenith, over the scene and away
//   zigzag        straight strokes between (-1)^k 0.6 to the sides, nearer and farther by turns
//   tricky        towards the scene and back, 1.3 to 0.75, with small motions across
// Error(usage) at "--path" for other names.
Vec3 view_path(const std::string& name, double s);

}  // namespace gonio
