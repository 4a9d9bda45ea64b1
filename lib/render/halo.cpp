// See halo.h.
#include "render/halo.h"

#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::render {
namespace {

constexpr int reach = 4, across = 2 * reach + 1;  // squares of one size to either side
constexpr int fine = 9;                           // places along a square's side at which the kernel is asked, at most

double kernel(double r2, double radius_px) {
  const double q = 1 + r2 / (radius_px * radius_px);
  return 1 / (2 * pi * radius_px * radius_px * q * std::sqrt(q));
}

// Mean over the pixels of a square of that side whose middle is (x, y) away.
double mean_kernel(double x, double y, int side, double radius_px) {
  const int n = std::min(side, fine);
  double sum = 0;
  for (int v = 0; v < n; ++v)
    for (int u = 0; u < n; ++u) {
      const double dx = x + side * ((u + 0.5) / n - 0.5), dy = y + side * ((v + 0.5) / n - 0.5);
      sum += kernel(dx * dx + dy * dy, radius_px);
    }
  return sum / (n * n);
}

// Covered by the next finer size, or the pixel itself.
bool is_inner(int i, int j, int size) {
  const int covered = size == 0 ? 0 : 1;
  return std::abs(i) <= covered && std::abs(j) <= covered;
}

}  // namespace

Halo::Halo(const io::Image& picture, std::span<const double> radii_px)
    : width_(picture.width), height_(picture.height), channels_(picture.channels.size()), radii_(radii_px.size()) {
  const auto columns = static_cast<std::size_t>(width_) + 1;
  sums_.assign(columns * (static_cast<std::size_t>(height_) + 1) * channels_, 0.0);
  for (int y = 0; y < height_; ++y)
    for (std::size_t c = 0; c < channels_; ++c) {
      double row = 0;
      for (int x = 0; x < width_; ++x) {
        const float v = picture.at(x, y, static_cast<int>(c));
        row += std::isfinite(v) ? double{v} : 0;
        const std::size_t above =
            (static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x) + 1) * channels_ + c;
        sums_[above + columns * channels_] = sums_[above] + row;
      }
    }
  int side = 1;
  while ((reach + 0.5) * side < std::max(width_, height_)) side *= 3, ++sizes_;
  side = 1;
  for (int size = 0; size < sizes_; ++size, side *= 3)
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i)
        for (const double radius : radii_px) {
          const bool inner = is_inner(i, j, size);
          weights_.push_back(inner ? 0 : mean_kernel(i * side, j * side, side, radius));
          for (int part = 0; size > 0 && part < 9; ++part)
            parts_.push_back(inner ? 0
                                   : mean_kernel(i * side + (part % 3 - 1) * side / 3,
                                                 j * side + (part / 3 - 1) * side / 3, side / 3, radius));
        }
}

double Halo::own_share(double radius_px) {
  return kernel(0, radius_px);
}

double Halo::box(int left, int top, int right, int bottom, std::size_t channel) const {
  left = std::max(left, 0), top = std::max(top, 0);
  right = std::min(right, width_ - 1), bottom = std::min(bottom, height_ - 1);
  if (left > right || top > bottom) return 0;
  const auto columns = static_cast<std::size_t>(width_) + 1;
  const auto at = [&](int x, int y) {
    return sums_[(static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)) * channels_ + channel];
  };
  return at(right + 1, bottom + 1) - at(left, bottom + 1) - at(right + 1, top) + at(left, top);
}

std::vector<double> Halo::around(int x, int y) const {
  std::vector<double> result(radii_ * channels_, 0.0);
  const auto add = [&](int left, int top, int side, const double* weight, std::size_t stride) {
    for (std::size_t c = 0; c < channels_; ++c) {
      const double sum = box(left, top, left + side - 1, top + side - 1, c);
      for (std::size_t r = 0; r < radii_; ++r) result[r * channels_ + c] += weight[r * stride] * sum;
    }
  };
  std::size_t square = 0;
  int side = 1;
  for (int size = 0; size < sizes_; ++size, side *= 3)
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i, ++square) {
        if (is_inner(i, j, size)) continue;
        const int left = x + i * side - side / 2, top = y + j * side - side / 2;
        if (left >= width_ || top >= height_ || left + side <= 0 || top + side <= 0) continue;
        const bool cut = left < 0 || top < 0 || left + side > width_ || top + side > height_;
        if (size == 0 || !cut) {
          add(left, top, side, &weights_[square * radii_], 1);
          continue;
        }
        const double* parts = &parts_[(square - across * across) * radii_ * 9];
        for (int part = 0; part < 9; ++part)
          add(left + part % 3 * side / 3, top + part / 3 * side / 3, side / 3, parts + part, 9);
      }
  return result;
}

}  // namespace gonio::render
