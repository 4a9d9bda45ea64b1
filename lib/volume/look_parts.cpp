#include "volume/look_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "stats/intervals.h"

namespace gonio::volume {
namespace {

// Rows of samples are worked on as a whole, whatever the axis: lines along j and k are far apart in memory.
constexpr std::size_t at_once = 16;

// here becomes (before + here + after) / 3, before what here was.
void mean_of_three(float* __restrict here, const float* __restrict after, float* __restrict before, std::size_t n) {
  std::size_t i = 0;
  for (; i + at_once <= n; i += at_once)
    for (std::size_t c = i; c < i + at_once; ++c) {
      const float was = here[c];
      here[c] = (before[c] + was + after[c]) / 3;
      before[c] = was;
    }
  for (; i < n; ++i) {
    const float was = here[i];
    here[i] = (before[i] + was + after[i]) / 3;
    before[i] = was;
  }
}

// Along one row, whose ends repeat. `room`: n + 2 samples.
void mean_along(float* __restrict row, float* __restrict room, std::size_t n) {
  std::copy(row, row + n, room + 1);
  room[0] = row[0], room[n + 1] = row[n - 1];
  std::size_t i = 0;
  for (; i + at_once <= n; i += at_once)
    for (std::size_t c = i; c < i + at_once; ++c) row[c] = (room[c] + room[c + 1] + room[c + 2]) / 3;
  for (; i < n; ++i) row[i] = (room[i] + room[i + 1] + room[i + 2]) / 3;
}

// `count` rows of w samples, `stride` apart.
void mean_across(float* rows, std::size_t stride, std::size_t count, std::size_t w) {
  thread_local std::vector<float> before, last;
  before.assign(rows, rows + w);
  last.assign(rows + (count - 1) * stride, rows + (count - 1) * stride + w);
  for (std::size_t k = 0; k < count; ++k)
    mean_of_three(rows + k * stride, k + 1 < count ? rows + (k + 1) * stride : last.data(), before.data(), w);
}

// into &= of, eight flags at a time.
void both(std::uint8_t* into, const std::uint8_t* of, std::size_t n) {
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    std::uint64_t a = 0, b = 0;
    std::memcpy(&a, into + i, 8), std::memcpy(&b, of + i, 8);
    a &= b;
    std::memcpy(into + i, &a, 8);
  }
  for (; i < n; ++i) into[i] &= of[i];
}

// Flags whose r neighbours on either side of the row all are set.
void eroded_along(std::uint8_t* row, std::size_t n, std::size_t r) {
  thread_local Flags room;
  room.assign(n + 2 * r, 0);
  std::copy(row, row + n, room.begin() + static_cast<std::ptrdiff_t>(r));
  for (std::size_t d = 0; d <= 2 * r; ++d)
    if (d != r) both(row, room.data() + d, n);
}

// The same across `count` rows of w flags, `stride` apart.
void eroded_across(std::uint8_t* rows, std::size_t stride, std::size_t count, std::size_t w, std::size_t r) {
  thread_local Flags was;
  was.resize(count * w);
  for (std::size_t k = 0; k < count; ++k)
    std::copy(rows + k * stride, rows + k * stride + w, was.begin() + static_cast<std::ptrdiff_t>(k * w));
  for (std::size_t k = 0; k < count; ++k) {
    std::uint8_t* row = rows + k * stride;
    if (k < r || k + r >= count)
      std::fill(row, row + w, std::uint8_t{0});
    else
      for (std::size_t d = 0; d <= 2 * r; ++d)
        if (d != r) both(row, was.data() + (k + d - r) * w, w);
  }
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
  const std::size_t w = slab.width, h = slab.height, slice = w * h, depth = means.size() / slice;
  parallel_for(0, depth, [&](std::size_t k) {
    thread_local std::vector<float> room;
    room.resize(w + 2);
    for (std::size_t j = 0; j < h; ++j) mean_along(means.data() + k * slice + j * w, room.data(), w);
    mean_across(means.data() + k * slice, w, h, w);
  });
  parallel_for(
      0, h, [&](std::size_t j) { mean_across(means.data() + j * w, slice, depth, w); }, 8);
  return means;
}

Flags eroded(const Slab& slab, Flags flags, std::size_t r) {
  if (r == 0) return flags;
  const std::size_t w = slab.width, h = slab.height, slice = w * h, depth = flags.size() / slice;
  parallel_for(0, depth, [&](std::size_t k) {
    for (std::size_t j = 0; j < h; ++j) eroded_along(flags.data() + k * slice + j * w, w, r);
    eroded_across(flags.data() + k * slice, w, h, w, r);
  });
  parallel_for(
      0, h, [&](std::size_t j) { eroded_across(flags.data() + j * w, slice, depth, w, r); }, 8);
  return flags;
}

std::vector<double> radii_of_slice(const Slab& slab) {
  std::vector<double> radii(slab.width * slab.height);
  const double ci = (static_cast<double>(slab.width) - 1) / 2, cj = (static_cast<double>(slab.height) - 1) / 2;
  parallel_for(0, slab.height, [&](std::size_t j) {
    for (std::size_t i = 0; i < slab.width; ++i)
      radii[j * slab.width + i] = std::hypot(static_cast<double>(i) - ci, static_cast<double>(j) - cj);
  });
  return radii;
}

double robust_sd(std::span<const double> values) {
  if (values.size() < 2) return 0;
  const double centre = stats::median(values);
  std::vector<double> deviations;
  double squares = 0;
  for (const double v : values)
    deviations.push_back(std::abs(v - centre)), squares += deviations.back() * deviations.back();
  double sd = stats::sigma_of_median * stats::median(deviations);
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
