// See screen_picture.h.
#include "glass/refine/screen_picture.h"

#include <algorithm>
#include <cmath>

#include "geom/cubic_weights.h"

namespace gonio::glass {
namespace {

constexpr int levels = 6;  // blurs of 1 to 32 px

// Convolved along one axis with a Gaussian; zero beyond the borders.
void blur_along(std::vector<double>& picture, int width, int height, bool along_rows, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> kernel;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) kernel.push_back(std::exp(-k * k / (2 * sigma * sigma))), sum += kernel.back();
  const std::vector<double> from = picture;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double value = 0;
      for (int k = -reach; k <= reach; ++k) {
        const int i = along_rows ? x + k : x, j = along_rows ? y : y + k;
        if (i >= 0 && i < width && j >= 0 && j < height)
          value += kernel[static_cast<std::size_t>(k + reach)] * from[static_cast<std::size_t>(j * width + i)];
      }
      picture[static_cast<std::size_t>(y * width + x)] = value / sum;
    }
}

std::vector<std::vector<double>> pyramid(std::vector<double> picture, int width, int height) {
  std::vector<std::vector<double>> all;
  for (int level = 0; level < levels; ++level) {
    const double sigma = level == 0 ? 1 : std::sqrt(3.0) * std::pow(2, level - 1);  // to twice that of before
    blur_along(picture, width, height, true, sigma);
    blur_along(picture, width, height, false, sigma);
    all.push_back(picture);
  }
  return all;
}

}  // namespace

ScreenPicture::ScreenPicture(const light::Panel& panel, std::vector<double> luminance, int columns, int rows,
                             double exponent)
    : panel_(panel), columns_(columns), rows_(rows), exponent_(exponent) {
  for (int factor = 2; columns_ > 160; ++factor) {  // means of blocks
    if (columns / factor > 160) continue;
    columns_ = columns / factor, rows_ = rows / factor;
    std::vector<double> small(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int y = 0; y < rows_ * factor; ++y)
      for (int x = 0; x < columns_ * factor; ++x)
        small[static_cast<std::size_t>(y / factor * columns_ + x / factor)] +=
            luminance[static_cast<std::size_t>(y * columns + x)] / (factor * factor);
    luminance = std::move(small);
  }
  margin_ = 48;
  const int width = columns_ + 2 * margin_, height = rows_ + 2 * margin_;
  std::vector<double> wide(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)), squares;
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const double v = luminance[static_cast<std::size_t>(y * columns_ + x)];
      wide[static_cast<std::size_t>((y + margin_) * width + x + margin_)] = v;
      mean_ += v / (columns_ * rows_);
    }
  for (const double v : wide) squares.push_back(v * v);
  first_ = std::make_shared<Pyramid>(pyramid(std::move(wide), width, height));
  second_ = std::make_shared<Pyramid>(pyramid(std::move(squares), width, height));
}

ScreenPicture ScreenPicture::scaled(Vec3 low, double cell) const {
  ScreenPicture other = *this;
  other.panel_.centre_m = (panel_.centre_m - low) / cell;
  other.panel_.width_m /= cell, other.panel_.height_m /= cell;
  return other;
}

// Cubic within a level, linear between levels.
double ScreenPicture::lookup(const std::vector<std::vector<double>>& all, Vec2 place, double level) const {
  const int width = columns_ + 2 * margin_, height = rows_ + 2 * margin_;
  const double x = place.x - 0.5 + margin_, y = place.y - 0.5 + margin_;
  if (!(x > 1 && y > 1 && x < width - 3 && y < height - 3)) return 0;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const auto wx = cubic_weights(x - i), wy = cubic_weights(y - j);
  const double at = std::clamp(level, 0.0, levels - 1.0);
  const int low = std::min(static_cast<int>(at), levels - 2);
  double sum = 0;
  for (int k = 0; k < 2; ++k) {
    const std::vector<double>& picture = all[static_cast<std::size_t>(low + k)];
    double value = 0;
    for (int b = 0; b < 4; ++b)
      for (int a = 0; a < 4; ++a)
        value += wx[static_cast<std::size_t>(a)] * wy[static_cast<std::size_t>(b)] *
                 picture[static_cast<std::size_t>((j + b - 1) * width + i + a - 1)];
    sum += value * (k == 0 ? 1 - (at - low) : at - low);
  }
  return sum;
}

std::optional<ScreenPicture::Look> ScreenPicture::look(Vec3 origin, Vec3 direction, double blur_px) const {
  const double towards = -dot(direction, panel_.frame.n);
  const double distance = dot(origin - panel_.centre_m, panel_.frame.n) / towards;
  if (!(towards > 1e-6) || !(distance > 0)) return {};
  const Vec3 met = origin + direction * distance - panel_.centre_m;
  Look look;
  look.place_px = {(dot(met, panel_.frame.t) / panel_.width_m + 0.5) * columns_,
                   (0.5 - dot(met, panel_.frame.b) / panel_.height_m) * rows_};
  const double level = std::log2(std::max(blur_px, 1.0)), fading = std::pow(towards, exponent_ - 1);
  look.mean = lookup(*first_, look.place_px, level) * fading;
  look.variance = std::max(0.0, lookup(*second_, look.place_px, level) * fading * fading - look.mean * look.mean);
  return look;
}

}  // namespace gonio::glass
