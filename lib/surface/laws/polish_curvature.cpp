// Roughness of hand-polished metal: flat parts get polished, curved ones do not.
//   value = rho + (1 - rho) / (1 + exp(s (1 - |H| / c)))
// |H| the mean curvature (per metre, mesh/curvature.h), c the parameter curvature_per_m: there the value is midway
// between rho and 1. Hannemose et al. 2020, "Alignment of rendered images with photographs", equation 11, writes
// 30 |H.n| with H divided by the mesh's longest mean curvature normal, so that 30 stands for a curvature that depends
// on the mesh: theirs is c = max |H| / 30. Where |H| = 0 the value is rho + (1 - rho) / (1 + exp(s)), not rho.
// Continuous and rising in |H|.
#include <cmath>

#include "surface/law.h"

namespace gonio::surface {
namespace {

class PolishCurvature final : public Law {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::law,
        .id = "polish-curvature",
        .sentence = "Roughness of hand-polished metal by the surface's mean curvature.",
        .source = "Hannemose et al. 2020, equation 11; Meyer et al. 2003",
        .parameters = {{.name = "rho",
                        .unit = "1",
                        .preset = {},
                        .lower = 0,
                        .upper = 1,
                        .meaning = "least value, approached on flat parts for large s"},
                       {.name = "s",
                        .unit = "1",
                        .preset = {},
                        .lower = 0,
                        .upper = 1000,
                        .meaning = "how abruptly polish ends where the surface curves"},
                       {.name = "curvature_per_m",
                        .unit = "1/m",
                        .preset = {},
                        .lower = 1e-6,
                        .upper = 1e9,
                        .meaning = "mean curvature at which the value is midway between rho and 1"}},
    };
    return info;
  }

  bool needs_curvature() const override { return true; }

  double value(std::span<const double> amounts, const LocalGeometry& here) const override {
    const double rho = amounts[0], s = amounts[1], relative = std::abs(here.mean_curvature_per_m) / amounts[2];
    return rho + (1 - rho) / (1 + std::exp(s * (1 - relative)));
  }
};

}  // namespace

const Law& polish_curvature() {
  static const PolishCurvature law;
  return law;
}

}  // namespace gonio::surface
