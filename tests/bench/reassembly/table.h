// What stands behind and below the glass of scripts/experiments/reassembly.mk: a backdrop of 30 x 20 checks, a stand, a
// cloth with folds, which gives way where the vessels stand on it. World frame, metres, z up; cameras look along +y.
#pragma once
#include <cstdint>
#include <vector>

#include "io/ply.h"

namespace gonio::reassembly_experiment {

enum Material : std::int32_t { white_card, grey_card, white_cloth, blue_cloth, stand };

struct Standing {
  double x_m, y_m, turn_rad;
  double z_m;  // of the foot's lower side: so deep that the cloth had to give way by pressed_m where it was highest
};
struct Table {
  io::TriangleMesh pressed, rest;  // the cloth under the vessels, and before they were set down
  Standing bowl, pot;
  double deepest_m = 0;  // by which the cloth gave way
};
Table table(double pressed_m);

// What a scanner makes of it: errors of `sigma_m` along z (of the cloth) and y (of the backdrop), smooth over a few
// vertices as those of fitted surfaces are. Meshes of equal size get equal errors.
io::TriangleMesh scanned(const io::TriangleMesh& mesh, double sigma_m, std::uint64_t seed);

}  // namespace gonio::reassembly_experiment
