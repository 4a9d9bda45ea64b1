#include "render/virtual_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "render/image_seed.h"

namespace gonio::render {
namespace {

// Knuth's product of uniforms; beyond 50 expected events the rounded normal, whose third moment differs by less than a
// seventh.
double poisson(double expected, Random& random) {
  if (!(expected > 0)) return 0;
  if (expected > 50) return std::max(0.0, std::round(expected + std::sqrt(expected) * random.normal()));
  double product = random.uniform();
  int events = 0;
  for (const double limit = std::exp(-expected); product > limit; ++events) product *= random.uniform();
  return events;
}

}  // namespace

io::Image recorded(const io::Image& rendered, const manifest::Noise& noise, const std::string& image_id,
                   std::uint64_t seed) {
  const std::uint64_t own_seed = seed_of(seed ^ 0x73656e736f72u, image_id);  // not the numbers that made the rendering
  io::Image image(rendered.width, rendered.height, {"R", "G", "B"});
  const std::array<int, 3> from = {rendered.channel("R"), rendered.channel("G"), rendered.channel("B")};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Random random(own_seed, static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(image.width) +
                                  static_cast<std::uint64_t>(x));
      for (int c = 0; c < 3; ++c) {
        const double v = rendered.at(x, y, from[static_cast<std::size_t>(c)]);
        const double shot = noise.gain > 0 ? poisson(v * noise.gain, random) / noise.gain : v;
        image.at(x, y, c) = static_cast<float>(shot + noise.read * random.normal());
      }
    }
  return image;
}

}  // namespace gonio::render
