// Roughness of printed layers: steps show where a surface slopes against the layers, and neither on walls (n across the
// print direction) nor on decks (n along it).
//   value = rho + (1 - rho) |sin(2 t)|^s / s,   |sin(2 t)| = 2 |n.p| sqrt(1 - (n.p)^2)
// t the angle between the normal n and the print direction p, object frame. Hannemose et al. 2020, "Alignment of
// rendered images with photographs", equation 10. The division by s makes the bumps at 45 degrees lower, not only
// narrower, for s > 1; for s < 1 it lifts them to rho + (1 - rho) / s > 1, where the value is kept at 1. Continuous in
// n.
#include <algorithm>
#include <cmath>

#include "surface/law.h"
#include "surface/law_direction.h"

namespace gonio::surface {
namespace {

class PrintNormal final : public Law {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::law,
        .id = "print-normal",
        .sentence = "Roughness of printed layers by the surface's slope against the print direction.",
        .source = "Hannemose et al. 2020, equation 10",
        .parameters = with_print_direction({{.name = "rho",
                                             .unit = "1",
                                             .preset = {},
                                             .lower = 0,
                                             .upper = 1,
                                             .meaning = "least value, on walls and decks"},
                                            {.name = "s",
                                             .unit = "1",
                                             .preset = {},
                                             .lower = 0.01,
                                             .upper = 1000,
                                             .meaning = "shininess: the bump at 45 degrees is (1 - rho) / s high"}}),
    };
    return info;
  }

  double value(std::span<const double> amounts, const LocalGeometry& here) const override {
    const double rho = amounts[0], s = amounts[1];
    const double z = std::min(1.0, std::abs(dot(here.normal, print_direction(amounts[2], amounts[3]))));
    return std::min(1.0, rho + (1 - rho) * std::pow(2 * z * std::sqrt(1 - z * z), s) / s);
  }
};

}  // namespace

const Law& print_normal() {
  static const PrintNormal law;
  return law;
}

}  // namespace gonio::surface
