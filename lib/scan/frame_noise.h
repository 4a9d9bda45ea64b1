// The noise of single readings where nobody stated it, from what must be equal but for noise and for light that the
// scene sends on to itself: two bits, each together with its inverse; the means over the shifts of two numbers of
// periods. That light varies slowly over the picture, and second differences along the rows do not see it.
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "manifest/noise.h"

namespace gonio::scan {

// What must be equal and differs by more, of what white adds and of its noise: something moved.
constexpr double moved_least = 0.1, moved_sigmas = 5;

struct Contradiction {
  float light = 0;       // of the pixel
  float difference = 0;  // with the variance of a single reading
};

// A line in the light, variance = read^2 + light / gain, from medians over pixels of one brightness (of a normal
// distribution the median of |difference| is 0.6745 sigma). No gain where it does not rise.
manifest::Noise noise_of(std::vector<Contradiction> contradictions);

// Second differences along the rows of `value`, which has `unit` times the noise of a single reading, at some of the
// pixels; `light` is their brightness. Pixels that are not a number do not count.
using ValueOf = std::function<float(std::size_t pixel)>;
std::vector<Contradiction> between_neighbours(const ValueOf& value, double unit, const ValueOf& light, int width,
                                              int height);

}  // namespace gonio::scan
