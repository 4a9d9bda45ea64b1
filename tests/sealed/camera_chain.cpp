#include "sealed/camera_chain.h"

#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::sealed {
namespace {

std::size_t at(int x, int y, int width) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
}

// Two sweeps of a recursive exponential kernel, there and back, along rows and columns: tails of an old lens.
Numbers spread(const Numbers& rgb, int width, int height, double reach_px) {
  Numbers out = rgb;
  const double keep = std::exp(-1 / reach_px);
  const auto sweep = [&](std::size_t first, std::size_t stride, int count) {
    for (int way = 0; way < 2; ++way) {
      double state = out[way == 0 ? first : first + stride * static_cast<std::size_t>(count - 1)];
      for (int k = 0; k < count; ++k) {
        double& v = out[first + stride * static_cast<std::size_t>(way == 0 ? k : count - 1 - k)];
        state = keep * state + (1 - keep) * v;
        v = state;
      }
    }
  };
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < height; ++y) sweep(at(0, y, width) + c, 3, width);
    for (int x = 0; x < width; ++x) sweep(at(x, 0, width) + c, 3 * static_cast<std::size_t>(width), height);
  }
  return out;
}

void through_lens(Numbers& rgb, int width, int height, const Sizes& sizes) {
  if (const double share = size_of(sizes, "veiling glare"); share > 0) {
    const Numbers wide = spread(rgb, width, height, 2.0 * width);
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] += share * (wide[i] - rgb[i]);
  }
  const double falloff = size_of(sizes, "vignetting");
  if (falloff == 0) return;
  const double tangent2 = 1 / std::sqrt(1 - falloff) - 1;  // cos^4 = 1 - falloff half a width from the centre
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (x - 0.5 * (width - 1)) / (0.5 * width), v = (y - 0.5 * (height - 1)) / (0.5 * width);
      const double cos2 = 1 / (1 + tangent2 * (u * u + v * v));
      for (std::size_t c = 0; c < 3; ++c) rgb[at(x, y, width) + c] *= cos2 * cos2;
    }
}

double poisson(double mean, Random& random) {
  if (mean > 60) return std::max(0.0, std::round(mean + std::sqrt(mean) * random.normal()));
  double count = 0;
  for (double p = std::exp(-mean), product = random.uniform(); product > p; product *= random.uniform()) ++count;
  return count;
}

}  // namespace

double size_of(const Sizes& sizes, const std::string& name, std::size_t part) {
  const auto found = sizes.find(name);
  return found == sizes.end() ? 0 : found->second[part];
}

void through_camera(Numbers& rgb, int width, int height, const Sizes& sizes, std::size_t picture, double white) {
  through_lens(rgb, width, height, sizes);
  const double mix = size_of(sizes, "crosstalk"), swing = size_of(sizes, "mains ripple"),
               bend = size_of(sizes, "bent response"), offset = size_of(sizes, "black offset") * white,
               uneven = size_of(sizes, "uneven pixels"), full = (1 - size_of(sizes, "saturation")) * white,
               columns = size_of(sizes, "uneven columns");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double* p = &rgb[at(x, y, width)];
      const double sum = p[0] + p[1] + p[2];
      const double mains = 1 + swing * std::sin(2 * pi * y / 37.0 + 2.4 * static_cast<double>(picture));
      for (int c = 0; c < 3; ++c) {
        double v = (1 - 3 * mix) * p[c] + mix * sum;
        if (uneven > 0) v *= 1 + uneven * Random(0x70726e75u, at(x, y, width) + static_cast<std::size_t>(c)).normal();
        v *= mains * (1 + columns * std::sin(2 * pi * x / 11.0));
        if (bend != 0) v = white / (2 * bend) * (1 - std::exp(-2 * bend * v / white));
        p[c] = std::min(v + offset, size_of(sizes, "saturation") > 0 ? full : 1e300);
      }
    }
}

double noise_sigma(const Sensor& s, double value) {
  return std::sqrt(std::max(value, 0.0) / s.gain + s.read * s.read);
}

void expose(const Sensor& s, Numbers& values, std::size_t per_picture, Random& random) {
  const double step = 1.5 * s.white / 16384;
  for (std::size_t i = 0; i < values.size(); ++i) {
    Random pixel(s.seed, i % per_picture);
    const double v = std::max(0.0, values[i]) * (1 + s.pattern * pixel.normal());
    const double read = poisson(v * s.gain, random) / s.gain + s.read * random.normal() + std::min(0.0, values[i]);
    values[i] = std::round(read / step + random.uniform() - 0.5) * step;
  }
}

}  // namespace gonio::sealed
