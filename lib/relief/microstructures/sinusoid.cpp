// A wave along each of two axes: bumps and hollows in rows, whose lengths say how rough the surface is along each.
//   I(u, v) = 1 + share (sin(2 pi u / wave_u_m) sin(2 pi v / wave_v_m) - 1) / 2      (Luongo et al. 2020, equation 3,
// which has share 1); a wave of length 0 is left out (its sine is 1).
#include <cmath>
#include <numbers>

#include "relief/along.h"
#include "relief/microstructure.h"

namespace gonio::relief {
namespace {

class Sinusoid final : public Microstructure {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::microstructure,
        .id = "sinusoid",
        .sentence = "Two waves at right angles, multiplied.",
        .source = "Luongo et al. 2020, equation 3",
        .parameters = {{.name = "wave_u_m", .unit = "m", .preset = {}, .lower = 0, .upper = 1, .meaning = "along u"},
                       {.name = "wave_v_m", .unit = "m", .preset = 0.0, .lower = 0, .upper = 1, .meaning = "along v"},
                       {.name = "share", .unit = "1", .preset = 1.0, .lower = 0, .upper = 1, .meaning = "of the layer"},
                       turn_parameter(),
                       cell_parameter()},
        .attachment = manifest::Attachment::picture,
        .attachment_meaning = cells_meaning,
        .attachment_as_sent = true};
    return info;
  }
  ShareAt made(std::span<const double> amounts, double, const MicrostructureFiles& files,
               const std::string& place) const override {
    const auto per_m = [](double wave_m) { return wave_m > 0 ? 2 * std::numbers::pi / wave_m : 0; };
    return [u = per_m(amounts[0]), v = per_m(amounts[1]), share = amounts[2],
            turn = TurnByCells(amounts[3], files.picture, amounts[4], place)](const SurfacePlace& at) {
      const Vec2 p = turn(at.along_m);
      const double wave = (u > 0 ? std::sin(u * p.x) : 1) * (v > 0 ? std::sin(v * p.y) : 1);
      return 1 + share * (wave - 1) / 2;
    };
  }
};

}  // namespace

namespace microstructures {
const Microstructure& sinusoid() {
  static const Sinusoid structure;
  return structure;
}
}  // namespace microstructures

}  // namespace gonio::relief
