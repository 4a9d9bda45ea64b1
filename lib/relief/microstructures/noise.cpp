// The published solid noise (relief/sparse_convolution.h) as a grey value: rough, and what breaks the staircase of
// layers. Luongo et al. 2020 state A and B; what length the argument 1 stands for they do not.
// Stretched, it is the mean along u: line integral convolution (Cabral & Leedom 1993; Battke, Stalling & Hege 1997) on
// straight lines of the tangent plane, for lengths over which the surface is flat. The mean over n cells is flatter, by
// about 1 / sqrt(n): ask for more amplitude.
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "relief/along.h"
#include "relief/microstructure.h"
#include "relief/sparse_convolution.h"

namespace gonio::relief {
namespace {

class Noise final : public Microstructure {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::microstructure,
        .id = "noise",
        .sentence = "Solid sparse convolution noise: amplitude / 2 noise(frequency p / unit_m) + 1/2.",
        .source = "Luongo et al. 2020, appendix A",
        .parameters = {{.name = "amplitude", .unit = "1", .preset = 1.0, .lower = 0, .upper = 1e3, .meaning = "A"},
                       {.name = "frequency",
                        .unit = "1",
                        .preset = 32.0,
                        .lower = 1e-6,
                        .upper = 1e9,
                        .meaning = "B: cells in unit_m"},
                       {.name = "unit_m",
                        .unit = "m",
                        .preset = 1e-3,
                        .lower = 1e-9,
                        .upper = 1e3,
                        .meaning = "the length that B counts cells in"},
                       {.name = "stretch_m",
                        .unit = "m",
                        .preset = 0.0,
                        .lower = 0,
                        .upper = 1,
                        .meaning = "length along u over which the noise is drawn out"},
                       turn_parameter()}};
    return info;
  }
  ShareAt made(std::span<const double> amounts, double, const MicrostructureFiles&,
               const std::string& place) const override {
    const double amplitude = amounts[0], per_m = amounts[1] / amounts[2], cells = amounts[3] * per_m;
    if (!(cells > 0)) return [=](const SurfacePlace& at) { return published_noise_grey(at.body_m * per_m, amplitude); };
    constexpr double most_cells = 256;
    if (cells > most_cells)
      throw Error(Exit::data, place, format("draws noise out over %.3g cells", cells),
                  format("limit %.0f: a shorter stretch_m", most_cells));
    const int steps = static_cast<int>(std::ceil(4 * cells));  // the filter of an impulse is a cell wide
    return [=, c = std::cos(amounts[4]), s = std::sin(amounts[4])](const SurfacePlace& at) {
      const Vec3 along = at.u * c + at.v * s;
      double sum = 0;
      for (int k = 0; k < steps; ++k)
        sum += published_noise(at.body_m * per_m + along * (((k + 0.5) / steps - 0.5) * cells));
      return published_noise_grey(sum / steps, amplitude);
    };
  }
};

}  // namespace

namespace microstructures {
const Microstructure& noise() {
  static const Noise structure;
  return structure;
}
}  // namespace microstructures

}  // namespace gonio::relief
