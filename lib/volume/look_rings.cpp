// Rings and streaks.
//
// A ring is what all angles share at one radius of one slice. Means over even and over odd sectors of the circle have
// it in common and their noise not, so that the mean of their product is its variance, and zero where there are none.
// Second differences along the radius take slow changes away.
//
// Streaks cross the air between parts of the object: what means over 3 x 3 x 3 voxels of air within the object's convex
// hull (slice by slice) vary more than those outside of it.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

constexpr std::size_t sectors = 8;

struct SliceSums {
  double products = 0, weights = 0;
};

// Of every pixel of a slice: twice its radius in whole voxels, plus one where its sector is odd.
std::vector<std::uint32_t> ring_and_sector(const Slab& slab) {
  const double ci = (static_cast<double>(slab.width) - 1) / 2, cj = (static_cast<double>(slab.height) - 1) / 2;
  std::vector<std::uint32_t> all(slab.width * slab.height);
  parallel_for(0, slab.height, [&](std::size_t j) {
    for (std::size_t i = 0; i < slab.width; ++i) {
      const double x = static_cast<double>(i) - ci, y = static_cast<double>(j) - cj;
      const auto sector = static_cast<std::size_t>((std::atan2(y, x) / pi + 1) / 2 * sectors) % 2;
      all[j * slab.width + i] =
          static_cast<std::uint32_t>(2 * static_cast<std::size_t>(std::hypot(x, y) + 0.5) + sector);
    }
  });
  return all;
}

SliceSums rings_of_slice(const Slab& slab, std::size_t at, const Flags& flags,
                         const std::vector<std::uint32_t>& places) {
  const double ci = (static_cast<double>(slab.width) - 1) / 2, cj = (static_cast<double>(slab.height) - 1) / 2;
  const auto radii = static_cast<std::size_t>(std::hypot(ci, cj)) + 2;
  std::vector<std::array<double, 2>> sum(radii), count(radii);
  for (std::size_t v = 0; v < places.size(); ++v)
    if (flags[at + v]) {
      const std::size_t r = places[v] / 2, sector = places[v] % 2;
      sum[r][sector] += slab.values[at + v], count[r][sector] += 1;
    }
  SliceSums result;
  for (std::size_t r = 3; r + 1 < radii; ++r) {
    std::array<double, 2> bend{};
    double least = HUGE_VAL;
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t near = r - 1; near <= r + 1; ++near) least = std::min(least, count[near][s]);
      if (least < 8) break;
      bend[s] = sum[r][s] / count[r][s] - (sum[r - 1][s] / count[r - 1][s] + sum[r + 1][s] / count[r + 1][s]) / 2;
    }
    if (least < 8) continue;
    result.products +=
        least * bend[0] * bend[1] / 1.5;  // the second difference of independent rings has 1.5 times theirs
    result.weights += least;
  }
  return result;
}

// For every row of a slice the first and last column of the convex hull of `inside`; {1, 0} where it has none.
std::vector<std::array<double, 2>> hull_of(const Slab& slab, const float* means, double half) {
  struct Point {
    double x, y;
  };
  std::vector<Point> left, right;
  const auto turns_in = [](const Point& a, const Point& b, const Point& c, double sign) {
    return sign * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) >= 0;
  };
  const auto add = [&](std::vector<Point>& chain, Point p, double sign) {
    while (chain.size() > 1 && turns_in(chain[chain.size() - 2], chain.back(), p, sign)) chain.pop_back();
    chain.push_back(p);
  };
  for (std::size_t j = 0; j < slab.height; ++j) {
    const float *row = means + j * slab.width, *end = row + slab.width;
    const float* first = std::find_if(row, end, [&](float v) { return v > half; });
    if (first == end) continue;
    const float* last = end - 1;
    while (!(*last > half)) --last;
    add(left, {static_cast<double>(first - row), static_cast<double>(j)}, 1);
    add(right, {static_cast<double>(last - row), static_cast<double>(j)}, -1);
  }
  std::vector<std::array<double, 2>> rows(slab.height, {1.0, 0.0});
  if (left.empty()) return rows;
  const auto at = [](const std::vector<Point>& chain, double y) {
    std::size_t k = 0;
    while (k + 2 < chain.size() && chain[k + 1].y < y) ++k;
    if (chain.size() == 1) return chain[0].x;
    const double t = (y - chain[k].y) / (chain[k + 1].y - chain[k].y);
    return chain[k].x + t * (chain[k + 1].x - chain[k].x);
  };
  for (auto y = static_cast<std::size_t>(left.front().y); y <= static_cast<std::size_t>(left.back().y); ++y)
    rows[y] = {at(left, static_cast<double>(y)), at(right, static_cast<double>(y))};
  return rows;
}

}  // namespace

void RingProbe::take(const Slab& slab, const Flags& air, const Flags& object) {
  const std::size_t slice = slab.width * slab.height;
  std::vector<SliceSums> sums(2 * slab.count);
  const std::vector<std::uint32_t> places = ring_and_sector(slab);
  parallel_for(0, slab.count, [&](std::size_t k) {
    const std::size_t at = (slab.margin + k) * slice;
    sums[2 * k] = rings_of_slice(slab, at, air, places);
    sums[2 * k + 1] = rings_of_slice(slab, at, object, places);
  });
  for (const SliceSums& s : sums) products_ += s.products, weights_ += s.weights;
}

double RingProbe::variance() const {
  return weights_ > 0 ? std::max(0.0, products_ / weights_) : 0;
}

void StreakProbe::take(const Slab& slab, const std::vector<float>& means, const Flags& deep_air, const Sides& sides) {
  const std::size_t w = slab.width, h = slab.height, slice = w * h;
  const double radius = static_cast<double>(std::min(w, h)) / 2 - 3,
               apart = std::max(5.0, 0.04 * static_cast<double>(w));
  const std::vector<double> radii = radii_of_slice(slab);
  std::vector<std::array<std::array<double, 3>, 2>> sums(
      slab.count);  // count, sum, squares within and outside the hull
  parallel_for(0, slab.count, [&](std::size_t k) {
    const std::size_t base = (slab.margin + k) * slice;
    const auto hull = hull_of(slab, means.data() + base, sides.half());
    for (std::size_t j = 0; j < h; ++j)
      for (std::size_t i = 0; i < w; ++i) {
        if (!deep_air[base + j * w + i]) continue;
        const double x = static_cast<double>(i);
        const bool in_circle = radii[j * w + i] < radius;
        const bool empty = hull[j][0] > hull[j][1], within = !empty && x > hull[j][0] && x < hull[j][1];
        // Rows beyond the hull's ends are outside as a whole; within its rows, what lies well beside it.
        if (!within && (!in_circle || (!empty && x > hull[j][0] - apart && x < hull[j][1] + apart))) continue;
        const double v = means[base + j * w + i] - sides.air;
        auto& s = sums[k][within ? 0 : 1];
        s[0] += 1, s[1] += v, s[2] += v * v;
      }
  });
  for (const auto& s : sums) {
    if (s[0][0] < 30 || s[1][0] < 30) continue;
    within_ += s[0][2] - s[0][1] * s[0][1] / s[0][0], count_within_ += s[0][0];
    without_ += s[1][2] - s[1][1] * s[1][1] / s[1][0], count_without_ += s[1][0];
  }
}

double StreakProbe::sd() const {
  if (count_within_ == 0 || count_without_ == 0) return 0;
  return std::sqrt(std::max(0.0, within_ / count_within_ - without_ / count_without_));
}

}  // namespace gonio::volume
