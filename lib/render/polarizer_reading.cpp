// See polarizer_reading.h.
#include "render/polarizer_reading.h"

#include "render/mechanisms/sensor_crosstalk.h"
#include "render/mosaic.h"

namespace gonio::render {
namespace {

// At the border the samples that are not there give nothing and take nothing.
io::Image with_crosstalk(const io::Image& own, double share) {
  io::Image result = own;
  for (int y = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x) {
      double sum = own.at(x, y, 0), count = 1;
      const auto add = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= own.width || v >= own.height) return;
        sum += own.at(u, v, 0), count += 1;
      };
      add(x - 1, y), add(x + 1, y), add(x, y - 1), add(x, y + 1);
      result.at(x, y, 0) = static_cast<float>(equation::sensor_crosstalk(own.at(x, y, 0), share, sum, count));
    }
  return result;
}

}  // namespace

Vec2 radius_of(const camera::CameraModel& camera, double x, double y) {
  const Vec2 middle = camera.principal_point_px();
  const double half = 0.5 * camera.width_px();
  return {(x - middle.x) / half, (y - middle.y) / half};
}

io::Image polarizer_reading(const std::vector<io::Image>& stokes, const photograph::PolarizerArray& array,
                            const camera::CameraModel* camera) {
  const io::Image& first = stokes.at(0);
  io::Image bands(first.width, first.height, {"R", "G", "B"});
  for (int y = 0; y < first.height; ++y)
    for (int x = 0; x < first.width; ++x) {
      const Vec2 radius = camera != nullptr ? radius_of(*camera, x, y)
                                            : Vec2{(2 * x - first.width + 1.0) / first.width,
                                                   (2 * y - first.height + 1.0) / first.width};
      const std::array<double, 4> row = photograph::analyser(array, x, y, radius);
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t k = 0; k < stokes.size(); ++k) sum += row[k] * double{stokes[k].at(x, y, c)};
        bands.at(x, y, c) = static_cast<float>(sum);
      }
    }
  const io::Image reading = luminance(bands);
  return array.share > 0 ? with_crosstalk(reading, array.share) : reading;
}

}  // namespace gonio::render
