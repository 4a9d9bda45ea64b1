// Voxels round the candidates for markers, and the noise of those well within them.
#include <algorithm>
#include <cmath>

#include "stats/intervals.h"
#include "volume/contour_shape.h"
#include "volume/markers_parts.h"
#include "volume/slabs.h"

namespace gonio::volume::marker {

double room_round(double radius) {
  return 1.35 * std::abs(radius) + 6;
}

std::vector<Crop> crops(io::VolumeSource& source, const std::vector<Candidate>& of, Vec3 scale) {
  const auto& size = source.head().size;
  std::vector<Crop> result(of.size());
  for (std::size_t n = 0; n < of.size(); ++n) {
    const double room = room_round(of[n].radius);
    Block& b = result[n].block;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double last = static_cast<double>(size[a] - 1);
      const double low = std::clamp(std::floor((of[n].centre[axis] - room) / scale[axis]), 0.0, last);
      const double high = std::clamp(std::ceil((of[n].centre[axis] + room) / scale[axis]), 0.0, last);
      b.first[a] = static_cast<std::ptrdiff_t>(low);
      b.size[a] = static_cast<std::size_t>(high - low) + 1;
    }
    const auto end = [&](std::size_t a) {
      return static_cast<double>(b.first[a]) + static_cast<double>(b.size[a] - 1);
    };
    b.low = {static_cast<double>(b.first[0]), static_cast<double>(b.first[1]), static_cast<double>(b.first[2])};
    b.high = {end(0), end(1), end(2)};
    result[n].values.resize(b.size[0] * b.size[1] * b.size[2]);
    b.values = result[n].values.data();
  }
  for_each_slab(source, {16, 0, 0}, [&](const Slab& slab) {
    for (Crop& c : result)
      for (std::size_t k = slab.first; k < slab.first + slab.count; ++k) {
        const std::ptrdiff_t z = static_cast<std::ptrdiff_t>(k) - c.block.first[2];
        if (z < 0 || z >= static_cast<std::ptrdiff_t>(c.block.size[2])) continue;
        const float* slice = slab.slice(static_cast<std::ptrdiff_t>(k));
        for (std::size_t y = 0; y < c.block.size[1]; ++y)
          std::copy_n(
              slice + (static_cast<std::size_t>(c.block.first[1]) + y) * slab.width + c.block.first[0], c.block.size[0],
              c.values.begin() +
                  static_cast<std::ptrdiff_t>((static_cast<std::size_t>(z) * c.block.size[1] + y) * c.block.size[0]));
      }
  });
  return result;
}

namespace {

// Sums of (v - v')^2 / 2 over voxels `lag` apart, both within.
struct Differences {
  std::array<double, 4> squares{}, count{};
  void add(const Differences& o) {
    for (std::size_t lag = 0; lag < 4; ++lag) squares[lag] += o.squares[lag], count[lag] += o.count[lag];
  }
};
Differences differences_within(const Candidate& sphere, const Crop& crop, Vec3 scale) {
  Differences result;
  const Block& b = crop.block;
  const double depth = std::abs(sphere.radius) - 2.2;
  const std::array<std::size_t, 3> stride{1, b.size[0], b.size[0] * b.size[1]};
  std::vector<bool> within(crop.values.size());
  for (std::size_t v = 0; v < within.size(); ++v) {
    const Vec3 index{b.low.x + static_cast<double>(v % b.size[0]),
                     b.low.y + static_cast<double>(v / stride[1] % b.size[1]),
                     b.low.z + static_cast<double>(v / stride[2])};
    within[v] = norm(index * scale - sphere.centre) < depth;
  }
  for (const std::size_t lag : {1u, 3u})
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t v = 0; v < within.size(); ++v) {
        const std::size_t other = v + lag * stride[axis];
        if (!within[v] || v / stride[axis] % b.size[axis] + lag >= b.size[axis] || !within[other]) continue;
        const double d = static_cast<double>(crop.values[v]) - crop.values[other];
        result.squares[lag] += d * d / 2, result.count[lag] += 1;
      }
  return result;
}

// Round a sphere, from the median of differences: other bodies may be there.
Differences differences_without(const Candidate& sphere, const Crop& crop, Vec3 scale) {
  Differences result;
  const Block& b = crop.block;
  const double radius = std::abs(sphere.radius) + 3;
  const std::array<std::size_t, 3> stride{1, b.size[0], b.size[0] * b.size[1]};
  for (const std::size_t lag : {1u, 3u}) {
    std::vector<double> d;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t v = 0; v < crop.values.size(); ++v) {
        const std::size_t i = v % b.size[0], j = v / stride[1] % b.size[1], k = v / stride[2];
        const Vec3 index{b.low.x + static_cast<double>(i), b.low.y + static_cast<double>(j),
                         b.low.z + static_cast<double>(k)};
        if (std::array{i, j, k}[axis] + lag >= b.size[axis] || norm(index * scale - sphere.centre) < radius) continue;
        d.push_back(std::abs(static_cast<double>(crop.values[v]) - crop.values[v + lag * stride[axis]]));
      }
    if (d.size() < 20) return {};
    const double sd = stats::median(d) / 0.6745;
    result.count[lag] = static_cast<double>(d.size()), result.squares[lag] = result.count[lag] * sd * sd / 2;
  }
  return result;
}

}  // namespace

NoiseModel noise_within(const std::vector<Candidate>& spheres, const std::vector<Crop>& all, const MarkerWish& wish,
                        const std::vector<bool>& kept) {
  std::vector<Differences> each;
  for (std::size_t n = 0; n < spheres.size(); ++n) {
    if (!kept.empty() && !kept[n]) continue;
    const Differences d = differences_within(spheres[n], all[n], wish.scale);
    if (d.count[3] >= (kept.empty() ? 20 : 1)) each.push_back(d);
  }
  // Small ones have no inside to speak of.
  double within = 0;
  for (const Differences& d : each) within += d.count[3];
  if (within < 200)
    for (std::size_t n = 0; n < spheres.size(); ++n)
      if (kept.empty() || kept[n])
        if (const Differences d = differences_without(spheres[n], all[n], wish.scale); d.count[3] > 0)
          each.push_back(d);
  Differences sum;
  if (kept.empty() && !each.empty()) {
    const auto middle = each.begin() + static_cast<std::ptrdiff_t>((each.size() - 1) / 2);
    std::ranges::nth_element(each, middle, {}, [](const Differences& d) { return d.squares[3] / d.count[3]; });
    sum = *middle;
  } else {
    for (const Differences& d : each) sum.add(d);
  }
  NoiseModel model{wish.noise, wish.noise_correlation.value_or(0)};
  if (sum.count[3] < 20) return model;
  // D1 / D3 = (1 - q) / (1 - q^9), which falls with q.
  const double near = sum.squares[1] / sum.count[1], far = sum.squares[3] / sum.count[3],
               ratio = far > 0 ? near / far : 1;
  double& q = model.neighbour_correlation;
  if (!wish.noise_correlation) {
    double low = -0.45, high = 0.95;
    for (int n = 0; n < 50; ++n) {
      q = (low + high) / 2;
      const double foretold = (1 - q) / (q > 0 ? 1 - std::pow(q, 9) : 1);
      (foretold > ratio ? low : high) = q;
    }
  }
  if (!(model.sd > 0)) model.sd = std::sqrt(far / (q > 0 ? 1 - std::pow(q, 9) : 1));
  return model;
}

}  // namespace gonio::volume::marker
