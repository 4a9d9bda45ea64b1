// Voxels round a normal, by their distance from the surface: pool_voxels of edge_profiles.h.
//
// With u, v along the tangents and z along the normal, the distance from a surface that bends is, to second order,
//   s = z + (kuu u^2 + 2 kuv u v + kvv v^2) / 2
#include <cmath>

#include "volume/edge_profiles.h"

namespace gonio::volume {
namespace {

constexpr std::size_t most_bins = 64;  // what fit_edge takes
constexpr double slight = 0.02;        // correlation that is left out

struct PooledVoxel {
  std::array<std::ptrdiff_t, 3> index{};
  std::size_t bin = 0;
};

// Of noise whose correlation k voxels apart along each axis is `axis.of(k)`.
void covariance_of_bins(const std::vector<PooledVoxel>& voxels, const std::vector<double>& count, double q,
                        std::vector<double>& into) {
  const std::size_t n = count.size();
  into.assign(n * n, 0);
  for (const PooledVoxel& v : voxels) into[v.bin * n + v.bin] += 1;
  if (std::abs(q) > slight) {
    const AxisCovariance axis(q);
    const std::ptrdiff_t reach = q < 0.3 ? 1 : 3;
    std::array<double, 4> of{};
    for (std::size_t k = 0; k < of.size(); ++k) of[k] = axis.of(static_cast<std::ptrdiff_t>(k));
    for (std::size_t a = 0; a < voxels.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        double c = 1;
        for (std::size_t d = 0; d < 3 && c != 0; ++d) {
          const std::ptrdiff_t apart = std::abs(voxels[a].index[d] - voxels[b].index[d]);
          c = apart > reach ? 0 : c * of[static_cast<std::size_t>(apart)];
        }
        into[voxels[a].bin * n + voxels[b].bin] += c;
        into[voxels[b].bin * n + voxels[a].bin] += c;
      }
  }
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) into[a * n + b] /= count[a] * count[b];
}

}  // namespace

void pool_voxels(const Block& block, const LocalShape& shape, double first, double last, Vec3 scale,
                 double noise_correlation, EdgeProfile& into) {
  const Basis basis(shape.normal);
  const Vec3 centre = into.place.index;
  const double far = std::min(0.5 * (last - first), 0.5 * pool_step * most_bins);
  const double middle = 0.5 * (first + last);
  std::array<std::ptrdiff_t, 3> low{}, high{};
  for (int a = 0; a < 3; ++a) {
    const double n = shape.normal[a], side = pool_radius * std::sqrt(std::max(0.0, 1 - n * n)),
                 along = (far + 1) * std::abs(n) + side;
    const double mid = centre[a] + middle * n / scale[a], reach = along / scale[a];
    low[static_cast<std::size_t>(a)] = static_cast<std::ptrdiff_t>(std::ceil(std::max(block.low[a], mid - reach)));
    high[static_cast<std::size_t>(a)] = static_cast<std::ptrdiff_t>(std::floor(std::min(block.high[a], mid + reach)));
  }
  struct Bin {
    double count = 0, s = 0, v = 0;
  };
  std::array<Bin, most_bins> bins{};
  std::vector<PooledVoxel> voxels;
  for (std::ptrdiff_t k = low[2]; k <= high[2]; ++k)
    for (std::ptrdiff_t j = low[1]; j <= high[1]; ++j)
      for (std::ptrdiff_t i = low[0]; i <= high[0]; ++i) {
        const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        const Vec3 d = basis.to_local((index - centre) * scale);
        if (d.x * d.x + d.y * d.y > pool_radius * pool_radius) continue;
        const double s = d.z + 0.5 * (shape.kuu * d.x * d.x + 2 * shape.kuv * d.x * d.y + shape.kvv * d.y * d.y);
        const double at = (s - middle + far) / pool_step;
        if (!(at >= 0 && at < static_cast<double>(most_bins) && s <= middle + far)) continue;
        const double value = block.at(index);
        if (!std::isfinite(value)) continue;
        const auto bin = static_cast<std::size_t>(at);
        bins[bin].count += 1, bins[bin].s += s, bins[bin].v += value;
        voxels.push_back({{i, j, k}, bin});
      }
  std::array<std::size_t, most_bins> place{};
  for (std::size_t b = 0; b < most_bins; ++b) {
    if (bins[b].count == 0) continue;
    place[b] = into.s.size();
    into.s.push_back(bins[b].s / bins[b].count);
    into.values.push_back(bins[b].v / bins[b].count);
    into.voxels.push_back(bins[b].count);
  }
  for (PooledVoxel& v : voxels) v.bin = place[v.bin];
  covariance_of_bins(voxels, into.voxels, noise_correlation, into.covariance);
}

}  // namespace gonio::volume
