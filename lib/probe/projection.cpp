// See projection.h. Directions are (forward, left, up).
#include "probe/projection.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace gonio::probe {
namespace {

struct Face {
  Vec3 middle, right, down;
  int column, row;  // in the cross; the strip goes by the order here
};
constexpr std::array<Face, 6> faces{{{{0, -1, 0}, {-1, 0, 0}, {0, 0, -1}, 2, 1},   // right
                                     {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}, 0, 1},     // left
                                     {{0, 0, 1}, {0, -1, 0}, {1, 0, 0}, 1, 0},     // up
                                     {{0, 0, -1}, {0, -1, 0}, {-1, 0, 0}, 1, 2},   // down
                                     {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, 1, 1},    // front
                                     {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 3, 1}}};  // back

struct Aspect {
  int width, height;
};
constexpr std::array<Aspect, 5> aspects{{{2, 1}, {1, 1}, {1, 1}, {4, 3}, {6, 1}}};
Aspect aspect_of(Projection p) {
  return aspects[static_cast<std::size_t>(p)];
}

bool on_disc(Projection p) {
  return p == Projection::angular || p == Projection::mirror_ball;
}

std::optional<Direction> on_cube(const SphereMap& m, Vec2 at) {
  const double side = static_cast<double>(m.height) / aspect_of(m.projection).height;
  const int column = static_cast<int>(std::floor(at.x / side)), row = static_cast<int>(std::floor(at.y / side));
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Face& f = faces[k];
    const bool strip = m.projection == Projection::cube_strip;
    if (column != (strip ? static_cast<int>(k) : f.column) || row != (strip ? 0 : f.row)) continue;
    const double x = 2 * (at.x / side - column) - 1, y = 2 * (at.y / side - row) - 1, d2 = 1 + x * x + y * y;
    return Direction{(f.middle + f.right * x + f.down * y) / std::sqrt(d2), 4 / (side * side * d2 * std::sqrt(d2))};
  }
  return {};
}

// The disc's angle about the forward direction; +1 for angular maps, whose middle looks forward.
std::optional<Direction> on_the_disc(const SphereMap& m, Vec2 at) {
  const double half = m.height / 2.0, x = at.x / half - 1, y = 1 - at.y / half, r = std::hypot(x, y);
  if (r > 1) return {};
  const bool angular = m.projection == Projection::angular;
  const double gamma = angular ? pi * r : 2 * std::asin(r), sine = std::sin(gamma);
  const double density = angular ? (r > 1e-9 ? pi * sine / r : pi * pi) : 4;
  const Vec3 sideways = r > 0 ? Vec3{0, -x / r, y / r} : Vec3{};
  return Direction{sideways * sine + Vec3{angular ? std::cos(gamma) : -std::cos(gamma), 0, 0}, density / (half * half)};
}

Vec2 place_on_cube(const SphereMap& m, Vec3 d) {
  const double side = static_cast<double>(m.height) / aspect_of(m.projection).height;
  std::size_t best = 0;
  for (std::size_t k = 1; k < faces.size(); ++k)
    if (dot(d, faces[k].middle) > dot(d, faces[best].middle)) best = k;
  const Face& f = faces[best];
  const bool strip = m.projection == Projection::cube_strip;
  const double z = dot(d, f.middle), x = dot(d, f.right) / z, y = dot(d, f.down) / z;
  return {side * ((strip ? static_cast<double>(best) : f.column) + (x + 1) / 2),
          side * ((strip ? 0 : f.row) + (y + 1) / 2)};
}

}  // namespace

void check_shape(const SphereMap& m, const char* place) {
  const Aspect a = aspect_of(m.projection);
  if (m.width > 0 && m.height > 0 && m.width * a.height == m.height * a.width && m.height % a.height == 0) return;
  throw Error(Exit::data, place,
              "has " + std::to_string(m.width) + " x " + std::to_string(m.height) + " pixels, and a picture \"" +
                  std::string(projection_names[static_cast<std::size_t>(m.projection)]) + "\" is " +
                  std::to_string(a.width) + " x " + std::to_string(a.height) + " times a whole number",
              "crop it to that shape, or name its projection");
}

SphereMap sized(Projection p, int height) {
  const Aspect a = aspect_of(p);
  const int unit = (std::max(height, 1) + a.height - 1) / a.height;
  return {p, unit * a.width, unit * a.height};
}

std::optional<Direction> direction_at(const SphereMap& m, Vec2 at) {
  if (!(at.x >= 0 && at.y >= 0 && at.x <= m.width && at.y <= m.height)) return {};
  if (on_disc(m.projection)) return on_the_disc(m, at);
  if (m.projection != Projection::lat_long) return on_cube(m, at);
  const double phi = pi - 2 * pi * at.x / m.width, theta = pi * at.y / m.height, sine = std::sin(theta);
  return Direction{{sine * std::cos(phi), sine * std::sin(phi), std::cos(theta)},
                   2 * pi * pi * sine / (static_cast<double>(m.width) * m.height)};
}

Vec2 place_of(const SphereMap& m, Vec3 d) {
  if (m.projection == Projection::lat_long) {
    double turns = (pi - std::atan2(d.y, d.x)) / (2 * pi);
    turns -= std::floor(turns);
    return {turns * m.width, std::acos(std::clamp(d.z, -1.0, 1.0)) / pi * m.height};
  }
  if (!on_disc(m.projection)) return place_on_cube(m, d);
  const double half = m.height / 2.0, sine = std::hypot(d.y, d.z);
  const bool angular = m.projection == Projection::angular;
  const double gamma = std::atan2(sine, angular ? d.x : -d.x);
  const double r = angular ? gamma / pi : std::sin(gamma / 2);
  // All of the outline shows one direction; it is met at the right.
  const double x = sine > 0 ? -d.y / sine : 1, y = sine > 0 ? d.z / sine : 0;
  return {half * (1 + r * x), half * (1 - r * y)};
}

}  // namespace gonio::probe
