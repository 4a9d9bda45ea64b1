// Geometry and signals of the contrast experiment (experiment.h).
//
// Lamp and lens with an extent: means over points that fill a disc of directions evenly (Vogel's spiral: radius
// sqrt((i + 1/2) / n), turned by the golden angle), n for each; the two discs are paired point by point, the second
// in another order, so that the cost is one sum.
#include "contrast/predict/experiment.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::contrast {
namespace {

constexpr int disc_points = 61;

// Point i of a disc of directions about w.
Vec3 spread(Vec3 w, double half_angle_rad, int i) {
  if (half_angle_rad == 0) return w;
  const Vec3 a = normalized(std::abs(w.y) < 0.9 ? cross(w, {0, 1, 0}) : cross(w, {1, 0, 0})), b = cross(w, a);
  const double r = std::sin(half_angle_rad) * std::sqrt((i + 0.5) / disc_points), phi = i * pi * (3 - std::sqrt(5.0));
  return normalized(w * std::sqrt(1 - r * r) + a * (r * std::cos(phi)) + b * (r * std::sin(phi)));
}

Vec3 turned(Vec3 w, double angle_rad) {  // about z
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

[[noreturn]] void refuse(const std::string& place, const std::string& what, const std::string& remedy) {
  throw Error(Exit::usage, place, what, remedy);
}

}  // namespace

View view_of(const Experiment& e, double tilt_rad, double rotation_rad) {
  const auto in_plane = [](double angle) { return Vec3{std::sin(angle), 0, std::cos(angle)}; };
  const Vec3 wo = in_plane(tilt_rad);
  if (e.plane == LightPlane::along) {
    const double back = pi / 2 - rotation_rad;
    return {turned(wo, back), turned(in_plane(tilt_rad + e.light_rad), back)};
  }
  const Vec3 wi = wo * std::cos(e.light_rad) + Vec3{0, std::sin(e.light_rad), 0};
  return {turned(wo, -rotation_rad), turned(wi, -rotation_rad)};
}

double signal(const Experiment& e, const Reflectance& f, double tilt_rad, double rotation_rad) {
  const View view = view_of(e, tilt_rad, rotation_rad);
  const auto sent = [&](Vec3 wo, Vec3 wi) { return wo.z > 0 && wi.z > 0 ? (f(wo, wi) + e.veil / pi) * wi.z : 0; };
  if (e.light_spread_rad == 0 && e.camera_spread_rad == 0) return sent(view.wo, view.wi);
  double sum = 0;
  const int count = e.light_spread_rad > 0 && e.camera_spread_rad > 0 ? 4 * disc_points : disc_points;
  for (int i = 0; i < count; ++i) {
    const int lens = i % disc_points, lamp = (i * 23 + i / disc_points * 7) % disc_points;
    sum += sent(spread(view.wo, e.camera_spread_rad, lens), spread(view.wi, e.light_spread_rad, lamp));
  }
  return sum / count;
}

double difference_of(double a, double b) {
  return std::abs(a - b);
}

double michelson_of(double a, double b) {
  return a + b > 0 ? std::abs(a - b) / (a + b) : 0;
}

double contrast_of(Definition definition, double a, double b) {
  return definition == Definition::difference ? difference_of(a, b) : michelson_of(a, b);
}

std::string degrees_text(double rad) {
  const double d = std::round(rad / degree * 1e6) / 1e6;
  return shortest_text(d == 0 ? 0 : d);
}

std::string pair_name(const std::pair<double, double>& pair_rad) {
  return degrees_text(pair_rad.first) + "-" + degrees_text(pair_rad.second);
}

void check(const Experiment& e) {
  if (e.tilts_rad.empty()) refuse("--tilts", "names no tilt", "give one or more: --tilts=-20deg,0deg,20deg");
  if (e.pairs_rad.empty()) refuse("--pairs", "names no pair of rotations", "give one or more: --pairs 0deg:90deg");
  for (const auto& pair : e.pairs_rad)
    if (std::abs(std::remainder(pair.first - pair.second, 2 * pi)) < 1e-9)
      refuse("--pairs", "compares " + degrees_text(pair.first) + " degrees with itself",
             "give two different rotations: --pairs 0deg:90deg");
  for (const double tilt : e.tilts_rad) {
    const View view = view_of(e, tilt, 0);
    const auto below = [](Vec3 w, double spread_rad) { return std::asin(std::min(1.0, w.z)) <= spread_rad; };
    if (below(view.wo, e.camera_spread_rad) || std::abs(tilt) >= pi / 2)
      refuse("--tilts", "puts the camera below the horizon at " + degrees_text(tilt) + " degrees",
             "keep tilt and --camera-spread together below 90 degrees");
    if (below(view.wi, e.light_spread_rad))
      refuse("--light", "puts the lamp below the horizon at a tilt of " + degrees_text(tilt) + " degrees",
             "lower --light, --light-spread or the tilt");
  }
}

}  // namespace gonio::contrast
