// What paths from the lights add to one pass of a picture: from many threads in any order, with the same outcome to the
// last bit, because the sums are exact (exact_sum.h). Contributions are rounded to float.
#pragma once
#include <array>
#include <cmath>
#include <mutex>
#include <vector>

#include "render/exact_sum.h"
#include "render/integrator.h"

namespace gonio::render {

class PassSplats final : public Splats {
 public:
  PassSplats(int width_px, int height_px, std::size_t planes)
      : width_px_(width_px),
        height_px_(height_px),
        planes_(planes),
        sums_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * planes * 3) {}

  void add(Vec2 pixel, std::size_t plane, Rgb value) override {
    const double x = std::floor(pixel.x + 0.5), y = std::floor(pixel.y + 0.5);
    if (!(x >= 0 && y >= 0 && x < width_px_ && y < height_px_)) return;
    const std::size_t place =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px_) + static_cast<std::size_t>(x);
    const std::size_t first = (place * planes_ + plane) * 3;
    const std::lock_guard lock(locks_[place % locks_.size()]);
    sums_[first].add(static_cast<float>(value.x));
    sums_[first + 1].add(static_cast<float>(value.y));
    sums_[first + 2].add(static_cast<float>(value.z));
  }

  Rgb value(std::size_t pixel, std::size_t plane) const {
    const std::size_t first = (pixel * planes_ + plane) * 3;
    return {sums_[first].value(), sums_[first + 1].value(), sums_[first + 2].value()};
  }

 private:
  int width_px_, height_px_;
  std::size_t planes_;
  std::vector<ExactSum> sums_;
  std::array<std::mutex, 256> locks_;
};

}  // namespace gonio::render
