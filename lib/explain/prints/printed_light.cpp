// See printed_light.h.
#include "explain/prints/printed_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "print/mechanisms/print_layer_shift.h"
#include "print/mechanisms/print_pixel_tilt.h"

namespace gonio::explain::prints {
namespace {

using Picture = std::vector<float>;

std::size_t place(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

Picture in_cells(const Picture& pixels, const Sent& sent) {
  const int width = sent.wide() * cells_per_pixel, height = sent.high() * cells_per_pixel;
  Picture cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      cells[place(x, y, width)] = pixels[place(x / cells_per_pixel, y / cells_per_pixel, sent.wide())];
  return cells;
}

// Spread has the light in the middle of a cell, and a cell counts as even: its mean is the middle of light that is
// spread a little further, by the variance of a cell. Less where light is spread by less than that.
print::Bleed over_cells(print::Bleed bleed, Vec2 cell_m) {
  bleed.sigma_m = std::hypot(bleed.sigma_m, std::min(bleed.sigma_m, std::sqrt(cell_m.x * cell_m.y / 12)));
  return bleed;
}

// Spreads that differ over the field: along rows by what every cell has, then along columns by what the cell has where
// the light has come to; over the width of a spread they hardly differ. So many different ones as there are levels,
// evenly from none to the widest.
class Defocus {
 public:
  Defocus(const Setting& setting, const Sent& sent)
      : width_(sent.wide() * cells_per_pixel), height_(sent.high() * cells_per_pixel) {
    const print::PixelGrid grid = setting.printer.grid();
    const Vec2 cell_m = sent.cell_m(), field_m{grid.width_px * grid.pixel_m.x, grid.height_px * grid.pixel_m.y};
    std::vector<double> sigma;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const Vec2 at = sent.corner_m - grid.corner_m + Vec2{(x + 0.5) * cell_m.x, (y + 0.5) * cell_m.y};
        sigma.push_back(equation::print_pixel_tilt(at, field_m, setting.tilt.x, setting.tilt.y));
      }
    const double most = std::max(1e-300, *std::ranges::max_element(sigma));
    for (const double s : sigma) level_.push_back(static_cast<std::uint16_t>(std::lround(s / most * levels)));
    for (int k = 0; k <= levels; ++k) {
      const double s = most * k / levels;
      along_.push_back(kernel(s / cell_m.x)), down_.push_back(kernel(s / cell_m.y));
    }
  }
  Picture operator()(const Picture& light) const {
    Picture rows(light.size(), 0.0f), all(light.size(), 0.0f);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const std::size_t from = place(x, y, width_);
        scatter(light[from], along_[level_[from]], x, width_, &rows[place(0, y, width_)], 1);
      }
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const std::size_t from = place(x, y, width_);
        scatter(rows[from], down_[level_[from]], y, height_, &all[place(x, 0, width_)], width_);
      }
    return all;
  }

 private:
  static constexpr int levels = 255;
  // Shares of the cells from `-reach` to `reach`, of light spread by `sigma` cells.
  static std::vector<float> kernel(double sigma) {
    if (!(sigma > 1e-3)) return {1.0f};
    sigma = std::hypot(sigma, std::min(sigma, std::sqrt(1.0 / 12)));
    const int reach = static_cast<int>(std::ceil(4.5 * sigma));
    std::vector<float> shares;
    for (int k = -reach; k <= reach; ++k)
      shares.push_back(static_cast<float>(0.5 * (std::erf((k + 0.5) / (sigma * std::numbers::sqrt2)) -
                                                 std::erf((k - 0.5) / (sigma * std::numbers::sqrt2)))));
    return shares;
  }
  static void scatter(float light, const std::vector<float>& shares, int from, int end, float* line, int stride) {
    if (light == 0) return;
    const int reach = static_cast<int>(shares.size() / 2), first = std::max(0, from - reach),
              last = std::min(end - 1, from + reach);
    const float* share = shares.data() + (first - from + reach);
    float* to = line + static_cast<std::ptrdiff_t>(first) * stride;
    for (int k = first; k <= last; ++k, to += stride) *to += light * *share++;
  }
  int width_, height_;
  std::vector<std::uint16_t> level_;
  std::vector<std::vector<float>> along_, down_;
};

print::Spread spread_of(const Sent& sent, const print::Bleed& bleed) {
  return print::Spread(over_cells(bleed, sent.cell_m()), sent.cell_m(), sent.wide() * cells_per_pixel,
                       sent.high() * cells_per_pixel);
}

// Of every layer, one of the same picture as the one before for the most part.
template <class Make>
Lights of_layers(const Sent& sent, const Make& make) {
  Lights lights;
  for (std::size_t k = 0; k < sent.layers.size(); ++k)
    lights.push_back(k > 0 && sent.layers[k] == sent.layers[k - 1] ? lights.back() : make(k));
  return lights;
}

}  // namespace

Lights tails_of(const Sent& sent, double tail_m) {
  const print::Spread tail = spread_of(sent, {0, 1, tail_m});
  return of_layers(sent, [&](std::size_t k) {
    Picture light = in_cells(sent.layers[k], sent);
    tail(light, light);
    return light;
  });
}

Lights lights_of(const Sent& sent, const Setting& setting, const TailsOf& tails_of) {
  const print::Bleed& bleed = setting.printer.bleed;
  const bool has_tail = bleed.tail_share > 0 && bleed.tail_m > 0;
  if (setting.tilt.x != 0 || setting.tilt.y != 0) {
    const Defocus defocus(setting, sent);
    const print::Spread spread = spread_of(sent, bleed);
    return of_layers(sent, [&](std::size_t k) {
      Picture light = defocus(in_cells(sent.layers[k], sent));
      spread(light, light);
      return light;
    });
  }
  const print::Spread core = spread_of(sent, {bleed.sigma_m, 0, 0});
  const std::shared_ptr<const Lights> tails = has_tail ? tails_of(bleed.tail_m) : nullptr;
  return of_layers(sent, [&](std::size_t k) {
    Picture light = in_cells(sent.layers[k], sent);
    core(light, light);
    const auto share = static_cast<float>(bleed.tail_share);
    for (std::size_t i = 0; has_tail && i < light.size(); ++i)
      light[i] = (1 - share) * light[i] + share * (*tails)[k][i];
    return light;
  });
}

Lights moved(const Lights& lights, const Sent& sent, double shifted_from, int by_x, int by_y) {
  const int width = sent.wide() * cells_per_pixel, height = sent.high() * cells_per_pixel;
  Lights result;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const Vec2 by = equation::print_layer_shift(static_cast<double>(k + 1), shifted_from, by_x, by_y);
    if (by.x == 0 && by.y == 0) {
      result.push_back(lights[k]);
      continue;
    }
    Picture to(lights[k].size(), 0.0f);
    const int first = std::max(0, by_x), count = std::max(0, width - std::abs(by_x));
    for (int y = std::max(0, by_y); y < std::min(height, height + by_y); ++y)
      std::copy_n(lights[k].begin() + static_cast<std::ptrdiff_t>(place(first - by_x, y - by_y, width)), count,
                  to.begin() + static_cast<std::ptrdiff_t>(place(first, y, width)));
    result.push_back(std::move(to));
  }
  return result;
}

}  // namespace gonio::explain::prints
