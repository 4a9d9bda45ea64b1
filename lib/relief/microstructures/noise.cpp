// The published solid noise (relief/sparse_convolution.h) as a grey value: rough, and what breaks the staircase of
// layers. Luongo et al. 2020 state A and B; what length the argument 1 stands for they do not.
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
                        .meaning = "the length that B counts cells in"}}};
    return info;
  }
  ShareAt made(std::span<const double> amounts, double, const MicrostructureFiles&, const std::string&) const override {
    return [amplitude = amounts[0], per_m = amounts[1] / amounts[2]](const SurfacePlace& at) {
      return published_noise_grey(at.body_m * per_m, amplitude);
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
