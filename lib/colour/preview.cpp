// See preview.h.
#include "colour/preview.h"

#include <algorithm>
#include <cmath>

#include "geom/mat3_inverse.h"
#include "io/picture.h"

namespace gonio::colour {
namespace {

constexpr double halves = 0.6;  // of a patch's width

class Drawing {
 public:
  Drawing(const Chart& chart, const ChartPose& pose, const Calibration& calibration)
      : chart_(chart),
        calibration_(calibration),
        chart_from_image_(inverse(pose.image_from_chart)),
        srgb_(from_xyz_d50(Target::srgb)),
        srgb_from_target_(srgb_ * inverse(from_xyz_d50(calibration.correction.target()))) {}

  Rgb pixel(Rgb read, double x, double y, bool corrected) const {
    const Vec3 h = chart_from_image_ * Vec3{x, y, 1};
    const Vec2 at{h.x / h.z, h.y / h.z};
    for (std::size_t p = 0; h.z > 0 && p < chart_.patches.size(); ++p) {
      const Patch& patch = chart_.patches[p];
      const Vec2 off = at - patch.centre;
      if (std::abs(off.x) > halves / 2 * patch.size.x || std::abs(off.y) > halves / 2 * patch.size.y) continue;
      if (off.x > 0) return srgb_ * patch.xyz;
      if (calibration_.patches[p].fitted) return shown(calibration_.patches[p].evened, corrected);
    }
    return shown(read, corrected);
  }

 private:
  Rgb shown(Rgb read, bool corrected) const {
    const Rgb w = calibration_.white;
    return corrected ? srgb_from_target_ * calibration_.correction(read)
                     : Rgb{read.x / w.x, read.y / w.y, read.z / w.z};
  }
  const Chart& chart_;
  const Calibration& calibration_;
  Mat3 chart_from_image_, srgb_, srgb_from_target_;
};

// Mean of the pixels that one of the smaller picture stands for.
Rgb mean_of(const io::Image& picture, int x, int y, int shrink) {
  Rgb sum;
  double count = 0;
  for (int j = y * shrink; j < std::min((y + 1) * shrink, picture.height); ++j)
    for (int i = x * shrink; i < std::min((x + 1) * shrink, picture.width); ++i)
      sum += Rgb{picture.at(i, j, 0), picture.at(i, j, 1), picture.at(i, j, 2)}, ++count;
  return sum / count;
}

}  // namespace

io::Image before_and_after(const io::Image& picture, const Chart& chart, const ChartPose& pose,
                           const Calibration& calibration, int longest) {
  const int shrink = std::max(1, (std::max(picture.width, picture.height) + longest - 1) / longest);
  const int width = (picture.width + shrink - 1) / shrink, height = (picture.height + shrink - 1) / shrink;
  const Drawing drawing(chart, pose, calibration);
  io::Image out(2 * width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb read = mean_of(picture, x, y, shrink);
      const double across = (x + 0.5) * shrink - 0.5, down = (y + 0.5) * shrink - 0.5;
      for (const bool corrected : {false, true}) {
        const Rgb colour = drawing.pixel(read, across, down, corrected);
        for (int c = 0; c < 3; ++c)
          out.at(x + (corrected ? width : 0), y, c) =
              io::srgb_from_linear(std::clamp(static_cast<float>(colour[c]), 0.0f, 1.0f));
      }
    }
  return out;
}

}  // namespace gonio::colour
