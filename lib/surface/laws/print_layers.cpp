// Layers of a print whose surfaces differ: every second one is rougher.
//   k = floor((x.p - offset) / thickness),   value = even for even k, odd for odd k
// x the position in the object frame, p the print direction. Over `transition_m` about each boundary the value passes
// from one to the other as 3 t^2 - 2 t^3; it is then continuous. At 0 it jumps; the boundary belongs to the layer
// above.
#include <algorithm>
#include <cmath>

#include "surface/law.h"
#include "surface/law_direction.h"

namespace gonio::surface {
namespace {

enum : std::size_t { even_index, odd_index, thickness_index, offset_index, transition_index, polar_index, turn_index };

class PrintLayers final : public Law {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::law,
        .id = "print-layers",
        .sentence = "Layers of a print, alternating between two values.",
        .source = "layered roughness of printed objects",
        .parameters = with_print_direction({{.name = "alpha_even",
                                             .unit = "1",
                                             .preset = {},
                                             .lower = 0,
                                             .upper = 1,
                                             .meaning = "value in layers 0, 2, 4, ..."},
                                            {.name = "alpha_odd",
                                             .unit = "1",
                                             .preset = {},
                                             .lower = 0,
                                             .upper = 1,
                                             .meaning = "value in layers 1, 3, 5, ..."},
                                            {.name = "layer_m",
                                             .unit = "m",
                                             .preset = {},
                                             .lower = 1e-9,
                                             .upper = 1e3,
                                             .meaning = "thickness of a layer"},
                                            {.name = "offset_m",
                                             .unit = "m",
                                             .preset = 0,
                                             .lower = -1e3,
                                             .upper = 1e3,
                                             .meaning = "height of layer 0's lower boundary"},
                                            {.name = "transition_m",
                                             .unit = "m",
                                             .preset = 0,
                                             .lower = 0,
                                             .upper = 1e3,
                                             .meaning = "height over which values pass into each other, at most a "
                                                        "layer's thickness"}}),
    };
    return info;
  }

  double value(std::span<const double> amounts, const LocalGeometry& here) const override {
    const double thickness = amounts[thickness_index];
    const double height = dot(here.position_m, print_direction(amounts[polar_index], amounts[turn_index]));
    const double layers = (height - amounts[offset_index]) / thickness;
    const double boundary = std::round(layers);  // between the layers boundary - 1 and boundary
    const double past = layers - boundary, width = std::min(1.0, amounts[transition_index] / thickness);
    const double t = width > 0 ? std::clamp(past / width + 0.5, 0.0, 1.0) : past >= 0 ? 1.0 : 0.0;
    const double share = t * t * (3 - 2 * t);
    const bool above_is_even = std::fmod(boundary, 2.0) == 0;
    const double above = amounts[above_is_even ? even_index : odd_index];
    const double below = amounts[above_is_even ? odd_index : even_index];
    return below * (1 - share) + above * share;
  }
};

}  // namespace

const Law& print_layers() {
  static const PrintLayers law;
  return law;
}

}  // namespace gonio::surface
