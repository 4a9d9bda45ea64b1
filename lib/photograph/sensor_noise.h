// Noise of a linear sensor's readings (EMVA 1288): V(x) = x / gain + read^2 of a code x above black.
#pragma once

namespace gonio::photograph {

struct SensorNoise {
  double gain = 1;  // electrons per code
  double read = 1;  // codes
  double variance(double code) const { return (code > 0 ? code : 0) / gain + read * read; }
};

}  // namespace gonio::photograph
