// Thresholds from the histogram and from the slices: threshold.h.
#include "volume/threshold.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "volume/contour_shape.h"
#include "volume/slabs.h"

namespace gonio::volume {
namespace {

std::string short_number(double x) {
  return format("%.4g", x);
}

void demand_two(const Mixture& mixture, std::size_t lower, std::size_t upper) {
  const std::size_t n = mixture.materials.size();
  if (lower >= upper || upper >= n)
    throw Error(Exit::data, "threshold",
                "half-way between materials " + std::to_string(lower) + " and " + std::to_string(upper) +
                    " asked, but the histogram shows " + std::to_string(n),
                "name two of them, the lower first, or give the threshold as a value");
  if (!(mixture.materials[upper].mean > mixture.materials[lower].mean))
    throw Error(Exit::data, "threshold",
                "materials " + std::to_string(lower) + " and " + std::to_string(upper) + " have one mean (" +
                    short_number(mixture.materials[lower].mean) + ")",
                "a volume of one value has no surface: check the scan, or the window in which it was exported");
}

Threshold half_way_between(double lower, double upper, double sigma) {
  Threshold t;
  t.value = (lower + upper) / 2;
  t.sigma = sigma;
  t.how = "half-way between " + short_number(lower) + " and " + short_number(upper);
  return t;
}

// The mean of a normal law cut at mean +- c sd moves by this share of what the law's mean moves.
constexpr double window = 2;
double share_of_window() {
  const double phi = std::exp(-0.5 * window * window) / std::sqrt(2 * pi);
  return 1 - 2 * window * phi / std::erf(window / std::sqrt(2.0));
}

struct BlockSums {
  std::array<double, 2> sum{}, count{};
};

}  // namespace

Threshold half_way(const Mixture& mixture, std::size_t lower, std::size_t upper) {
  demand_two(mixture, lower, upper);
  const Material &a = mixture.materials[lower], &b = mixture.materials[upper];
  return half_way_between(a.mean, b.mean, std::hypot(a.sigma_mean, b.sigma_mean) / 2);
}

Threshold half_way(io::VolumeSource& source, const Mixture& mixture, std::size_t lower, std::size_t upper) {
  demand_two(mixture, lower, upper);
  const std::array<Material, 2> materials{mixture.materials[lower], mixture.materials[upper]};
  const std::size_t slices = source.head().size[2], blocks = std::min<std::size_t>(10, slices);
  std::vector<BlockSums> sums(blocks);
  for_each_slab(source, {8, 0, 0}, [&](const Slab& slab) {
    for (std::size_t k = slab.first; k < slab.first + slab.count; ++k) {
      BlockSums& block = sums[k * blocks / slices];
      const float* v = slab.slice(static_cast<std::ptrdiff_t>(k));
      for (std::size_t n = 0; n < slab.width * slab.height; ++n)
        for (std::size_t m = 0; m < 2; ++m) {
          const double d = v[n] - materials[m].mean;
          if (std::abs(d) <= window * materials[m].sd) block.sum[m] += d, block.count[m] += 1;
        }
    }
  });
  // Of all blocks but one; means as far as the window lets them move.
  const auto means_without = [&](std::size_t left_out) {
    std::array<double, 2> mean{};
    for (std::size_t m = 0; m < 2; ++m) {
      double sum = 0, count = 0;
      for (std::size_t b = 0; b < blocks; ++b)
        if (b != left_out) sum += sums[b].sum[m], count += sums[b].count[m];
      mean[m] = materials[m].mean + (count > 0 ? sum / count / share_of_window() : 0);
    }
    return mean;
  };
  const auto all = means_without(blocks);
  if (blocks < 3) return half_way(mixture, lower, upper);
  std::vector<double> values(blocks);
  double mean = 0, squares = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto part = means_without(b);
    values[b] = (part[0] + part[1]) / 2;
    mean += values[b] / static_cast<double>(blocks);
  }
  for (const double v : values) squares += (v - mean) * (v - mean);
  const double n = static_cast<double>(blocks);
  return half_way_between(all[0], all[1], std::sqrt(squares * (n - 1) / n));
}

