#include "volume/look_parts.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::volume {
namespace {

// body(values, stride, n) for every line of the slab along an axis.
template <class T, class Body>
void along_lines(const Slab& slab, std::vector<T>& values, int axis, const Body& body) {
  const std::size_t w = slab.width, h = slab.height, slice = w * h, depth = values.size() / slice;
  if (axis == 0)
    parallel_for(
        0, depth * h, [&](std::size_t l) { body(values.data() + l * w, std::size_t{1}, w); }, 64);
  if (axis == 1)
    parallel_for(0, depth, [&](std::size_t k) {
      for (std::size_t i = 0; i < w; ++i) body(values.data() + k * slice + i, w, h);
    });
  if (axis == 2)
    parallel_for(0, h, [&](std::size_t j) {
      for (std::size_t i = 0; i < w; ++i) body(values.data() + j * w + i, slice, depth);
    });
}

}  // namespace

AirAndObject air_and_object(const Mixture& mixture) {
  const auto& all = mixture.materials;
  if (all.size() < 2)
    throw Error(Exit::data, "volume", "the histogram shows one material only",
                "check the scan, or the window in which it was exported");
  const auto largest_from = [&](std::size_t first) {
    double largest = 0;
    for (std::size_t m = first; m < all.size(); ++m) largest = std::max(largest, all[m].share);
    return largest;
  };
  AirAndObject chosen;
  while (all[chosen.air].share < largest_from(0) / 30) ++chosen.air;
  if (chosen.air + 1 == all.size()) chosen.air = 0;
  for (std::size_t m = chosen.air + 1; m < all.size(); ++m)
    if (all[m].share >= 0.2 * largest_from(chosen.air + 1)) chosen.object = m;
  return chosen;
}

Sides sides_of(const Mixture& mixture) {
  const AirAndObject chosen = air_and_object(mixture);
  return {mixture.materials[chosen.air].mean, mixture.materials[chosen.object].mean};
}

void for_each_probe(io::VolumeSource& source, const ProbeWish& wish, const std::function<void(const Slab&)>& body) {
  const auto& size = source.head().size;
  const std::size_t slice = size[0] * size[1], deep = wish.count + 2 * wish.margin;
  if (slice * size[2] <= wish.most || size[2] <= deep) {
    for_each_slab(source, {wish.count, wish.margin, wish.outside}, body);
    return;
  }
  const std::size_t slabs = std::clamp<std::size_t>(wish.most / (slice * deep), 1, size[2] / deep);
  for (std::size_t s = 0; s < slabs; ++s) {
    const std::size_t start = slabs == 1 ? (size[2] - deep) / 2 : s * (size[2] - deep) / (slabs - 1);
    Slab slab{size[0], size[1], start + wish.margin, wish.count, wish.margin, {}};
    slab.values.resize(deep * slice);
    source.read(start, deep, slab.values);
    body(slab);
  }
}

std::vector<float> box_means(const Slab& slab) {
  std::vector<float> means = slab.values;
  for (int axis = 0; axis < 3; ++axis)
    along_lines(slab, means, axis, [](float* v, std::size_t stride, std::size_t n) {
      float before = v[0];
      for (std::size_t k = 0; k < n; ++k) {
        const float here = v[k * stride], after = k + 1 < n ? v[(k + 1) * stride] : here;
        v[k * stride] = (before + here + after) / 3;
        before = here;
      }
    });
  return means;
}

Flags eroded(const Slab& slab, Flags flags, std::size_t r) {
  if (r == 0) return flags;
  for (int axis = 0; axis < 3; ++axis)
    along_lines(slab, flags, axis, [r](std::uint8_t* f, std::size_t stride, std::size_t n) {
      thread_local std::vector<std::size_t> before;  // flags in a row that end here
      before.resize(n);
      std::size_t run = 0;
      for (std::size_t k = 0; k < n; ++k) before[k] = run = f[k * stride] ? run + 1 : 0;
      run = 0;
      for (std::size_t k = n; k-- > 0;) {
        run = f[k * stride] ? run + 1 : 0;
        f[k * stride] = run > r && before[k] > r;
      }
    });
  return flags;
}

double robust_sd(std::span<const double> values) {
  if (values.size() < 2) return 0;
  const double centre = stats::median(values);
  std::vector<double> deviations;
  double squares = 0;
  for (const double v : values)
    deviations.push_back(std::abs(v - centre)), squares += deviations.back() * deviations.back();
  double sd = 1.4826 * stats::median(deviations);
  if (sd == 0) sd = std::sqrt(squares / static_cast<double>(values.size()));
  constexpr double kept_variance = 0.97334;  // of a normal law between -3 and 3 sd
  for (int round = 0; round < 20 && sd > 0; ++round) {
    double sum = 0, sum2 = 0, n = 0;
    for (const double v : values)
      if (std::abs(v - centre) <= 3 * sd) sum += v - centre, sum2 += (v - centre) * (v - centre), ++n;
    const double next = std::sqrt(std::max(0.0, sum2 / n - sum * sum / n / n) / kept_variance);
    if (std::abs(next - sd) < 1e-4 * sd) return next;
    sd = next;
  }
  return sd;
}

}  // namespace gonio::volume
