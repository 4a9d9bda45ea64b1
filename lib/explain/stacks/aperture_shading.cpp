// See aperture_shading.h.
#include "explain/stacks/aperture_shading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "scene/mechanisms/optics_lens_shading.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr std::size_t rings = 24, least_in_ring = 8;
constexpr double most_pixels = 40000;

struct Ring {
  double radius = 0, log_ratio = 0, weight = 0;
};
struct Profile {  // of one aperture, beside the widest
  double f_number = 0;
  std::vector<Ring> rings;
};

// Light at a pixel through each aperture: all readings over all time.
std::map<double, double> light_at(const Stack& stack, std::size_t i, int channel) {
  std::map<double, std::pair<double, double>> sums;
  for (const StackImage& image : stack.images) {
    if (!image.counts[i]) continue;
    auto& [light, time] = sums[image.f_number];
    light += stack.linear(channel, image.picture.data[i]), time += image.exposure_s * image.gain;
  }
  std::map<double, double> lights;
  for (const auto& [f, sum] : sums)
    if (sum.first > 0) lights[f] = sum.first / sum.second;
  return lights;
}

double widest_of(const Stack& stack) {
  return std::ranges::min_element(stack.images, {}, &StackImage::f_number)->f_number;
}

std::vector<Profile> profiles_of(const Stack& stack) {
  const double half = 0.5 * stack.width(), corner = std::hypot(1.0, double(stack.height()) / stack.width());
  const int channels = static_cast<int>(stack.channels.size());
  const double pixels = static_cast<double>(stack.width()) * stack.height();
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / most_pixels)))) | 1;  // all colours
  const double widest = widest_of(stack);
  std::map<double, std::vector<std::vector<double>>> ratios;
  for (int y = 0; y < stack.height(); y += stride)
    for (int x = 0; x < stack.width(); x += stride)
      for (int c = 0; c < channels; ++c) {
        const std::map<double, double> lights = light_at(stack, stack.images[0].picture.index(x, y, c), c);
        if (!lights.contains(widest)) continue;
        const double radius = std::hypot(x + 0.5 - half, y + 0.5 - 0.5 * stack.height()) / half;
        const auto ring = std::min(rings - 1, static_cast<std::size_t>(radius / corner * rings));
        for (const auto& [f, light] : lights) {
          if (f == widest) continue;
          ratios[f].resize(rings);
          ratios[f][ring].push_back(std::log(lights.at(widest) / light));
        }
      }
  std::vector<Profile> profiles;
  for (auto& [f, of] : ratios) {
    profiles.push_back({f, {}});
    for (std::size_t ring = 0; ring < rings; ++ring)
      if (of[ring].size() >= least_in_ring)
        profiles.back().rings.push_back({(static_cast<double>(ring) + 0.5) / rings * corner, stats::median(of[ring]),
                                         std::sqrt(static_cast<double>(of[ring].size()))});
  }
  return profiles;
}

// What is left of one aperture's rings, less what it passes at the centre.
double left_of(const Profile& profile, double widest, double rim, double shift) {
  double sum = 0, of_square = 0, weight = 0;
  for (const Ring& ring : profile.rings) {
    const double wide = equation::optics_lens_shading(rim, shift, widest, ring.radius),
                 narrow = equation::optics_lens_shading(rim, shift, profile.f_number, ring.radius);
    if (!(wide > 0 && narrow > 0)) return std::numeric_limits<double>::infinity();
    const double left = ring.log_ratio - std::log(wide / narrow);
    sum += ring.weight * left, of_square += ring.weight * left * left, weight += ring.weight;
  }
  return weight > 0 ? of_square - sum * sum / weight : 0;
}

}  // namespace

ApertureShading aperture_shading(const Stack& stack) {
  const double widest = widest_of(stack);
  const std::vector<Profile> profiles = profiles_of(stack);
  ApertureShading best{0, widest};
  double least = std::numeric_limits<double>::infinity();
  for (int n = -12; n <= 24; ++n)
    for (int k = 0; k <= 50; ++k) {
      const double rim = widest * std::pow(2.0, n / 12.0), shift = 0.03 * k;
      double left = 0;
      for (const Profile& profile : profiles) left += left_of(profile, widest, rim, shift);
      if (left < least) least = left, best = {shift, rim};
    }
  return best;
}

}  // namespace gonio::explain::stacks
