// How long exposures of one view really lasted, from what they read: a shutter keeps its times to a per cent, readings
// of thousands of pixels tell them to a hundredth of that.
//   x_pk = L_p t_k (1 + d_k) + noise,   least squares over L and d with the weights 1 / V(L_p t_k)
// Each pixel's L is eliminated (Schur complement), which leaves one number for each exposure but the one that is read
// best, whose stated time is the unit: exposures alone know no absolute time. Pixels that contradict themselves by more
// than noise (something moved) are left out, and readings below a tenth of full scale: what is left of black would be
// taken for time there.
#pragma once
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "photograph/noise_variance.h"

namespace gonio::photograph {

struct ExposureSamples {
  std::vector<double> exposures_s;        // as stated
  std::vector<std::vector<float>> codes;  // [exposure][pixel], black taken off; not a number where it cannot be used
  NoiseModel noise;
  double full_scale = 0;
  double floor = -std::numeric_limits<double>::infinity();  // the lowest code: readings near it are a selection, too
};

// The rate that makes one pixel's readings likeliest, and the exposures that it is from: those clear of full scale
// and of the floor.
double rate_of(const ExposureSamples& samples, const std::vector<double>& exposures_s, std::size_t pixel,
               std::vector<std::size_t>& used);

struct RefinedExposures {
  std::vector<double> exposures_s, sigma_s;  // sigma 0: as stated, the unit or one that shares no pixel with others
};

RefinedExposures refine_exposures(const ExposureSamples& samples);

// Gain and read noise that make the exposures agree with each other as much as noise lets them: squares of residuals,
// over what the fit of each pixel's rate leaves of them, against the expected code (photon transfer, without a second
// frame of any exposure). `samples.noise` is where it starts. Nothing where fewer than two exposures overlap.
struct StackNoise {
  manifest::Noise noise;
  double gain_sigma = 0, read_sigma = 0;
};
std::optional<StackNoise> noise_of_stack(ExposureSamples samples);

}  // namespace gonio::photograph
