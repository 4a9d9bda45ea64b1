// What roughness a set of directions can tell.
//
// A lobe of facets depends on the slope of the half vector, r = tan theta_h, and has its shape between the peak, r < a
// / 2, where GGX still has 0.64 of it, and the flank, a / 2 < r < 3 a / 2, down to 0.1. With a sample in either its
// height and width are two numbers from two readings; without, one of them is free. The least roughness is the
// smallest a above which every roughness has both.
#pragma once
#include <string>

#include "goniometry/samples.h"

namespace gonio::goniometry {

double least_alpha(const Samples& samples);
// "alpha < 0.02 cannot be told from these angles: ..."
std::string too_narrow(double least);

// Do half vectors leave their plane: can these directions tell a direction of the sample?
bool turns_about_normal(const Samples& samples);

}  // namespace gonio::goniometry
