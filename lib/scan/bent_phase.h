// A projector whose light is the power gamma of what is sent to it bends cosines: light = ((1 + cos t) / 2)^gamma,
// whose harmonics are
//   a_(h+1) / a_h = (gamma - h) / (gamma + h + 1),   so  a_2 / a_1 = r = (gamma - 1) / (gamma + 2),
//   gamma = (1 + 2 r) / (1 - r).
// Four shifts and more show the second one; any number of them has phases that are wrong by a function of the phase
// alone, which is inverted (Pan, Huang & Chiang 2006; Hoang et al. 2010). Levels beyond which all is shown alike
// (projector_tone.h) make another such function. Lenses take most from the highest harmonics: where they leave the
// share d of a cosine, a Gaussian spot leaves d^(h^2) of its harmonic h. What they truly take nobody knows: 7 % of the
// corrections' root mean square is left as their uncertainty. For this room.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geom/mat3_inverse.h"
#include "scan/projector_tone.h"

namespace gonio::scan {

struct ProjectorGamma {
  double gamma = 1, sigma = 0;
};

// Sums of readings with cos and sin of twice the shift, pixel by pixel; `phase` not a number where one does not count.
// `shifts`: how many, in equal steps. The standard deviation is from the scatter over tiles of the picture. Nothing
// below four shifts, or where hardly anything is lit.
struct SecondHarmonic {
  std::size_t shifts = 0;
  std::span<const float> with_cos, with_sin, phase, amplitude;
  int width = 0;
};
std::optional<ProjectorGamma> gamma_of(const SecondHarmonic& seen);

bool in_equal_steps(std::span<const double> shifts_rad);

// What least squares over shifts find of a bent cosine.
class BentPhase {
 public:
  // `solve`: inverse normal matrix of (1, cos, sin) at these shifts; `left`: of a cosine's amplitude, by lenses.
  BentPhase(const ProjectorTone& tone, std::span<const double> shifts_rad, const Mat3& solve, double left);
  struct True {
    double theta = 0, sigma = 0;
  };
  // `sigma`: of the phase that was found; what the tone and the lens leave unknown is added.
  True straightened(double theta, double sigma) const;

 private:
  std::vector<double> off_, unknown_;  // found less true, by true phase; its standard deviation by the tone's
  double of_lens_ = 0;                 // rad
};

}  // namespace gonio::scan
