// What a screen shows, seen by rays that are not known to the last digit: the mean of its picture round a place, under
// a Gaussian of any width, and the variance that the picture has there. Where the picture varies within the width, a
// reading says less; that is what coarse to fine means here.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "light/light.h"
#include "light/panel.h"
#include "manifest/sections/forward.h"

namespace gonio::glass {

// Radiance as a monochrome sensor has it (luminance); dark round the picture. Lengths as the panel's.
class ScreenPicture {
 public:
  // Of the light's picture, brought to at most 160 columns. `panel` in the frame and unit of whoever asks.
  ScreenPicture(const light::Panel& panel, std::vector<double> luminance, int columns, int rows, double exponent);

  struct Look {
    double mean = 0, variance = 0;
    Vec2 place_px{};  // columns from the left edge, rows from the top
  };
  // By a ray that comes from `origin` along `direction`; nothing where it goes away from the screen's plane.
  std::optional<Look> look(Vec3 origin, Vec3 direction, double blur_px) const;
  // The same in cell coordinates: a point p becomes (p - low) / cell.
  ScreenPicture scaled(Vec3 low, double cell) const;
  const light::Panel& panel() const { return panel_; }
  double mean_luminance() const { return mean_; }

 private:
  double lookup(const std::vector<std::vector<double>>& levels, Vec2 place_px, double level) const;

  light::Panel panel_;
  int columns_, rows_, margin_;
  double exponent_, mean_ = 0;
  using Pyramid = std::vector<std::vector<double>>;
  std::shared_ptr<const Pyramid> first_, second_;  // mean and mean square at blurs of 1, 2, 4 ... px
};

}  // namespace gonio::glass
