// How long exposures of one view really lasted, from what they read: a shutter keeps its times to a per cent, readings
// of thousands of pixels tell them to a hundredth of that.
//   x_pk = L_p t_k (1 + d_k) + noise,   least squares over L and d with the weights 1 / V(L_p t_k)
// Each pixel's L is eliminated (Schur complement), which leaves one number for each exposure but the one that is read
// best, whose stated time is the unit: exposures alone know no absolute time. Pixels that contradict themselves by more
// than noise (something moved) are left out.
#pragma once
#include <vector>

#include "photograph/sensor_noise.h"

namespace gonio::photograph {

struct ExposureSamples {
  std::vector<double> exposures_s;        // as stated
  std::vector<std::vector<float>> codes;  // [exposure][pixel], black taken off; not a number where it cannot be used
  SensorNoise noise;
  double full_scale = 0;
};

struct RefinedExposures {
  std::vector<double> exposures_s, sigma_s;  // sigma 0: as stated, the unit or one that shares no pixel with others
};

RefinedExposures refine_exposures(const ExposureSamples& samples);

}  // namespace gonio::photograph
