#include "explain/images/pictures.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "io/picture.h"
#include "report/colour_map.h"

namespace gonio::explain::images {
namespace {

constexpr int reach = 2;  // windows of 5 x 5

std::size_t at(const WholeImage& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
}
double residual(const WholeImage& image, std::size_t value, bool after) {
  return image.observed[value] - (after ? image.after[value] : image.before[value]);
}

}  // namespace

std::vector<double> excess(const WholeImage& image, bool after) {
  std::vector<double> result(image.counts.size());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      double sum = 0, n = 0;
      for (int v = std::max(0, y - reach); v <= std::min(image.height - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(image.width - 1, x + reach); ++u) {
          const std::size_t i = at(image, u, v);
          if (!image.counts[i]) continue;
          for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double z = residual(image, c, after) / image.sigma[c];
            sum += z * z - 1;
            n += 1;
          }
        }
      if (n > 0) result[at(image, x, y)] = sum / std::sqrt(2 * n);
    }
  return result;
}

std::vector<double> effect(const WholeImage& image, bool named) {
  constexpr double half = 3;
  std::vector<double> result(image.counts.size());
  const std::vector<double> significance = named ? std::vector<double>{} : excess(image, false);
  constexpr double values_of_window = 3 * (2 * reach + 1) * (2 * reach + 1);
  for (std::size_t i = 0; i < result.size(); ++i) {
    double e = 0;
    if (named) {
      for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
        e += std::abs(image.after[c] - image.before[c]) / image.sigma[c] / 3;
    } else if (image.counts[i]) {
      e = std::sqrt(std::max(0.0, significance[i]) * std::sqrt(2 / values_of_window));
    }
    result[i] = e / (e + half);
  }
  return result;
}

io::Image spread(const std::vector<double>& values, const WholeImage& image, int width, int height) {
  io::Image picture(width, height, {"Y"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.at(x, y, 0) = static_cast<float>(values[at(image, x / image.stride, y / image.stride)]);
  return picture;
}

std::vector<std::uint8_t> mismatch_mask(const WholeImage& image, double limit, double smallest_effect) {
  const std::vector<double> significance = excess(image, false);
  double square = 0, n = 0;
  for (std::size_t i = 0; i < image.counts.size(); ++i)
    if (image.counts[i])
      for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) square += image.observed[c] * image.observed[c], n += 1;
  const double least = smallest_effect * std::sqrt(square / std::max(1.0, n));
  std::vector<std::uint8_t> mask(image.counts.size());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!image.counts[i] || significance[i] < limit) continue;
    double mean = 0;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) mean += std::abs(residual(image, c, false)) / 3;
    mask[i] = mean > least;
  }
  return mask;
}

std::vector<Box> boxes_of(const std::vector<std::uint8_t>& mask, const WholeImage& image, std::size_t least,
                          std::size_t most) {
  std::vector<std::uint8_t> seen(mask.size());
  std::vector<std::pair<std::size_t, Box>> found;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (!mask[at(image, x, y)] || seen[at(image, x, y)]) continue;
      std::queue<std::pair<int, int>> open;
      open.push({x, y});
      seen[at(image, x, y)] = 1;
      int left = x, right = x, top = y, bottom = y;
      std::size_t size = 0;
      for (; !open.empty(); open.pop(), ++size) {
        const auto [u, v] = open.front();
        left = std::min(left, u), right = std::max(right, u), top = std::min(top, v), bottom = std::max(bottom, v);
        for (int b = std::max(0, v - 1); b <= std::min(image.height - 1, v + 1); ++b)
          for (int a = std::max(0, u - 1); a <= std::min(image.width - 1, u + 1); ++a)
            if (mask[at(image, a, b)] && !seen[at(image, a, b)]) {
              seen[at(image, a, b)] = 1;
              open.push({a, b});
            }
      }
      if (size < least) continue;
      found.push_back({size,
                       {"", left * image.stride, top * image.stride, (right - left + 1) * image.stride,
                        (bottom - top + 1) * image.stride}});
    }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Box> boxes;
  for (std::size_t k = 0; k < std::min(most, found.size()); ++k) boxes.push_back(found[k].second);
  return boxes;
}

namespace {

constexpr int shown_px = 720;

io::Image enlarged(const io::Image& small) {
  const int factor = std::max(1, shown_px / std::max(1, small.width));
  if (factor == 1) return small;
  io::Image large(small.width * factor, small.height * factor, small.channels);
  const int channels = static_cast<int>(small.channels.size());
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      for (int c = 0; c < channels; ++c) large.at(x, y, c) = small.at(x / factor, y / factor, c);
  return large;
}

}  // namespace

io::Image effect_picture(const std::vector<double>& effect, const WholeImage& image) {
  io::Image picture(image.width, image.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < effect.size(); ++i) {
    const auto strength = static_cast<float>(effect[i]);
    picture.data[3 * i] = 1 - 0.5f * strength;
    picture.data[3 * i + 1] = picture.data[3 * i + 2] = 1 - strength;
  }
  return enlarged(picture);
}

io::Image shown(const std::vector<double>& values, const WholeImage& image, double white) {
  io::Image picture(image.width, image.height, {"R", "G", "B"});
  for (std::size_t k = 0; k < values.size(); ++k)
    picture.data[k] = io::srgb_from_linear(static_cast<float>(std::clamp(values[k] / white, 0.0, 1.0)));
  return enlarged(picture);
}

io::Image residual_picture(const WholeImage& image, bool after, double scale) {
  constexpr report::Colour not_counted{0.62f, 0.62f, 0.62f};
  io::Image picture(image.width, image.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.counts.size(); ++i) {
    double mean = 0;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) mean += residual(image, c, after) / 3;
    std::ranges::copy(image.counts[i] ? report::signed_colour(mean / scale) : not_counted,
                      picture.data.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return enlarged(picture);
}

namespace {

void put(io::Image& picture, int x, int y, bool yellow) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  picture.at(x, y, 0) = picture.at(x, y, 1) = yellow ? 1.0f : 0.0f;
  picture.at(x, y, 2) = 0;
}

// The border of the rectangle from (left, top) to (right, bottom), one pixel wide.
void border(io::Image& picture, int left, int top, int right, int bottom, bool yellow) {
  for (int x = left; x <= right; ++x) put(picture, x, top, yellow), put(picture, x, bottom, yellow);
  for (int y = top; y <= bottom; ++y) put(picture, left, y, yellow), put(picture, right, y, yellow);
}

}  // namespace

void outline(const std::vector<Box>& boxes, const WholeImage& image, io::Image& picture) {
  const double scale = static_cast<double>(picture.width) / (image.width * image.stride);
  for (const Box& box : boxes) {
    const int left = static_cast<int>(box.x * scale), right = static_cast<int>((box.x + box.width) * scale) - 1;
    const int top = static_cast<int>(box.y * scale), bottom = static_cast<int>((box.y + box.height) * scale) - 1;
    for (const int outside : {2, 1, 0, -1})
      border(picture, left - outside, top - outside, right + outside, bottom + outside, outside == 1 || outside == 0);
  }
}

}  // namespace gonio::explain::images
