// Parallel ridges with the profile of a saw (relief/ridges.h): they run along u, their long facets tilt towards v. The
// crest is the top of the layer; a layer that is thinner than the ridges are high cannot hold them.
#include "relief/ridges.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "relief/along.h"
#include "relief/microstructure.h"
#include "report/number_text.h"

namespace gonio::relief {
namespace {

class Ridges final : public Microstructure {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::microstructure,
        .id = "ridges",
        .sentence = "Parallel ridges: long facets that tilt, walls at right angles to them.",
        .source = "Luongo et al. 2017; Luongo et al. 2020, figure 13",
        .parameters = {{.name = "ridge_rad",
                        .unit = "rad",
                        .preset = {},
                        .lower = 1e-3,
                        .upper = 0.786,
                        .meaning = "tilt of the long facets"},
                       {.name = "pitch_m",
                        .unit = "m",
                        .preset = {},
                        .lower = 1e-9,
                        .upper = 1,
                        .meaning = "from crest to crest"},
                       turn_parameter(),
                       cell_parameter()},
        .attachment = manifest::Attachment::picture,
        .attachment_meaning = cells_meaning,
        .attachment_as_sent = true};
    return info;
  }
  ShareAt made(std::span<const double> amounts, double depth_m, const MicrostructureFiles& files,
               const std::string& place) const override {
    RidgeShape shape;
    shape.ridge_rad = amounts[0], shape.pitch_m = amounts[1];
    check_ridges(shape);
    const double high_m = shape.pitch_m * std::sin(shape.ridge_rad) * std::cos(shape.ridge_rad);
    if (high_m > depth_m * (1 + 1e-9))
      throw Error(Exit::data, place + "/pitch_m",
                  "makes ridges " + report::number_text(high_m * 1e6, 3) + " um" + " high, a layer is " +
                      report::number_text(depth_m * 1e6, 3) + " um",
                  "take a pitch of at most " + report::number_text(shape.pitch_m * depth_m / high_m * 1e6, 3) + " um" +
                      ", or a thicker layer");
    return [shape, depth_m, turn = TurnByCells(amounts[2], files.picture, amounts[3], place)](const SurfacePlace& at) {
      return std::clamp(1 + ridge_profile_m(shape, turn(at.along_m).y) / depth_m, 0.0, 1.0);
    };
  }
};

}  // namespace

namespace microstructures {
const Microstructure& ridges() {
  static const Ridges structure;
  return structure;
}
}  // namespace microstructures

}  // namespace gonio::relief
