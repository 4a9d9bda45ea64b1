// See projection_map.h.
#include "camera/quality/projection_map.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "camera/camera_model.h"
#include "report/colour_map.h"
#include "stats/intervals.h"

namespace gonio::camera {

ImageGrid image_grid(int width_px, int height_px, int longer_side) {
  ImageGrid grid;
  grid.step_px = std::max(1.0, static_cast<double>(std::max(width_px, height_px)) / longer_side);
  grid.columns = std::max(1, static_cast<int>(std::round(width_px / grid.step_px)));
  grid.rows = std::max(1, static_cast<int>(std::round(height_px / grid.step_px)));
  return grid;
}

ProjectionMap projection_map(const ProjectionLaw& law, const CameraResult& result, double distance_m, int longer_side) {
  ProjectionMap map{distance_m, image_grid(result.width_px(), result.height_px(), longer_side), {}, {}, 0, 0};
  const CameraModel camera(result.lens(), result.width_px(), result.height_px());
  const auto columns = static_cast<std::size_t>(map.grid.columns), rows = static_cast<std::size_t>(map.grid.rows);
  map.covariance.resize(columns * rows);
  map.radius_px.resize(columns * rows, std::nan(""));
  const bool far = !std::isfinite(distance_m);
  parallel_for(0, rows, [&](std::size_t j) {
    for (std::size_t i = 0; i < columns; ++i) {
      const Vec3 direction = camera.ray(map.grid.pixel(static_cast<int>(i), static_cast<int>(j))).direction;
      const auto c = law.at(far ? direction : direction * distance_m, far);
      if (!c) continue;
      map.covariance[j * columns + i] = *c;
      map.radius_px[j * columns + i] = radius_95(*c);
    }
  });
  std::vector<double> known;
  for (std::size_t k = 0; k < map.radius_px.size(); ++k) {
    if (!std::isfinite(map.radius_px[k])) continue;
    known.push_back(map.radius_px[k]);
    map.mean_variance += map.covariance[k].trace();
  }
  map.within_px = known.empty() ? 0 : stats::quantile(known, 0.95);
  map.mean_variance /= static_cast<double>(std::max<std::size_t>(1, known.size()));
  return map;
}

io::Image values_of(const ProjectionMap& map) {
  io::Image image(map.grid.columns, map.grid.rows, {"radius_95", "sigma_u", "sigma_v"});
  for (std::size_t k = 0; k < map.radius_px.size(); ++k) {
    image.data[3 * k] = static_cast<float>(map.radius_px[k]);
    image.data[3 * k + 1] = static_cast<float>(std::sqrt(map.covariance[k].uu));
    image.data[3 * k + 2] = static_cast<float>(std::sqrt(map.covariance[k].vv));
  }
  return image;
}

std::pair<double, double> radius_range(const std::vector<ProjectionMap>& maps) {
  std::vector<double> known;
  for (const ProjectionMap& map : maps)
    for (const double r : map.radius_px)
      if (std::isfinite(r)) known.push_back(r);
  if (known.empty()) return {0.5, 1};
  const auto [low, high] = std::ranges::minmax(known);
  return {std::max(low, 1e-6), std::max(high, 2 * std::max(low, 1e-6))};
}

io::Image picture_of(const ProjectionMap& map, double lower_px, double upper_px) {
  io::Image image(map.grid.columns, map.grid.rows, {"R", "G", "B"});
  for (std::size_t k = 0; k < map.radius_px.size(); ++k) {
    const report::Colour colour =
        report::magnitude_colour(std::log(map.radius_px[k] / lower_px) / std::log(upper_px / lower_px));
    std::copy(colour.begin(), colour.end(), image.data.begin() + static_cast<std::ptrdiff_t>(3 * k));
  }
  return image;
}

}  // namespace gonio::camera
