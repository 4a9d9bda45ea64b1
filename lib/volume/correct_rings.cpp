// Rings (Sijbers & Postnov 2004), slice by slice: the slice in polar coordinates round the centre, less a median along
// the radius; the median of that over the angle is the ring at this radius. Only samples whose surroundings lie on one
// side of the threshold count, in the median along the radius as well, so that neither walls nor their smear are taken
// for rings. Bilinear sampling takes some of a ring as narrow as a voxel; three rounds take the rest.
#include <algorithm>
#include <cmath>
#include <vector>

#include "geom/vector.h"
#include "volume/correct_parts.h"

namespace gonio::volume {
namespace {

constexpr double radial_step = 0.5, clear_of_walls = 3;
constexpr int rounds_of_rings = 3;
constexpr std::size_t fewest_samples = 12;

float median_in_place(std::vector<float>& v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

class PolarSlice {
 public:
  PolarSlice(std::span<float> slice, std::size_t width, std::size_t height, const RingWish& wish)
      : slice_(slice), width_(width), height_(height), wish_(wish) {
    const double reach = std::min({wish.centre_i, wish.centre_j, static_cast<double>(width) - 1 - wish.centre_i,
                                   static_cast<double>(height) - 1 - wish.centre_j});
    radii_ = reach > 2 ? static_cast<std::size_t>((reach - 1) / radial_step) : 0;
    angles_ = std::clamp<std::size_t>(static_cast<std::size_t>(pi * reach), 90, 720);
  }
  std::size_t radii() const { return radii_; }

  std::vector<double> rings() {
    sample();
    const std::vector<std::uint8_t> clear = clear_samples();
    const auto half = static_cast<std::ptrdiff_t>(static_cast<double>(wish_.window) / 2 / radial_step);
    std::vector<std::vector<float>> left(radii_);  // what the radius' median leaves, by radius
    std::vector<float> window;
    for (std::size_t a = 0; a < angles_; ++a)
      for (std::size_t r = 0; r < radii_; ++r) {
        const std::size_t at = a * radii_ + r;
        if (!clear[at]) continue;
        window.clear();
        // Outwards from the sample as far as the side stays the same and clear.
        for (const std::ptrdiff_t step : {std::ptrdiff_t{-1}, std::ptrdiff_t{1}})
          for (std::ptrdiff_t d = step > 0 ? 0 : -1, to = static_cast<std::ptrdiff_t>(r) + d;
               std::abs(d) <= half && to >= 0 && to < static_cast<std::ptrdiff_t>(radii_); d += step, to += step) {
            const std::size_t there = a * radii_ + static_cast<std::size_t>(to);
            if (!clear[there]) break;
            window.push_back(values_[there]);
          }
        if (window.size() < fewest_samples) continue;
        left[r].push_back(values_[at] - median_in_place(window));
      }
    std::vector<double> rings(radii_, 0.0);
    for (std::size_t r = 4; r < radii_; ++r)  // nearer to the centre too few voxels tell
      if (left[r].size() >= std::max(fewest_samples, angles_ / 20)) rings[r] = median_in_place(left[r]);
    return rings;
  }

  void take_off(const std::vector<double>& rings) {
    for (std::size_t j = 0; j < height_; ++j)
      for (std::size_t i = 0; i < width_; ++i) {
        const double r = std::hypot(static_cast<double>(i) - wish_.centre_i, static_cast<double>(j) - wish_.centre_j);
        const double at = r / radial_step;
        const auto r0 = static_cast<std::size_t>(at);
        if (r0 + 1 >= radii_) continue;
        const double f = at - static_cast<double>(r0);
        slice_[j * width_ + i] -= static_cast<float>((1 - f) * rings[r0] + f * rings[r0 + 1]);
      }
  }

 private:
  void sample() {
    values_.resize(angles_ * radii_);
    for (std::size_t a = 0; a < angles_; ++a) {
      const double angle = 2 * pi * static_cast<double>(a) / static_cast<double>(angles_);
      const double c = std::cos(angle) * radial_step, s = std::sin(angle) * radial_step;
      for (std::size_t r = 0; r < radii_; ++r) {
        const double x = wish_.centre_i + c * static_cast<double>(r), y = wish_.centre_j + s * static_cast<double>(r);
        const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
        const auto f = static_cast<float>(x - static_cast<double>(i)),
                   g = static_cast<float>(y - static_cast<double>(j));
        const float* v = slice_.data() + j * width_ + i;
        values_[a * radii_ + r] = (1 - g) * ((1 - f) * v[0] + f * v[1]) + g * ((1 - f) * v[width_] + f * v[width_ + 1]);
      }
    }
  }

  // All samples nearer than three voxels, along the radius and across, are on the sample's side of the threshold.
  std::vector<std::uint8_t> clear_samples() const {
    std::vector<std::uint8_t> clear(values_.size(), 1);
    if (!wish_.threshold) return clear;
    const auto side = [&](std::size_t a, std::size_t r) { return values_[a * radii_ + r] > *wish_.threshold; };
    const auto along = static_cast<std::size_t>(clear_of_walls / radial_step);
    std::vector<std::uint8_t> radial(values_.size(), 0);
    for (std::size_t a = 0; a < angles_; ++a)
      for (std::size_t r = 0; r < radii_; ++r) {
        bool same = true;
        for (std::size_t n = r > along ? r - along : 0; n <= std::min(radii_ - 1, r + along) && same; ++n)
          same = side(a, n) == side(a, r);
        radial[a * radii_ + r] = same;
      }
    for (std::size_t r = 0; r < radii_; ++r) {
      const double arc = 2 * pi * std::max(1.0, static_cast<double>(r)) * radial_step / static_cast<double>(angles_);
      const std::size_t across = std::min(angles_ / 2, static_cast<std::size_t>(clear_of_walls / arc));
      for (std::size_t a = 0; a < angles_; ++a) {
        bool same = true;
        for (std::size_t n = 0; n <= 2 * across && same; ++n) {
          const std::size_t there = (a + angles_ + n - across) % angles_;
          same = radial[there * radii_ + r] && side(there, r) == side(a, r);
        }
        clear[a * radii_ + r] = same;
      }
    }
    return clear;
  }

  std::span<float> slice_;
  std::size_t width_, height_;
  const RingWish& wish_;
  std::size_t radii_ = 0, angles_ = 0;
  std::vector<float> values_;
};

}  // namespace

void take_off_rings(std::span<float> slice, std::size_t width, std::size_t height, const RingWish& wish) {
  PolarSlice polar(slice, width, height, wish);
  if (polar.radii() < 8) return;
  for (int round = 0; round < rounds_of_rings; ++round) polar.take_off(polar.rings());
}

}  // namespace gonio::volume
