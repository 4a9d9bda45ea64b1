// See pixel_radiance.h.
#include "explain/stacks/pixel_radiance.h"

#include <algorithm>

namespace gonio::explain::stacks {
namespace {

double time_of(const StackImage& image) {
  return image.exposure_s * image.gain;
}

}  // namespace

PixelRadiances::PixelRadiances(const Stack& stack, const ReadingNoise& noise, double clear)
    : stack_(stack), noise_(noise), clear_(clear) {
  found_.resize(stack.images[0].picture.data.size());
  looked_.resize(found_.size());
}

const PixelRadiance& PixelRadiances::at(int x, int y, int channel) {
  const std::size_t i = stack_.images[0].picture.index(x, y, channel);
  if (!looked_[i]) found_[i] = over_all_but(stack_.images.size(), i, channel), looked_[i] = 1;
  return found_[i];
}

PixelRadiance PixelRadiances::without(std::size_t image, int x, int y, int channel) const {
  return over_all_but(image, stack_.images[0].picture.index(x, y, channel), channel);
}

bool PixelRadiances::tells(std::size_t image, std::size_t i) const {
  const StackImage& of = stack_.images[image];
  return of.counts[i] != 0 && of.picture.data[i] < clear_ * stack_.full_scale;
}

PixelRadiance PixelRadiances::over_all_but(std::size_t left_out, std::size_t i, int channel) const {
  double light = 0, time = 0, top = 0, bottom = 0;
  for (std::size_t g = 0; g < stack_.images.size(); ++g) {
    if (g == left_out || !tells(g, i)) continue;
    light += stack_.linear(channel, stack_.images[g].picture.data[i]), time += time_of(stack_.images[g]);
  }
  if (!(time > 0)) return {};
  for (std::size_t g = 0; g < stack_.images.size(); ++g) {
    if (g == left_out || !tells(g, i)) continue;
    const double t = time_of(stack_.images[g]), v = stack_.reading(channel, std::max(0.0, light / time * t));
    const double sigma = noise_.sigma(g, v);
    const double spread = 0.5 * (stack_.linear(channel, v + sigma) - stack_.linear(channel, std::max(0.0, v - sigma)));
    const double weight = 1 / (spread * spread + 1e-30);
    top += weight * t * stack_.linear(channel, stack_.images[g].picture.data[i]), bottom += weight * t * t;
  }
  return {top / bottom, 1 / bottom};
}

double sum_of_squared_readings(const Stack& stack) {
  double sum = 0;
  for (const StackImage& image : stack.images)
    for (std::size_t i = 0; i < image.counts.size(); ++i)
      if (image.counts[i])
        sum += std::pow(stack.linear(static_cast<int>(i % stack.channels.size()), image.picture.data[i]), 2);
  return sum;
}

}  // namespace gonio::explain::stacks
