// The projection uncertainty over the image, at one distance from the camera: a coarse grid over the image's pixels.
#pragma once
#include <utility>
#include <vector>

#include "camera/quality/projection_law.h"
#include "io/image.h"

namespace gonio::camera {

// Points of the image, evenly: cell (i, j) has its middle at pixel ((i + 0.5) step - 0.5, (j + 0.5) step - 0.5).
struct ImageGrid {
  int columns = 0, rows = 0;
  double step_px = 1;
  Vec2 pixel(int i, int j) const { return {(i + 0.5) * step_px - 0.5, (j + 0.5) * step_px - 0.5}; }
};
ImageGrid image_grid(int width_px, int height_px, int longer_side);

struct ProjectionMap {
  double distance_m = 0;  // along the ray; infinity is one
  ImageGrid grid;
  std::vector<PixelCovariance> covariance;  // row by row
  std::vector<double> radius_px;            // that holds the pixel with 95 %
  double within_px = 0;                     // largest radius over 95 % of the image
  double mean_variance = 0;                 // px^2, of both coordinates together
};
ProjectionMap projection_map(const ProjectionLaw& law, const CameraResult& camera, double distance_m,
                             int longer_side = 160);

// Channels sigma_u, sigma_v, radius_95, all px; one value a cell.
io::Image values_of(const ProjectionMap& map);
// The radii in colours, darkest at `lower_px` and brightest at `upper_px`, evenly in their logarithm; sRGB codes.
io::Image picture_of(const ProjectionMap& map, double lower_px, double upper_px);
// Smallest and largest radius on all maps, at least a factor of two apart.
std::pair<double, double> radius_range(const std::vector<ProjectionMap>& maps);

}  // namespace gonio::camera
