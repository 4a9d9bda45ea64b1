// Glass between marker and camera shifts an outline by a few of its widths and changes its size a little.
#include "reassembly/bundle_fate.h"

#include <algorithm>
#include <cmath>

#include "linear/geom_matrices.h"

namespace gonio::reassembly {
namespace {

constexpr double shift_widths = 8;    // half angles by which glass shifts an outline, at most
constexpr double size_factor = 1.7;   // by which it grows or shrinks
constexpr double blind_shift = 0.02;  // rad, where the outline's size is not known

double reach_of(const Sight& s) {
  return s.sized ? shift_widths * s.half_angle : blind_shift;
}

// Two rays that miss each other by what glass does, and not by more.
bool nearly_meet(const Sight& a, const Sight& b) {
  const Eigen::Vector3d base = b.origin - a.origin, n = linear::cross_matrix(base) * a.axis;
  const double length = n.norm();
  if (!(length > 0)) return false;
  if (a.sized && b.sized && std::abs(std::log(a.half_angle / b.half_angle)) > std::log(size_factor)) return false;
  return std::abs(n.dot(b.axis)) / length < (reach_of(a) + reach_of(b)) / 4;
}

}  // namespace

bool displaced(const Sight& s, const Eigen::Vector3d& centre, std::optional<double> radius) {
  const Eigen::Vector3d p = centre - s.origin;
  const double d = p.norm(), angle = std::acos(std::clamp(p.dot(s.axis) / d, -1.0, 1.0));
  if (angle > reach_of(s)) return false;
  if (!s.sized || !radius || !(*radius < d)) return true;
  return std::abs(std::log(std::asin(*radius / d) / s.half_angle)) < std::log(size_factor);
}

std::vector<std::vector<Fate>> fates(const std::vector<std::vector<Sight>>& sights, const std::vector<Bundle>& found) {
  std::vector<std::vector<Fate>> fate;
  for (const auto& of_view : sights) fate.emplace_back(of_view.size(), Fate::alone);
  std::vector<std::vector<bool>> shows(found.size(), std::vector<bool>(sights.size()));
  for (std::size_t k = 0; k < found.size(); ++k)
    for (const Sighting& s : found[k].sightings) {
      fate[s.view][s.outline] = Fate::bundled;
      shows[k][s.view] = true;
    }
  const auto is_refracted = [&](std::size_t v, std::size_t i) {
    for (std::size_t k = 0; k < found.size(); ++k)
      if (!shows[k][v] && found[k].sightings.size() > 2 &&
          displaced(sights[v][i], linear::as_eigen(found[k].centre_m), found[k].radius_m))
        return true;
    std::size_t near = 0;
    for (std::size_t w = 0; w < sights.size(); ++w)
      if (w != v)
        near += std::ranges::any_of(sights[w], [&](const Sight& other) {
          const auto j = static_cast<std::size_t>(&other - sights[w].data());
          return fate[w][j] != Fate::bundled && nearly_meet(sights[v][i], other);
        });
    return near >= 2;
  };
  for (std::size_t v = 0; v < sights.size(); ++v)
    for (std::size_t i = 0; i < sights[v].size(); ++i)
      if (fate[v][i] == Fate::alone && is_refracted(v, i)) fate[v][i] = Fate::refracted;
  return fate;
}

}  // namespace gonio::reassembly
