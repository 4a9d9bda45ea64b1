// What no ball shows, from its neighbours.
#pragma once
#include "io/image.h"

namespace gonio::probe {

// Texels of a latitude-longitude picture whose `weight` (first channel) is zero take the mean of what is seen about
// them, the nearer the more: means over ever larger blocks are made from what is seen alone, and holes are filled from
// the finest level that has anything (pull-push: Gortler, Grzeszczuk, Szeliski & Cohen, The Lumigraph, SIGGRAPH 1996).
// Columns meet round the sphere. Without any seen texel nothing changes.
void fill_unseen(io::Image& radiance, const io::Image& weight);

}  // namespace gonio::probe
