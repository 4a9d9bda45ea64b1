// See mesh_view.h.
#include "report/mesh_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "io/image.h"
#include "io/raster.h"
#include "report/colour_map.h"
#include "report/moving_view.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::report {
namespace {

using Point = std::array<double, 3>;
constexpr int still_width = 560, still_height = 420;
constexpr double fills = 0.92;  // of the picture's shorter side

struct Cube {
  Point low{}, middle{};
  double side = 1, radius = 1;
};
// Everything that the first picture holds.
std::vector<Point> points_of(const MeshView& view) {
  std::vector<Point> points;
  for (const ViewedMesh& mesh : view.meshes)
    for (const auto& p : mesh.positions) points.push_back({p[0], p[1], p[2]});
  for (const Vec3 p : points_in_view(view.moving)) points.push_back({p.x, p.y, p.z});
  return points;
}

Cube cube_of(const MeshView& view) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Point low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  const std::vector<Point> points = points_of(view);
  for (const Point& p : points)
    for (std::size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
  Cube cube;
  if (points.empty()) return cube;
  cube.side = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    cube.middle[i] = 0.5 * (low[i] + high[i]);
    cube.side = std::max(cube.side, high[i] - low[i]);
  }
  if (!(cube.side > 0)) cube.side = 1;
  for (std::size_t i = 0; i < 3; ++i) cube.low[i] = cube.middle[i] - 0.5 * cube.side;
  cube.radius = 0;
  for (const Point& p : points)
    cube.radius =
        std::max(cube.radius, std::hypot(p[0] - cube.middle[0], p[1] - cube.middle[1], p[2] - cube.middle[2]));
  if (!(cube.radius > 0)) cube.radius = 1;
  return cube;
}

Point turned_by(const std::array<double, 9>& m, const Point& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
          m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

double share_of(const MeshView& view, float value) {
  return view.high > view.low ? (value - view.low) / (view.high - view.low) : 0;
}
Colour colour_of(const MeshView& view, const ViewedMesh& mesh, std::size_t vertex) {
  if (mesh.value.empty()) return {0.72f, 0.74f, 0.76f};
  const double t = share_of(view, mesh.value[vertex]);
  return view.low < 0 ? signed_colour(2 * t - 1) : magnitude_colour(t);
}

// Shade of a face by its turned normal: two-sided, light from the upper left before it.
float shade_of(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  if (!(length > 0)) return 0;
  return static_cast<float>(0.25 + 0.75 * std::abs((-0.4 * n[0] + 0.45 * n[1] + 0.8 * n[2]) / length));
}

struct Screen {
  int width, height;
  std::vector<float> depth;
  io::Image image;
  Screen(int w, int h)
      : width(w),
        height(h),
        depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), -1e30f),
        image(w, h, {"R", "G", "B"}) {
    std::ranges::fill(image.data, 0.94f);
  }
};

void fill(Screen& screen, const std::array<Point, 3>& p, const std::array<float, 3>& colour) {
  const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
  if (!(std::abs(area) > 0)) return;
  const auto [x0, x1] = std::minmax({p[0][0], p[1][0], p[2][0]});
  const auto [y0, y1] = std::minmax({p[0][1], p[1][1], p[2][1]});
  const int left = std::max(0, static_cast<int>(std::ceil(x0))),
            right = std::min(screen.width - 1, static_cast<int>(x1));
  const int top = std::max(0, static_cast<int>(std::ceil(y0))),
            bottom = std::min(screen.height - 1, static_cast<int>(y1));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const double b = ((x - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (y - p[0][1])) / area;
      const double c = ((p[1][0] - p[0][0]) * (y - p[0][1]) - (x - p[0][0]) * (p[1][1] - p[0][1])) / area;
      if (b < 0 || c < 0 || b + c > 1) continue;
      const float z = static_cast<float>(p[0][2] + b * (p[1][2] - p[0][2]) + c * (p[2][2] - p[0][2]));
      float& nearest = screen.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(screen.width) +
                                    static_cast<std::size_t>(x)];
      if (z <= nearest) continue;
      nearest = z;
      for (int k = 0; k < 3; ++k) screen.image.at(x, y, k) = colour[static_cast<std::size_t>(k)];
    }
}

// 16 bits a coordinate, then 8 bits a value, then 32 bits an index, as base64.
std::string data_of(const MeshView& view, const ViewedMesh& mesh, const Cube& cube) {
  std::string positions, values, indices;
  for (const auto& p : mesh.positions)
    for (std::size_t i = 0; i < 3; ++i)
      append_bytes(
          positions,
          static_cast<std::uint32_t>(std::lround(std::clamp((p[i] - cube.low[i]) / cube.side, 0.0, 1.0) * 65535)), 2);
  for (const float v : mesh.value)
    append_bytes(values, static_cast<std::uint32_t>(std::lround(std::clamp(share_of(view, v), 0.0, 1.0) * 255)), 1);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t) append_bytes(indices, i, 4);
  return "<script type=\"text/plain\" data-name=\"" + escape(mesh.name) + "\" data-values=\"" + base64(values) +
         "\" data-indices=\"" + base64(indices) + "\">" + base64(positions) + "</script>";
}

