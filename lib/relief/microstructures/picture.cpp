// A picture laid over the surface, white at the top of the layer and black at its bottom: what cannot be said by a
// formula. Its rows run along u, its columns against v, its centre lies at the origin of both; beyond its edges it is
// what `beyond` says, so that a code has its quiet zone. Between the centres of its pixels it is linear, or, of `sharp`
// 1, every pixel is one square.
#include <cmath>

#include "base/error.h"
#include "relief/along.h"
#include "relief/microstructure.h"

namespace gonio::relief {
namespace {

double between(const io::GreyImage& picture, double x, double y, double beyond) {
  const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
  const auto at = [&](int i, int j) {
    return pixel_share(picture, static_cast<int>(x0) + i, static_cast<int>(y0) + j, beyond);
  };
  return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}

class Picture final : public Microstructure {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::microstructure,
        .id = "picture",
        .sentence = "A picture as heights.",
        .source = "",
        .parameters =
            {{.name = "pixel_m", .unit = "m", .preset = {}, .lower = 1e-9, .upper = 1, .meaning = "size of its pixels"},
             {.name = "beyond",
              .unit = "1",
              .preset = 1.0,
              .lower = 0,
              .upper = 1,
              .meaning = "what lies beyond its edges"},
             {.name = "sharp",
              .unit = "1",
              .preset = 1.0,
              .lower = 0,
              .upper = 1,
              .meaning = "1: pixels are squares; below: linear between their centres"},
             turn_parameter()},
        .attachment = manifest::Attachment::picture,
        .attachment_meaning = "the picture, as sent",
        .attachment_as_sent = true};
    return info;
  }
  ShareAt made(std::span<const double> amounts, double, const MicrostructureFiles& files,
               const std::string& place) const override {
    if (files.picture == nullptr) throw Error(Exit::data, place + "/file", "is missing", "name the picture's file id");
    return [picture = files.picture, pixel_m = amounts[0], beyond = amounts[1], sharp = amounts[2] >= 1,
            turn = Turn(amounts[3])](const SurfacePlace& at) {
      const Vec2 p = turn(at.along_m);
      const auto [x, y] = in_pixels(*picture, p, pixel_m);
      if (!sharp) return between(*picture, x, y, beyond);
      return pixel_share(*picture, static_cast<int>(std::floor(x + 0.5)), static_cast<int>(std::floor(y + 0.5)),
                         beyond);
    };
  }
};

}  // namespace

namespace microstructures {
const Microstructure& picture() {
  static const Picture structure;
  return structure;
}
}  // namespace microstructures

}  // namespace gonio::relief
