// Histograms: look.h.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "volume/look.h"
#include "volume/slabs.h"

namespace gonio::volume {
namespace {

struct Extremes {
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
};

// Of finite values.
Extremes extremes_of(io::VolumeSource& source) {
  Extremes found;
  for_each_slab(source, {32, 0, 0}, [&](const Slab& slab) {
    float lo = std::numeric_limits<float>::infinity(), hi = -lo;
    for (const float v : slab.values)
      if (std::isfinite(v)) lo = std::min(lo, v), hi = std::max(hi, v);
    found.smallest = std::min<double>(found.smallest, lo), found.largest = std::max<double>(found.largest, hi);
  });
  if (!(found.smallest <= found.largest))
    throw Error(Exit::data, source.head().files.empty() ? "volume" : source.head().files.front().string(),
                "no voxel has a finite value");
  return found;
}

bool is_integer(io::VoxelType type) {
  return type != io::VoxelType::f32 && type != io::VoxelType::f64;
}

// Bins of 8-bit data are codes; those of other integers hold a whole number of codes each, lest some hold one more than
// others and the histogram looks like a comb.
Histogram empty_histogram(const io::VolumeHead& head, const Extremes& e, std::size_t bins) {
  Histogram h;
  h.smallest = e.smallest, h.largest = e.largest;
  const double code = std::abs(head.slope);
  if (head.type == io::VoxelType::u8 || head.type == io::VoxelType::i8) {
    const double first = head.type == io::VoxelType::u8 ? 0 : -128, last = first + 255;
    h.low = std::min(head.slope * first, head.slope * last) + head.intercept - code / 2;
    h.high = h.low + 256 * code;
    h.counts.assign(256, 0);
  } else if (is_integer(head.type) && code > 0) {
    const double codes = std::round((e.largest - e.smallest) / code) + 1;
    const double per_bin = std::max(1.0, std::ceil(codes / static_cast<double>(bins)));
    h.low = e.smallest - code / 2;
    h.counts.assign(static_cast<std::size_t>(std::ceil(codes / per_bin)), 0);
    h.high = h.low + static_cast<double>(h.counts.size()) * per_bin * code;
  } else if (e.largest > e.smallest) {
    h.low = e.smallest, h.high = e.largest;
    h.counts.assign(bins, 0);
  } else {
    h.low = e.smallest - 0.5, h.high = e.smallest + 0.5;
    h.counts.assign(1, 0);
  }
  return h;
}

}  // namespace

Histogram histogram(io::VolumeSource& source, std::size_t bins) {
  Histogram h = empty_histogram(source.head(), extremes_of(source), std::max<std::size_t>(1, bins));
  const double per_value = static_cast<double>(h.counts.size()) / (h.high - h.low);
  const auto last = static_cast<double>(h.counts.size() - 1);
  for_each_slab(source, {32, 0, 0}, [&](const Slab& slab) {
    const std::size_t n = slab.count * slab.width * slab.height;
    for (std::size_t v = 0; v < n; ++v) {
      const double value = slab.values[v];
      if (std::isfinite(value))
        ++h.counts[static_cast<std::size_t>(std::clamp((value - h.low) * per_value, 0.0, last))];
      else
        ++h.not_finite;
    }
  });
  return h;
}

}  // namespace gonio::volume
