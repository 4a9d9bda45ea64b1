// What a picture shows of each patch of a chart: robust means with their covariance.
//
// Of a patch the inner 60 % (in width and height) is read. Pixels far from the median (dust, highlights) are left out,
// about it by robust sigma. Neighbouring pixels share noise behind a mosaic, and patches have texture: the covariance
// of the mean is that of the means of 4 x 4 cells of the patch about a plane, which is the light's, over their number.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "colour/chart.h"
#include "colour/chart_pose.h"
#include "io/image.h"

namespace gonio::colour {

// What a pixel is good for.
enum class PixelState : std::uint8_t { good, clipped, masked };

struct PatchReading {
  Rgb rgb;
  Mat3 covariance;         // of the mean
  std::size_t pixels = 0;  // that counted
  std::string left_out;    // why it does not count: "clipped", "masked", "not-finite"; empty: it does
};

// `picture`: R, G, B, linear; `states`: one entry per pixel, or empty. A patch does not count where more than 1 % of
// its pixels are clipped, for what is left is a selection; or more than 40 % masked; or any is not finite. Error(data)
// at `place` for patches outside of the picture, or of less than 4 x 4 pixels.
std::vector<PatchReading> read_patches(const io::Image& picture, std::span<const PixelState> states,
                                       const ChartPose& pose, const Chart& chart, const std::string& place);

}  // namespace gonio::colour
