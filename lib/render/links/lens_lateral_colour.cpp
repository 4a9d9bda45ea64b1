// lens.lateral-colour: red and blue of a rendered picture, taken from where green shows what they show. Between pixels
// by cubic convolution (geom/cubic_weights.h).
#include "camera/mechanisms/lens_lateral_colour.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geom/cubic_weights.h"
#include "render/link.h"

namespace gonio::mechanism {
const Mechanism& lens_lateral_colour();
}

namespace gonio::render::links {
namespace {

double between_pixels(const io::Image& picture, Vec2 at, int channel) {
  const double x = std::floor(at.x), y = std::floor(at.y);
  const std::array<double, 4> across = cubic_weights(at.x - x), down = cubic_weights(at.y - y);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += across[static_cast<std::size_t>(i)] * down[static_cast<std::size_t>(j)] *
             picture.at(std::clamp(static_cast<int>(x) - 1 + i, 0, picture.width - 1),
                        std::clamp(static_cast<int>(y) - 1 + j, 0, picture.height - 1), channel);
  return sum;
}

OnPicture part_colours(std::span<const double> p, const camera::CameraModel& camera) {
  return [amounts = std::vector<double>(p.begin(), p.end()), lens = camera.intrinsics()](io::Image& image) {
    const io::Image green = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (const int c : {0, 2}) {
          const Vec2 pixel{static_cast<double>(x), static_cast<double>(y)};
          const Vec2 at = equation::lens_lateral_colour_pixel(lens, amounts, pixel, static_cast<std::size_t>(c));
          image.at(x, y, c) = static_cast<float>(between_pixels(green, at, c));
        }
  };
}

}  // namespace

const Link& lens_lateral_colour() {
  static const Link link{
      .mechanism = mechanism::lens_lateral_colour, .step = Step::optics, .order = 5, .lens = part_colours};
  return link;
}

}  // namespace gonio::render::links
