// See coverage.h. Hull: Andrew's monotone chain (1979).
#include "camera/quality/coverage.h"

#include <algorithm>

#include "report/colour_map.h"

namespace gonio::camera {
namespace {

constexpr int grid_side = 64;

double turn(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

std::vector<Vec2> hull(std::vector<Vec2> points) {
  std::ranges::sort(points, [](Vec2 a, Vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Vec2> result;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = result.size();
    for (const Vec2 p : points) {
      while (result.size() >= start + 2 && turn(result[result.size() - 2], result.back(), p) <= 0) result.pop_back();
      result.push_back(p);
    }
    if (!result.empty()) result.pop_back();
    std::ranges::reverse(points);
  }
  return result;
}

bool inside(const std::vector<Vec2>& outline, Vec2 p) {
  if (outline.size() < 3) return false;
  for (std::size_t k = 0; k < outline.size(); ++k)
    if (turn(outline[k], outline[(k + 1) % outline.size()], p) < 0) return false;
  return true;
}

}  // namespace

Coverage coverage_of(const CameraResult& camera) {
  Coverage coverage;
  coverage.grid = image_grid(camera.width_px(), camera.height_px(), grid_side);
  coverage.views.resize(static_cast<std::size_t>(coverage.grid.columns * coverage.grid.rows));
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    if (!camera.uses(v)) continue;
    std::vector<Vec2> pixels;
    for (const Corner& corner : camera.views[v].corners) pixels.push_back(corner.pixel);
    const std::vector<Vec2> outline = hull(std::move(pixels));
    for (int j = 0; j < coverage.grid.rows; ++j)
      for (int i = 0; i < coverage.grid.columns; ++i)
        coverage.views[static_cast<std::size_t>(j * coverage.grid.columns + i)] +=
            inside(outline, coverage.grid.pixel(i, j));
  }
  const auto reached = std::ranges::count_if(coverage.views, [](int n) { return n > 0; });
  coverage.share = static_cast<double>(reached) / static_cast<double>(coverage.views.size());
  return coverage;
}

io::Image picture_of(const Coverage& coverage) {
  io::Image image(coverage.grid.columns, coverage.grid.rows, {"R", "G", "B"});
  const double most = std::max(1, *std::ranges::max_element(coverage.views));
  for (std::size_t k = 0; k < coverage.views.size(); ++k) {
    const int views = coverage.views[k];
    const report::Colour colour =
        views == 0 ? report::Colour{1, 1, 1} : report::magnitude_colour(1 - 0.85 * views / most);
    std::copy(colour.begin(), colour.end(), image.data.begin() + static_cast<std::ptrdiff_t>(3 * k));
  }
  return image;
}

}  // namespace gonio::camera
