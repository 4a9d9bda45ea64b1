// Photographs as a pinhole camera would have taken them: the camera that fits, and the resampling.
//
// For every pixel of the pinhole's picture the ray through its centre is projected by the calibrated camera; the source
// is interpolated there by a separable kernel:
//   keys      cubic convolution with a = -1/2 (Keys, IEEE Trans. ASSP 29(6), 1981): exact for polynomials of degree 2
//   mitchell  B = C = 1/3 (Mitchell & Netravali, SIGGRAPH 1988): exact for degree 1; blurs, even at whole pixels
//   lanczos3  sinc x sinc(x / 3), weights corrected in sum and first moment: sharpest; exact for degree 1
// Where the picture shrinks (stretch > 1) the kernel is widened by that factor. Keys and Lanczos overshoot at edges by
// up to 7 and 9 % of the step; the values are kept, below zero, too, unless the caller limits them to the footprint's.
//
// Behind a mosaic of filters (camera/mosaic.h) the picture stays a mosaic of the same pattern, and every filter is
// resampled on its own lattice: the pixel (x, y) of the pinhole's picture stands behind the filter of parity (x mod 2,
// y mod 2), its ray meets the source at (u, v), and the kernel reads the samples (2 i + x mod 2, 2 j + y mod 2) alone,
// at the lattice position ((u - x mod 2) / 2, (v - y mod 2) / 2). Positions are those of pixel centres, so nothing
// shifts by half a pixel between filters; the two greens of a Bayer mosaic are two filters. The kernel is as wide as on
// a picture of half the size: what is finer than four pixels aliases, as it did in the sensor.
//
// A pixel is valid where every sample that its kernel weighs lies inside the picture and is good. Saturated samples are
// not good: an interpolation over clipped codes is neither the light nor a bound for it (sensor.clipped-resampling).
// Channels: colour as it is, so linear light must go in; a channel "variance.*" is summed with squared weights, the
// variance of the interpolated value (neighbours are then correlated, which no channel says).
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "camera/camera_model.h"
#include "io/image.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

enum class Kernel { keys, mitchell, lanczos3 };
inline constexpr std::array<std::string_view, 3> kernel_names = {"keys", "mitchell", "lanczos3"};  // in this order
double kernel_radius(Kernel kernel);
double kernel_weight(Kernel kernel, double distance_px);  // Lanczos: before its correction

enum class Keep { valid, all, same };
struct PinholeChoice {
  Keep keep = Keep::valid;  // valid: the largest picture without invalid pixels; all: every source pixel is in it;
                            // same: size, focal lengths and principal point stay
  double scale = 1;         // focal length over the geometric mean of the source's
  double largest_angle_rad = 80 * pi / 180;  // from the axis; a pinhole cannot show 90 degrees
  Kernel kernel = Kernel::keys;              // its margin counts as invalid
  int pitch = 1;                             // pixels to the next behind the same filter; 2: the mosaic stays
};
// Square pixels (but for `same`), no lens. A camera that has both already is returned as it is when scale is 1.
// Error(data) at `place` where nothing remains or the picture would have more than 2^28 pixels.
manifest::Camera pinhole_for(const manifest::Camera& lens, const PinholeChoice& choice, const std::string& place);

struct Resampling {
  Kernel kernel = Kernel::keys;
  double stretch = 1;            // source pixels per pixel, at least 1
  bool limit_overshoot = false;  // each value within those of its footprint
  int pitch = 1;                 // of the filters, see PinholeChoice
};
struct Undistorted {
  io::Image picture;                // 0 where the ray meets no source pixel
  std::vector<std::uint8_t> valid;  // per pixel, 1 or 0
};
// `good`: per source pixel, or empty: all. Pixels that are not finite are never good. Parallel by rows; the result does
// not depend on the number of threads.
Undistorted undistort(const io::Image& source, const std::vector<std::uint8_t>& good, const CameraModel& from,
                      const CameraModel& to, const Resampling& resampling);

}  // namespace gonio::camera
