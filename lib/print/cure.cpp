// See cure.h.
#include "print/cure.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "print/mechanisms/print_overcure.h"

namespace gonio::print {

Cure::Cure(const Printer& printer, const PixelBox& box, int samples)
    : printer_(printer), box_(box), samples_(std::max(1, samples)), threshold_(printer.growth.threshold()) {
  const int wide = box.x_end - box.x_begin, high = box.y_end - box.y_begin;
  const PixelGrid grid = printer.grid();
  surface_.width = wide * samples_, surface_.height = high * samples_;
  surface_.step_m = {grid.pixel_m.x / samples_, grid.pixel_m.y / samples_};
  surface_.first_m = {grid.corner_m.x + box.x_begin * grid.pixel_m.x + surface_.step_m.x / 2,
                      grid.corner_m.y + box.y_begin * grid.pixel_m.y + surface_.step_m.y / 2};
  const auto points = static_cast<std::size_t>(surface_.width) * static_cast<std::size_t>(surface_.height);
  surface_.top_m.assign(points, std::numeric_limits<float>::quiet_NaN());
  surface_.underside_m = surface_.floor_m = surface_.ceiling_m = surface_.top_m;
  total_.assign(points, 0);
  const bool spreads = !printer.bleed.none();
  for (int j = 0; j < (spreads ? samples_ : 1); ++j)
    for (int i = 0; i < (spreads ? samples_ : 1); ++i)
      spreads_.emplace_back(printer.bleed, grid.pixel_m, wide, high,
                            spreads ? Vec2{(i + 0.5) / samples_ - 0.5, (j + 0.5) / samples_ - 0.5} : Vec2{0, 0});
}

void Cure::settle(std::size_t point, double own, double bottom_m, double top_m, double kept) {
  const double layer_m = top_m - bottom_m, all = own + kept * static_cast<double>(total_[point]);
  total_[point] = static_cast<float>(all);
  if (threshold_ > 0 && !(all > threshold_)) return;
  float &top = surface_.top_m[point], &under = surface_.underside_m[point];
  const bool covered = std::isfinite(top), hangs = covered && own <= threshold_;
  if (covered && !hangs && static_cast<double>(top) >= top_m) {  // its height is not seen
    under = static_cast<float>(bottom_m);
    return;
  }
  const double height_m = std::min(printer_.growth.height_m(all, layer_m), layer_m);
  if (!(height_m > 0)) return;
  if (!hangs && !(static_cast<double>(top) >= bottom_m + height_m)) {
    top = static_cast<float>(bottom_m + height_m);
    surface_.floor_m[point] = static_cast<float>(bottom_m), surface_.ceiling_m[point] = static_cast<float>(top_m);
  }
  under = static_cast<float>(hangs ? top_m - height_m : bottom_m);
}

void Cure::add(std::span<const float> light, double bottom_m, double top_m) {
  const double kept = above_m_ > 0 ? equation::print_overcure(above_m_, printer_.overcure_m.value_or(0)) : 0;
  above_m_ = top_m - bottom_m;
  const int wide = box_.x_end - box_.x_begin;
  std::vector<float> clean(light.begin(), light.end());
  for (float& value : clean)
    if (!std::isfinite(value)) value = 0;
  std::vector<std::vector<float>> spread(spreads_.size(), std::vector<float>(clean.size()));
  for (std::size_t s = 0; s < spreads_.size(); ++s) spreads_[s](clean, spread[s]);
  parallel_for(0, static_cast<std::size_t>(surface_.height), [&](std::size_t y) {
    const int j = static_cast<int>(y) % samples_;
    const std::size_t row = y / static_cast<std::size_t>(samples_) * static_cast<std::size_t>(wide);
    for (int x = 0; x < surface_.width; ++x) {
      const std::size_t of = spreads_.size() == 1 ? 0 : static_cast<std::size_t>(j * samples_ + x % samples_);
      const double own = static_cast<double>(spread[of][row + static_cast<std::size_t>(x / samples_)]);
      settle(y * static_cast<std::size_t>(surface_.width) + static_cast<std::size_t>(x), own, bottom_m, top_m, kept);
    }
  });
}

CuredSurface cured(const Printer& printer, const PixelBox& box, const std::vector<std::vector<float>>& layers,
                   double bottom_m, int samples) {
  Cure cure(printer, box, samples);
  std::vector<double> bottoms{bottom_m};
  for (std::size_t k = 0; k < layers.size(); ++k) bottoms.push_back(bottoms.back() + printer.thickness_m(k));
  for (std::size_t k = layers.size(); k-- > 0;) cure.add(layers[k], bottoms[k], bottoms[k + 1]);
  return cure.surface();
}

}  // namespace gonio::print
