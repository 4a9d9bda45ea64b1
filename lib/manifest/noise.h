// Noise of a camera's pixels, as sections of the manifest state it.
#pragma once

namespace gonio::manifest {

struct Noise {  // of a linear value v: variance v / gain + read^2
  double gain = 0, read = 0;
};

}  // namespace gonio::manifest
