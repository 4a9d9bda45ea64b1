// Rings: the fine structure in the radius that the sectors away from a place show. See sites.h.
//
// Every slice is cut into eight sectors. In each and for every voxel of radius: the mean of the grey values that are
// wholly material or wholly air, less that of a window of eleven voxels of radius. A place gets the mean over the
// sectors but its own and the two beside it, so that what it is held against has no part in it.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "explain/volumes/sites.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t sectors = 8;
constexpr int half_window = 5;

struct RingSums {
  std::vector<double> sum, count;  // sector, radius
};

std::size_t sector_of(double x, double y) {
  const double turn = (std::atan2(y, x) / (2 * pi) + 0.5) * sectors;
  return std::min(static_cast<std::size_t>(turn), sectors - 1);
}

RingSums summed(const Sampled& sampled, const Body& body, const Values& values, std::size_t k, std::size_t radii) {
  const auto& n = sampled.volume().head.size;
  RingSums sums{std::vector<double>(sectors * radii, 0.0), std::vector<double>(sectors * radii, 0.0)};
  const double rise = values.material - values.air, near = 2 * sampled.voxel_m();
  for (std::size_t j = 0; j < n[1]; ++j)
    for (std::size_t i = 0; i < n[0]; ++i) {
      const Vec3 p = sampled.place_of({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
      const auto r = static_cast<std::size_t>(std::hypot(p.x, p.y) / sampled.voxel_m() + 0.5);
      if (r >= radii) continue;
      const double share = body.at(p);
      if (share > 0.001 && share < 0.999) continue;
      bool plain = true;
      for (const Vec3 way : {Vec3{near, 0, 0}, Vec3{-near, 0, 0}, Vec3{0, near, 0}, Vec3{0, -near, 0}})
        plain = plain && std::abs(body.at(p + way) - share) < 0.001;
      if (!plain) continue;
      const double v = (static_cast<double>(sampled.volume().at(i, j, k)) - values.air) / rise;
      const std::size_t bin = sector_of(p.x, p.y) * radii + r;
      sums.sum[bin] += v - (share > 0.5 ? 1 : 0);
      sums.count[bin] += 1;
    }
  return sums;
}

// Of the sectors away from `own`: their mean in each radius less that of the window.
std::vector<double> profile(const RingSums& sums, std::size_t own, std::size_t radii) {
  std::vector<double> sum(radii, 0.0), count(radii, 0.0), result(radii, 0.0);
  // Each sector by itself: material here and air there differ by more than rings do.
  for (std::size_t s = 0; s < sectors; ++s) {
    const std::size_t away = (s + sectors - own) % sectors;
    if (away <= 1 || away == sectors - 1) continue;
    for (std::size_t r = 0; r < radii; ++r) {
      const double own_count = sums.count[s * radii + r];
      if (!(own_count > 0)) continue;
      double around = 0, weight = 0;
      for (int w = -half_window; w <= half_window; ++w) {
        const auto at = static_cast<std::ptrdiff_t>(r) + w;
        if (at < 0 || at >= static_cast<std::ptrdiff_t>(radii)) continue;
        const std::size_t bin = s * radii + static_cast<std::size_t>(at);
        if (sums.count[bin] > 0) around += sums.sum[bin] / sums.count[bin], weight += 1;
      }
      if (weight < half_window) continue;
      sum[r] += sums.sum[s * radii + r] - own_count * around / weight;
      count[r] += own_count;
    }
  }
  for (std::size_t r = 0; r < radii; ++r)
    if (count[r] > 3) result[r] = sum[r] / count[r];
  return result;
}

}  // namespace

double add_rings(const Sampled& sampled, const Body& body, const Values& values, std::vector<Row>& rows) {
  const std::size_t slices = sampled.volume().head.size[2],
                    radii = static_cast<std::size_t>(sampled.field_m() / sampled.voxel_m()) + 2;
  std::vector<std::array<std::vector<double>, sectors>> rings(slices);
  parallel_for(0, slices, [&](std::size_t k) {
    const RingSums sums = summed(sampled, body, values, k, radii);
    for (std::size_t s = 0; s < sectors; ++s) rings[k][s] = profile(sums, s, radii);
  });
  double squares = 0, count = 0;
  for (Row& row : rows) {
    if (!is_grey(row.reading)) continue;
    const Vec3 index = sampled.index_of(row.at_m);
    const double radius = std::hypot(row.at_m.x, row.at_m.y) / sampled.voxel_m();
    const std::size_t s = sector_of(row.at_m.x, row.at_m.y), r = static_cast<std::size_t>(radius);
    const double f = radius - std::floor(radius), z = index.z;
    const auto k = static_cast<std::size_t>(std::clamp(z, 0.0, static_cast<double>(slices) - 1));
    const double g = z - static_cast<double>(k);
    for (std::size_t up = 0; up < 2; ++up) {
      if (k + up >= slices || r + 1 >= radii) continue;
      const std::vector<double>& c = rings[k + up][s];
      row.ring += (up == 0 ? 1 - g : g) * ((1 - f) * c[r] + f * c[r + 1]);
    }
    squares += row.ring * row.ring, count += 1;
  }
  const double rms = count > 0 ? std::sqrt(squares / count) : 0;
  if (rms > 0)
    for (Row& row : rows) row.ring /= rms;
  return rms;
}

}  // namespace gonio::explain::volumes
