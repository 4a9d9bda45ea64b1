// See patterns.h.
#include "glass/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "optics/colour.h"
#include "relief/sparse_convolution.h"

namespace gonio::glass {
namespace {

constexpr int width = 160, height = 90;
constexpr std::array names{"white", "stripes", "checker", "dots", "ramp", "clouds"};

Rgb any_colour(Random& random) {
  return {random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)};
}

// Of the place in pixels, 0: the first colour, 1: the second.
std::function<double(double, double)> share_of(const std::string& pattern, Random& random) {
  const double period = random.uniform(8, 32), angle = random.uniform(0, pi), c = std::cos(angle), s = std::sin(angle);
  if (pattern == "white") return [](double, double) { return 0.0; };
  if (pattern == "stripes")
    return [=](double x, double y) { return std::fmod(std::floor((x * c + y * s) / period) + 1e6, 2); };
  if (pattern == "checker")
    return [=](double x, double y) {
      return std::fmod(std::floor((x * c + y * s) / period) + std::floor((y * c - x * s) / period) + 1e6, 2);
    };
  if (pattern == "dots")
    return [=](double x, double y) {
      const double u = (x * c + y * s) / period, v = (y * c - x * s) / period;
      return std::hypot(u - std::round(u), v - std::round(v)) < 0.3 ? 1.0 : 0.0;
    };
  if (pattern == "ramp")
    return [=](double x, double y) {
      return std::clamp(0.5 + ((x - width / 2.0) * c + (y - height / 2.0) * s) / width, 0.0, 1.0);
    };
  if (pattern == "clouds") {
    const double far = random.uniform(0, 100);
    return [=](double x, double y) { return relief::published_noise_grey({x / period, y / period, far}, 4); };
  }
  throw Error(Exit::internal, pattern, "is no pattern of a screen");
}

}  // namespace

std::span<const char* const> pattern_names() {
  return names;
}

io::Image screen_picture(const std::string& pattern, Random& random) {
  const Rgb one = pattern == "white" ? Rgb{1, 1, 1} : any_colour(random);
  const Rgb two = random.uniform() < 0.5 ? Rgb{0.02, 0.02, 0.02} : any_colour(random);
  const auto share = share_of(pattern, random);
  io::Image picture(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgb colour = one + (two - one) * share(x, y);
      for (int k = 0; k < 3; ++k) picture.at(x, y, k) = static_cast<float>(colour[k]);
    }
  return picture;
}

io::Image room(Random& random) {
  constexpr int columns = 128, rows = 64;
  io::Image picture(columns, rows, {"R", "G", "B"});
  const Rgb wall = any_colour(random) * 0.15, ceiling = Rgb{0.25, 0.25, 0.25} * random.uniform(0.5, 1),
            floor = any_colour(random) * 0.08;
  struct Patch {
    double azimuth, elevation, half_width, half_height;
    Rgb radiance;
  };
  std::vector<Patch> patches;
  for (std::uint32_t i = 1 + random.below(4); i > 0; --i) {  // windows
    const Rgb light = Rgb{1, 0.97, 0.92} * random.uniform(1.5, 6);
    patches.push_back(
        {random.uniform(0, 360), random.uniform(15, 45), random.uniform(6, 20), random.uniform(8, 20), light});
  }
  for (std::uint32_t i = random.below(4); i > 0; --i) {  // tubes under the ceiling
    const Rgb light = Rgb{0.95, 1, 0.98} * random.uniform(4, 12);
    patches.push_back(
        {random.uniform(0, 360), random.uniform(55, 75), random.uniform(10, 25), random.uniform(2, 4), light});
  }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double elevation = 90 - 180 * (y + 0.5) / rows, azimuth = 360 * (x + 0.5) / columns;
      Rgb radiance = elevation > 50 ? ceiling : elevation > -20 ? wall : floor;
      for (const Patch& p : patches) {
        const double away = std::abs(std::remainder(azimuth - p.azimuth, 360));
        if (away < p.half_width && std::abs(elevation - p.elevation) < p.half_height) radiance = p.radiance;
      }
      for (int k = 0; k < 3; ++k) picture.at(x, y, k) = static_cast<float>(radiance[k]);
    }
  return picture;
}

}  // namespace gonio::glass