Threshold otsu(const Histogram& h, double voxels_per_sample) {
  const std::size_t bins = h.counts.size();
  double total = 0, sum = 0, squares = 0;
  const double width = (h.high - h.low) / static_cast<double>(std::max<std::size_t>(1, bins));
  const auto centre = [&](std::size_t b) { return h.low + (static_cast<double>(b) + 0.5) * width; };
  for (std::size_t b = 0; b < bins; ++b) {
    const auto n = static_cast<double>(h.counts[b]);
    total += n, sum += n * centre(b), squares += n * centre(b) * centre(b);
  }
  if (!(total > 0) || !(h.largest > h.smallest))
    throw Error(Exit::data, "threshold",
                total > 0 ? "every voxel has the value " + short_number(h.smallest) + ": there is nothing to separate"
                          : "the volume has no finite value",
                "check the scan, or the window in which it was exported");
  double below = 0, below_sum = 0, below_squares = 0, best = -1, low = 0, high = 0;
  std::array<double, 4> at{};  // at the best: number and sum below, squares below
  for (std::size_t b = 0; b + 1 < bins; ++b) {
    const auto n = static_cast<double>(h.counts[b]);
    below += n, below_sum += n * centre(b), below_squares += n * centre(b) * centre(b);
    if (below == 0 || below == total) continue;
    const double d = below_sum / below - (sum - below_sum) / (total - below);
    const double between = below * (total - below) * d * d, edge = h.low + static_cast<double>(b + 1) * width;
    // Between empty bins all are best: the middle of them.
    if (between > best * (1 + 1e-12))
      best = between, low = high = edge, at = {below, below_sum, below_squares};
    else if (between >= best * (1 - 1e-12))
      high = edge;
  }
  Threshold t;
  t.how = "Otsu";
  t.value = (low + high) / 2;
  const double n0 = at[0], n1 = total - n0, m0 = at[1] / n0, m1 = (sum - at[1]) / n1;
  const double v0 = std::max(0.0, at[2] / n0 - m0 * m0), v1 = std::max(0.0, (squares - at[2]) / n1 - m1 * m1);
  // F(T) = T - (m0 + m1) / 2 vanishes; what crosses T as it moves moves the means: F' = 1 - p(T) (m1 - m0) / 4 (1/n0 +
  // 1/n1), p voxels per value.
  const auto bin = static_cast<std::size_t>(std::clamp((t.value - h.low) / width, 0.0, static_cast<double>(bins - 1)));
  double density = 0, count = 0;
  for (std::size_t b = bin > 8 ? bin - 8 : 0; b < std::min(bins, bin + 9); ++b)
    density += static_cast<double>(h.counts[b]), count += width;
  const double slope = std::max(0.1, 1 - density / count * (m1 - m0) / 4 * (1 / n0 + 1 / n1));
  t.sigma = std::hypot(std::sqrt((v0 / n0 + v1 / n1) * voxels_per_sample) / 2 / slope,
                       std::max(width, high - low) / std::sqrt(12.0));
  return t;
}

double voxels_per_value(const Histogram& h, const Contour& at, double threshold, Vec3 scale) {
  const double area = area_of(at, scale);
  if (!(area > 0))
    throw Error(Exit::data, "surface",
                "it is empty at the threshold " + short_number(threshold) + " (values run from " +
                    short_number(h.smallest) + " to " + short_number(h.largest) + ")",
                "choose a threshold between two materials of the histogram");
  const double bins = static_cast<double>(h.counts.size()), width = (h.high - h.low) / bins;
  // Over a twentieth of the values' range, weighted to its middle.
  const double reach = std::max(1.5 * width, (h.largest - h.smallest) / 40);
  double weighted = 0, weight = 0;
  for (std::size_t b = 0; b < h.counts.size(); ++b) {
    const double d = std::abs(h.low + (static_cast<double>(b) + 0.5) * width - threshold) / reach;
    if (d >= 1) continue;
    weighted += (1 - d) * static_cast<double>(h.counts[b]), weight += (1 - d) * width;
  }
  const double voxel = scale.x * scale.y * scale.z;
  return weight > 0 ? -weighted / weight * voxel / area : 0;
}

double length_bias(const Threshold& used, double better) {
  return 2 * used.voxels_per_value * (used.value - better);
}

LocalThreshold local_threshold(const Threshold& used, std::span<const Edge> edges) {
  LocalThreshold local;
  double sum = 0, squares = 0, shift = 0, shift2 = 0;
  for (const Edge& e : edges) {
    if (!e.good) continue;
    const double half = (e.air + e.object) / 2, step = e.object - e.air;
    local.edges += 1;
    sum += half, squares += half * half;
    // Where this edge crosses the threshold, less where it is: by its slope in the middle.
    const double wall = (half - used.value) / step * e.width * std::sqrt(2 * pi);
    shift += wall, shift2 += wall * wall;
  }
  if (local.edges == 0) return local;
  const double n = static_cast<double>(local.edges);
  local.mean = sum / n;
  local.sd = std::sqrt(std::max(0.0, squares / n - local.mean * local.mean));
  local.wall_bias = shift / n;
  local.wall_rms = std::sqrt(shift2 / n);
  return local;
}

}  // namespace gonio::volume
