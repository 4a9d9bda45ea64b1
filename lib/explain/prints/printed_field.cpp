// See printed_field.h.
#include "explain/prints/printed_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "print/cure.h"
#include "print/mechanisms/print_layer_shift.h"
#include "print/mechanisms/print_membrane.h"
#include "print/mechanisms/print_pixel_tilt.h"

namespace gonio::explain::prints {
namespace {

using Picture = std::vector<float>;
constexpr int knots_per_cell = 4;  // even: maps with a point for each cell are exact

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

// A picture that lies whole cells further; beyond it it is dark.
Picture moved(const Picture& from, int width, int height, int by_x, int by_y) {
  Picture to(from.size(), 0.0f);
  for (int y = std::max(0, by_y); y < std::min(height, height + by_y); ++y)
    for (int x = std::max(0, by_x); x < std::min(width, width + by_x); ++x)
      to[place(x, y, width)] = from[place(x - by_x, y - by_y, width)];
  return to;
}

// Spread has the light in the middle of a cell, and a cell counts as even: its mean is the middle of light that is
// spread a little further, by the variance of a cell. Less where light is spread by less than that.
print::Bleed over_cells(print::Bleed bleed, Vec2 cell_m) {
  bleed.sigma_m = std::hypot(bleed.sigma_m, std::min(bleed.sigma_m, std::sqrt(cell_m.x * cell_m.y / 12)));
  return bleed;
}

// Spreads that differ over the field: light is shared out between a few even ones, so that its variance is right.
class Defocus {
 public:
  Defocus(const Setting& setting, const Sent& sent, Vec2 cell_m, int width, int height)
      : width_(width), height_(height) {
    const print::PixelGrid grid = setting.printer.grid();
    const Vec2 field_m{grid.width_px * grid.pixel_m.x, grid.height_px * grid.pixel_m.y};
    variance_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    double most = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Vec2 at = sent.corner_m - grid.corner_m + Vec2{(x + 0.5) * cell_m.x, (y + 0.5) * cell_m.y};
        const double s = equation::print_pixel_tilt(at, field_m, setting.tilt.x, setting.tilt.y);
        variance_[place(x, y, width)] = s * s;
        most = std::max(most, s);
      }
    for (std::size_t k = 0; k < levels; ++k) {
      const double s = most * static_cast<double>(k) / (levels - 1);
      level_.push_back(s * s);
      spread_.emplace_back(over_cells({s, 0, 0}, cell_m), cell_m, width, height);
    }
  }
  Picture operator()(const Picture& light) const {
    Picture all(light.size(), 0.0f), share(light.size()), spread(light.size());
    for (std::size_t k = 0; k < levels; ++k) {
      for (std::size_t i = 0; i < light.size(); ++i) share[i] = light[i] * static_cast<float>(weight(k, variance_[i]));
      spread_[k](share, spread);
      for (std::size_t i = 0; i < light.size(); ++i) all[i] += spread[i];
    }
    return all;
  }

