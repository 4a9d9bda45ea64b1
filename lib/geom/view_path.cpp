#include "geom/view_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace gonio {
namespace {

constexpr double height_rad = 20 * pi / 180;

Vec3 on_circle(double azimuth_rad) {
  return {std::cos(azimuth_rad) * std::cos(height_rad), std::sin(azimuth_rad) * std::cos(height_rad),
          std::sin(height_rad)};
}

Vec3 zigzag(double s) {
  constexpr int strokes = 6;
  const double stroke = std::min(s * strokes, strokes - 1e-12);
  const double part = stroke - std::floor(stroke);
  const auto corner = [](int k) {
    constexpr std::array<double, 3> depth{1.2, 0.8, 1.0};
    const double side = k % 2 == 0 ? -0.6 : 0.6;
    const double reach = depth[static_cast<std::size_t>(k % 3)];
    return Vec3{side, -reach * std::cos(height_rad), reach * std::sin(height_rad)};
  };
  const int k = static_cast<int>(stroke);
  return (1 - part) * corner(k) + part * corner(k + 1);
}

}  // namespace

std::span<const std::string> view_path_names() {
  static const std::array<std::string, 6> names{"circle", "half-circle", "line", "flyby", "zigzag", "tricky"};
  return names;
}

Vec3 view_path(const std::string& name, double s) {
  if (name == "circle") return on_circle(2 * pi * s - pi / 2);
  if (name == "half-circle") return on_circle(pi * s - pi);
  if (name == "line") return {2 * s - 1, -std::cos(height_rad), std::sin(height_rad)};
  if (name == "flyby") return {0.35, 2 * s - 1, 0.9};
  if (name == "zigzag") return zigzag(s);
  if (name != "tricky")
    throw Error(Exit::usage, "--path", "no camera path \"" + name + "\"",
                "one of circle, half-circle, line, flyby, zigzag, tricky");
  const double reach = 1.025 + 0.275 * std::cos(2 * pi * s);
  return reach * on_circle(-pi / 2) + Vec3{0.12 * std::sin(4 * pi * s), 0, 0.08 * std::sin(6 * pi * s)};
}

}  // namespace gonio
