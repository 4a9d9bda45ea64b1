// See bleed.h. OpenCV, for its Fourier transforms, stays within this file.
#include "print/bleed.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace gonio::print {
namespace {

double core(double from, double to, double sigma) {  // of a Gaussian about 0
  if (!(sigma > 0)) return from <= 0 && to > 0 ? 1 : 0;
  return (std::erf(to / (sigma * std::numbers::sqrt2)) - std::erf(from / (sigma * std::numbers::sqrt2))) / 2;
}

double corner(double x, double y, double w) {
  return std::atan(x * y / (w * std::sqrt(w * w + x * x + y * y))) / (2 * std::numbers::pi);
}

// A Gaussian over pixels: a product, of so few numbers along each axis that they are summed as they stand.
constexpr int most_direct = 32;  // pixels to either side
constexpr double far = 5.5;      // standard deviations: 4e-8 of the light lies beyond

int reach_of(double sigma_m, double pixel_m, double offset_px) {
  return static_cast<int>(std::ceil(std::min(1e6, far * sigma_m / pixel_m + std::abs(offset_px) + 0.5)));
}

// For cv::sepFilter2D, which correlates: back to front.
cv::Mat weights(int reach, double sigma_m, double pixel_m, double offset_px) {
  cv::Mat row(1, 2 * reach + 1, CV_32F);
  for (int i = -reach; i <= reach; ++i)
    row.at<float>(reach - i) =
        static_cast<float>(core((i + offset_px - 0.5) * pixel_m, (i + offset_px + 0.5) * pixel_m, sigma_m));
  return row;
}

cv::Mat reversed(const cv::Mat& row) {
  cv::Mat back;
  cv::flip(row, back, 1);
  return back;
}

}  // namespace

double Bleed::at(Vec2 offset_m, Vec2 pixel_m) const {
  const double x0 = offset_m.x - pixel_m.x / 2, x1 = offset_m.x + pixel_m.x / 2;
  const double y0 = offset_m.y - pixel_m.y / 2, y1 = offset_m.y + pixel_m.y / 2;
  const double share = tail_m > 0 ? tail_share : 0;
  double light = (1 - share) * core(x0, x1, sigma_m) * core(y0, y1, sigma_m);
  if (share > 0)
    light +=
        share * (corner(x1, y1, tail_m) - corner(x0, y1, tail_m) - corner(x1, y0, tail_m) + corner(x0, y0, tail_m));
  return light;
}

struct Spread::Kernel {
  cv::Mat spectrum;  // packed
  cv::Size size;
  cv::Mat along, down;  // instead: of a core alone
};

Spread::Spread(const Bleed& bleed, Vec2 pixel_m, int width_px, int height_px, Vec2 offset_px)
    : width_(width_px), height_(height_px) {
  if (bleed.none() && offset_px.x == 0 && offset_px.y == 0) return;
  kernel_ = std::make_unique<Kernel>();
  const int reach_x = reach_of(bleed.sigma_m, pixel_m.x, offset_px.x),
            reach_y = reach_of(bleed.sigma_m, pixel_m.y, offset_px.y);
  if (!(bleed.tail_m > 0 && bleed.tail_share > 0) && std::max(reach_x, reach_y) <= most_direct) {
    kernel_->along = weights(reach_x, bleed.sigma_m, pixel_m.x, offset_px.x);
    kernel_->down = weights(reach_y, bleed.sigma_m, pixel_m.y, offset_px.y);
    return;
  }
  // As far as a picture reaches on either side, so that nothing comes round.
  kernel_->size = {cv::getOptimalDFTSize(2 * width_px), cv::getOptimalDFTSize(2 * height_px)};
  cv::Mat kernel(kernel_->size, CV_32F, cv::Scalar(0));
  const auto line = [&](int j) { return kernel.ptr<float>((j + kernel_->size.height) % kernel_->size.height); };
  const bool even_x = offset_px.x == 0, even_y = offset_px.y == 0;  // as much on either side
  for (int j = even_y ? 0 : 1 - height_px; j < height_px; ++j) {
    auto* row = line(j);
    for (int i = even_x ? 0 : 1 - width_px; i < width_px; ++i) {
      const auto light =
          static_cast<float>(bleed.at({(i + offset_px.x) * pixel_m.x, (j + offset_px.y) * pixel_m.y}, pixel_m));
      row[(i + kernel_->size.width) % kernel_->size.width] = light;
      if (even_x && i > 0) row[kernel_->size.width - i] = light;
    }
    if (even_y && j > 0) std::copy_n(row, kernel_->size.width, line(-j));
  }
  cv::dft(kernel, kernel_->spectrum);
}
Spread::~Spread() = default;
Spread::Spread(Spread&&) noexcept = default;

void Spread::filtered(std::span<const float> from, std::span<float> to, bool backwards) const {
  const std::size_t width = static_cast<std::size_t>(width_);
  if (!kernel_) {
    std::copy(from.begin(), from.end(), to.begin());
    return;
  }
  if (!kernel_->along.empty()) {
    cv::Mat field(height_, width_, CV_32F);
    std::ranges::copy(from, field.ptr<float>());
    cv::Mat all(height_, width_, CV_32F, to.data());
    cv::sepFilter2D(field, all, CV_32F, backwards ? reversed(kernel_->along) : kernel_->along,
                    backwards ? reversed(kernel_->down) : kernel_->down, {-1, -1}, 0,
                    cv::BORDER_CONSTANT | cv::BORDER_ISOLATED);
    return;
  }
  cv::Mat field(kernel_->size, CV_32F, cv::Scalar(0));
  for (int y = 0; y < height_; ++y)
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(y * width), width_, field.ptr<float>(y));
  cv::dft(field, field, 0, height_);
  cv::mulSpectrums(field, kernel_->spectrum, field, 0, backwards);
  cv::idft(field, field, cv::DFT_SCALE | cv::DFT_REAL_OUTPUT, height_);
  for (int y = 0; y < height_; ++y)
    std::copy_n(field.ptr<float>(y), width_, to.begin() + static_cast<std::ptrdiff_t>(y * width));
}

void Spread::operator()(std::span<const float> light, std::span<float> spread) const {
  filtered(light, spread, false);
}
void Spread::backwards(std::span<const float> at, std::span<float> slopes) const {
  filtered(at, slopes, true);
}

}  // namespace gonio::print