 private:
  static constexpr std::size_t levels = 5;
  double weight(std::size_t k, double variance) const {
    if (k > 0 && variance < level_[k]) return std::max(0.0, (variance - level_[k - 1]) / (level_[k] - level_[k - 1]));
    if (k + 1 < levels && variance >= level_[k])
      return std::max(0.0, (level_[k + 1] - variance) / (level_[k + 1] - level_[k]));
    return variance >= level_[k] ? 1 : 0;
  }
  int width_, height_;
  std::vector<double> variance_, level_;
  std::vector<print::Spread> spread_;
};

// The integral of a box of this width about 0 under a Gaussian, from the far left to x.
double boxed(double x, double width, double sigma) {
  const auto ramp = [sigma](double u) {
    if (sigma < 1e-4) return std::max(0.0, u);
    const double z = u / sigma;
    return u * 0.5 * std::erfc(-z / std::numbers::sqrt2) +
           sigma * std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  };
  return (ramp(x + width / 2) - ramp(x - width / 2)) / width;
}

// Weights of the cells about each of the knots of a cell: those from `-reach` to `reach` beside the one that it is in.
struct Weights {
  int reach = 0;
  std::array<std::vector<double>, knots_per_cell> of;
  Weights(double width, double sigma) : reach(static_cast<int>(std::ceil(width / 2 + 4 * sigma)) + 1) {
    for (int k = 0; k < knots_per_cell; ++k) {
      const double at = static_cast<double>(k) / knots_per_cell;  // in the cell from 0 to 1
      std::vector<double>& weights = of[static_cast<std::size_t>(k)];
      for (int c = -reach; c <= reach; ++c)
        weights.push_back(boxed(c + 1 - at, width, sigma) - boxed(c - at, width, sigma));
      double all = 0;
      for (const double w : weights) all += w;
      for (double& w : weights) w /= all;
    }
  }
};

Field grown(const Sent& sent, const Setting& setting, const Lights& lights) {
  Field field;
  field.width = sent.wide() * cells_per_pixel, field.height = sent.high() * cells_per_pixel;
  field.corner_m = sent.corner_m;
  field.cell_m = sent.printer.pixel_m * (1.0 / cells_per_pixel);
  print::Printer fine = setting.printer;
  fine.pixel_m = field.cell_m;
  fine.width_px *= cells_per_pixel, fine.height_px *= cells_per_pixel;
  fine.bleed = {};  // which is in the light
  print::Cure cure(fine, {0, 0, field.width, field.height});
  std::vector<double> bottom{0};
  for (std::size_t k = 0; k < lights.size(); ++k) bottom.push_back(bottom.back() + fine.thickness_m(k));
  for (std::size_t k = lights.size(); k-- > 0;) cure.add(lights[k], bottom[k], bottom[k + 1]);
  const print::CuredSurface& surface = cure.surface();
  const auto finite = [](float v) { return std::isfinite(v) ? static_cast<double>(v) : 0.0; };
  for (std::size_t i = 0; i < surface.top_m.size(); ++i) {
    field.floor_m.push_back(finite(surface.floor_m[i])), field.ceiling_m.push_back(finite(surface.ceiling_m[i]));
    const double top = finite(surface.top_m[i]);
    field.top_m.push_back(setting.cut_m > 0 ? equation::print_membrane(top, field.ceiling_m.back(), setting.cut_m)
                                            : top);
  }
  return field;
}

}  // namespace

print::Spread spread_of(const Sent& sent, const print::Bleed& bleed) {
  const Vec2 cell_m = sent.printer.pixel_m * (1.0 / cells_per_pixel);
  return print::Spread(over_cells(bleed, cell_m), cell_m, sent.wide() * cells_per_pixel, sent.high() * cells_per_pixel);
}

Lights lights_of(const Sent& sent, const Setting& setting, const print::Spread& spread) {
  const int width = sent.wide() * cells_per_pixel, height = sent.high() * cells_per_pixel;
  const Vec2 cell_m = sent.printer.pixel_m * (1.0 / cells_per_pixel);
  std::unique_ptr<Defocus> defocus;
  if (setting.tilt.x != 0 || setting.tilt.y != 0)
    defocus = std::make_unique<Defocus>(setting, sent, cell_m, width, height);
  Lights lights;
  for (std::size_t k = 0; k < sent.layers.size(); ++k) {
    const Vec2 by = setting.shifted_from > 0
                        ? equation::print_layer_shift(static_cast<double>(k + 1), setting.shifted_from,
                                                      setting.shift_m.x, setting.shift_m.y)
                        : Vec2{0, 0};
    const bool moves = by.x != 0 || by.y != 0;
    if (k > 0 && !moves && sent.layers[k] == sent.layers[k - 1]) {  // as layers are for the most part
      lights.push_back(lights.back());
      continue;
    }
    Picture light = in_cells(sent.layers[k], sent);
    if (moves)
      light = moved(light, width, height, static_cast<int>(std::lround(by.x / cell_m.x)),
                    static_cast<int>(std::lround(by.y / cell_m.y)));
    if (defocus) light = (*defocus)(light);
    Picture all(light.size());
    spread(light, all);
    lights.push_back(std::move(all));
  }
  return lights;
}