std::string scale_of(const MeshView& view) {
  if (!(view.high > view.low)) return {};
  std::string ramp;
  for (int k = 0; k <= 10; ++k)
    ramp += (k > 0 ? "," : "") + hex(view.low < 0 ? signed_colour(k / 5.0 - 1) : magnitude_colour(k / 10.0));
  return "<div class=\"scale\">" + escape(view.label) + (view.unit.empty() ? "" : " / " + escape(view.unit)) +
         "<div class=\"ramp\" style=\"background:linear-gradient(to right," + ramp +
         ")\"></div><div class=\"ticks\"><span>" + number_text(view.low, 2) + "</span><span>" +
         number_text(0.5 * (view.low + view.high), 2) + "</span><span>" + number_text(view.high, 2) +
         "</span></div></div>";
}

}  // namespace

std::string still_png(const MeshView& view, std::size_t which, int width, int height) {
  const Cube cube = cube_of(view);
  Screen screen(width, height);
  const double scale = 0.5 * fills * std::min(width, height) / cube.radius;
  const auto draw = [&](const std::array<Point, 3>& corners, std::array<float, 3> colour) {
    std::array<Point, 3> at, seen;
    for (std::size_t c = 0; c < 3; ++c) {
      const Point& p = corners[c];
      at[c] = turned_by(view.turn, {p[0] - cube.middle[0], p[1] - cube.middle[1], p[2] - cube.middle[2]});
      seen[c] = {0.5 * width + scale * at[c][0], 0.5 * height - scale * at[c][1], at[c][2]};
    }
    const float shade = shade_of(at[0], at[1], at[2]);
    for (float& k : colour) k *= shade;
    fill(screen, seen, colour);
  };
  if (which < view.meshes.size()) {
    const ViewedMesh& mesh = view.meshes[which];
    for (const auto& t : mesh.triangles) {
      std::array<Point, 3> corners;
      std::array<float, 3> colour{};
      for (std::size_t c = 0; c < 3; ++c) {
        const auto& p = mesh.positions[t[c]];
        corners[c] = {p[0], p[1], p[2]};
        const Colour own = colour_of(view, mesh, t[c]);
        for (std::size_t k = 0; k < 3; ++k) colour[k] += own[k] / 3;
      }
      draw(corners, colour);
    }
  }
  each_triangle(view.moving, view.start_s, [&](const std::array<Vec3, 3>& corners, const std::array<float, 3>& colour) {
    std::array<Point, 3> points;
    for (std::size_t c = 0; c < 3; ++c) points[c] = {corners[c].x, corners[c].y, corners[c].z};
    draw(points, colour);
  });
  return io::encode_raster_png(screen.image);
}

std::string html(const MeshView& view) {
  const Cube cube = cube_of(view);
  std::string turn, ramp, data;
  for (const double t : view.turn) turn += format(turn.empty() ? "%.6f" : " %.6f", t);
  for (int k = 0; k <= 10; ++k)
    ramp += (k > 0 ? "," : "") + hex(view.low < 0 ? signed_colour(k / 5.0 - 1) : magnitude_colour(k / 10.0));
  for (const ViewedMesh& mesh : view.meshes) data += data_of(view, mesh, cube);
  const bool moves = !view.moving.nodes.empty();
  if (moves) data += data_of(view.moving);
  const Point& m = cube.middle;
  return "<div class=\"solid\" data-name=\"" + escape(view.name) + "\" data-turn=\"" + turn + "\" data-colours=\"" +
         ramp +
         format("\" data-side=\"%.9g\" data-radius=\"%.9g\" data-middle=\"%.9g %.9g %.9g\" data-start=\"%.9g\">",
                moves ? 1.0 : cube.side, cube.radius, moves ? m[0] : (m[0] - cube.low[0]) / cube.side,
                moves ? m[1] : (m[1] - cube.low[1]) / cube.side, moves ? m[2] : (m[2] - cube.low[2]) / cube.side,
                view.start_s) +
         "<img alt=\"" + escape(view.name) +
         format("\" width=\"%d\" height=\"%d\" src=\"data:image/png;base64,", still_width, still_height) +
         base64(still_png(view, 0, still_width, still_height)) + "\">" + data + legend_of(view) + scale_of(view) +
         "</div>";
}

}  // namespace gonio::report
