// See hull.h.
#include "glass/refine/hull.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geom/mat3_inverse.h"

namespace gonio::glass {
namespace {

struct Box {
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
};

// A cube that holds the object: round the point nearest to the rays through the outlines' middles.
Box cube_round(std::span<const View> views) {
  Mat3 normal{{0, 0, 0, 0, 0, 0, 0, 0, 0}};
  Vec3 right;
  std::vector<Vec3> axes;
  std::vector<double> reach;
  for (const View& view : views) {
    Vec2 middle;
    double count = 0;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        if (view.outline_px[view.pixel(x, y)] > 0) middle = middle + Vec2{1.0 * x, 1.0 * y}, ++count;
    middle = middle * (1 / count);
    double farthest = 0;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        if (view.outline_px[view.pixel(x, y)] > 0)
          farthest = std::max(farthest, std::hypot(x - middle.x, y - middle.y));
    const Vec3 d = view.direction(middle.x, middle.y), eye = view.eye_m();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) normal(i, j) += (i == j ? 1 : 0) - d[i] * d[j];
    right += eye - d * dot(d, eye);
    axes.push_back(d), reach.push_back((farthest + 1) / view.focal_px);
  }
  const Vec3 centre = inverse(normal) * right;
  double half = 0;
  for (std::size_t v = 0; v < views.size(); ++v)
    half = std::max(half, 1.1 * reach[v] * norm(centre - views[v].eye_m()));
  Box box;
  box.add(centre - Vec3{half, half, half}), box.add(centre + Vec3{half, half, half});
  return box;
}

}  // namespace

double hull_at(std::span<const View> views, const HullWish& wish, Vec3 point_m) {
  double least = wish.floor_m ? point_m.z - *wish.floor_m : 1e9;
  for (const View& view : views) {
    const auto place = view.project(point_m);
    if (!place) continue;
    const double depth = dot(view.world_from_camera_axes * Vec3{0, 0, 1}, point_m - view.eye_m());
    least = std::min(least, view.outline_at(*place) * depth / view.focal_px);
  }
  return least;
}

SplineField hull_of(std::span<const View> views, const HullWish& wish) {
  const Box cube = cube_round(views);
  Box body;
  constexpr int coarse = 48;
  const double step = (cube.high.x - cube.low.x) / coarse;
  for (int k = 0; k <= coarse; ++k)
    for (int j = 0; j <= coarse; ++j)
      for (int i = 0; i <= coarse; ++i) {
        const Vec3 p = cube.low + Vec3{i * step, j * step, k * step};
        if (hull_at(views, wish, p) > 0) body.add(p);
      }
  if (!(body.high.x >= body.low.x))
    throw Error(Exit::data, "masks", "have nothing in common",
                "check the cameras' poses, and that one object is meant");
  const double cell = (max_component(body.high - body.low) + 2 * step) / wish.cells;
  const double margin = step + 4 * cell;
  const Vec3 low = body.low - Vec3{margin, margin, margin}, extent = body.high - low + Vec3{margin, margin, margin};
  const auto nodes = [&](double length) { return static_cast<int>(std::ceil(length / cell)) + 1; };
  SplineField field(low, cell, {nodes(extent.x), nodes(extent.y), nodes(extent.z)});
  // Far away distances level off: what is there has nothing to say.
  field.fill([&](Vec3 p) { return 6 * std::tanh(hull_at(views, wish, p) / cell / 6); });
  return field;
}

}  // namespace gonio::glass