Field printed_field(const Sent& sent, const Setting& setting, const LightsOf& lights_of) {
  if (!(setting.shifted_from > 0)) return grown(sent, setting, *lights_of(setting));
  const Vec2 cell_m = sent.printer.pixel_m * (1.0 / cells_per_pixel);
  const Vec2 by{setting.shift_m.x / cell_m.x, setting.shift_m.y / cell_m.y}, whole{std::floor(by.x), std::floor(by.y)},
      part = by - whole;
  Field field;
  std::vector<double> top_m;
  for (const auto& [x, y] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{0, 1}, std::pair{1, 1}}) {
    const double weight = (x == 0 ? 1 - part.x : part.x) * (y == 0 ? 1 - part.y : part.y);
    if (weight == 0 && !top_m.empty()) continue;
    Setting own = setting;
    own.shift_m = {(whole.x + x) * cell_m.x, (whole.y + y) * cell_m.y};
    Field one = grown(sent, own, *lights_of(own));
    if (top_m.empty()) top_m.assign(one.top_m.size(), 0.0);
    for (std::size_t i = 0; i < top_m.size(); ++i) top_m[i] += weight * one.top_m[i];
    if (field.top_m.empty()) field = std::move(one);
  }
  field.top_m = std::move(top_m);
  return field;
}

Field printed_field(const Sent& sent, const Setting& setting) {
  return printed_field(sent, setting, [&sent](const Setting& own) {
    return std::make_shared<const Lights>(lights_of(sent, own, spread_of(sent, own.printer.bleed)));
  });
}

Seen::Seen(const Field& field, const std::vector<double>& values, Vec2 point_cells, double resolution_cells)
    : width_(field.width * knots_per_cell + 1), height_(field.height * knots_per_cell + 1) {
  const double sigma = std::max(0.0, resolution_cells);
  const Weights along(point_cells.x, sigma), down(point_cells.y, sigma);
  std::vector<double> rows(static_cast<std::size_t>(width_) * static_cast<std::size_t>(field.height));
  for (int y = 0; y < field.height; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::vector<double>& weight = along.of[static_cast<std::size_t>(x % knots_per_cell)];
      double sum = 0;
      for (int c = -along.reach; c <= along.reach; ++c)
        sum += weight[static_cast<std::size_t>(c + along.reach)] *
               values[place(std::clamp(x / knots_per_cell + c, 0, field.width - 1), y, field.width)];
      rows[place(x, y, width_)] = sum;
    }
  knot_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    const std::vector<double>& weight = down.of[static_cast<std::size_t>(y % knots_per_cell)];
    for (int c = -down.reach; c <= down.reach; ++c) {
      const double w = weight[static_cast<std::size_t>(c + down.reach)];
      const int from = std::clamp(y / knots_per_cell + c, 0, field.height - 1);
      if (w == 0) continue;
      for (int x = 0; x < width_; ++x) knot_[place(x, y, width_)] += w * rows[place(x, from, width_)];
    }
  }
}

double Seen::at(double x, double y) const {
  x = std::clamp(x * knots_per_cell, 0.0, width_ - 1.000001),
  y = std::clamp(y * knots_per_cell, 0.0, height_ - 1.000001);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double fx = x - i, fy = y - j;
  const double* k = &knot_[place(i, j, width_)];
  return (1 - fy) * ((1 - fx) * k[0] + fx * k[1]) + fy * ((1 - fx) * k[width_] + fx * k[width_ + 1]);
}

}  // namespace gonio::explain::prints
