// Photographs of balls for the detector's tests, by rays: every subpixel's ray is intersected with spheres, discs and
// bars, shaded, blurred as by a lens, averaged over the pixel, and given noise. The camera is its own: a pinhole with
// one radial term, inverted by fixed-point steps.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/random.h"
#include "camera/camera_model.h"
#include "camera/intrinsics.h"
#include "geom/vector.h"
#include "io/grey.h"

namespace gonio::tests {

struct Ball {
  Vec3 centre_m;
  double radius_m = 0.01;
  double albedo = 150;
  double ambient = 0.5;  // share of light from everywhere
  Vec3 lamp{0, 0, -1};   // where the rest comes from
  double gloss = 0;      // height of a highlight
};
struct Disc {  // flat
  Vec3 centre_m, normal;
  double radius_m = 0.01, grey = 200;
};
struct Bar {  // in front of everything: pixels with from <= x cos + y sin <= to
  double turn = 0, from = 0, to = -1, grey = 100;
};
struct Photograph {
  int width = 96, height = 96;
  double focal_px = 2000, cx = 47.5, cy = 47.5, k1 = 0;
  double blur_px = 1, noise = 2;
  std::vector<Ball> balls;
  std::vector<Disc> discs;
  std::vector<Bar> bars;
  std::function<double(double x, double y)> behind = [](double, double) { return 60.0; };
  int fine = 6;  // subpixels a side

  camera::CameraModel camera() const {
    camera::Intrinsics lens;
    lens.fx_px = lens.fy_px = focal_px, lens.cx_px = cx, lens.cy_px = cy;
    lens.distortion[0] = k1;
    return camera::CameraModel(lens, width, height);
  }
  Vec3 ray(double x, double y) const {
    const double u = (x - cx) / focal_px, v = (y - cy) / focal_px;
    double a = u, b = v;
    for (int i = 0; i < (k1 == 0 ? 0 : 12); ++i) {
      const double d = 1 + k1 * (a * a + b * b);
      a = u / d, b = v / d;
    }
    return normalized(Vec3{a, b, 1});
  }
  Vec2 pixel(Vec3 p) const {
    const double a = p.x / p.z, b = p.y / p.z, d = 1 + k1 * (a * a + b * b);
    return {cx + focal_px * a * d, cy + focal_px * b * d};
  }
};

inline double shade(const Ball& ball, Vec3 ray, double distance) {
  const Vec3 n = (ray * distance - ball.centre_m) / ball.radius_m, lamp = normalized(ball.lamp);
  const Vec3 half = normalized(lamp - ray);
  const double spot = ball.gloss > 0 ? ball.gloss * std::pow(std::max(0.0, dot(n, half)), 60) : 0;
  return ball.albedo * (ball.ambient + (1 - ball.ambient) * std::max(0.0, dot(n, lamp))) + spot;
}

inline double radiance(const Photograph& photo, double x, double y) {
  for (const Bar& bar : photo.bars) {
    const double s = x * std::cos(bar.turn) + y * std::sin(bar.turn);
    if (s >= bar.from && s <= bar.to) return bar.grey;
  }
  const Vec3 ray = photo.ray(x, y);
  double nearest = 1e30, grey = photo.behind(x, y);
  for (const Ball& ball : photo.balls) {
    const double along = dot(ray, ball.centre_m);
    const double square = along * along - dot(ball.centre_m, ball.centre_m) + ball.radius_m * ball.radius_m;
    if (square < 0 || along - std::sqrt(square) > nearest) continue;
    nearest = along - std::sqrt(square);
    grey = shade(ball, ray, nearest);
  }
  for (const Disc& disc : photo.discs) {
    const double s = dot(disc.centre_m, disc.normal) / dot(ray, disc.normal);
    if (s > 0 && s < nearest && norm(ray * s - disc.centre_m) < disc.radius_m) nearest = s, grey = disc.grey;
  }
  return grey;
}

// Blurred in rows, then in columns; beyond the border the picture goes on as it ends.
inline void blur_lines(std::vector<double>& grey, int width, int height, double sigma) {
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> kernel, line(static_cast<std::size_t>(std::max(width, height)));
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
    kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma))), sum += kernel.back();
  for (const bool rows : {true, false}) {
    const int lines = rows ? height : width, length = rows ? width : height;
    for (int l = 0; l < lines; ++l) {
      double* const first = grey.data() + (rows ? static_cast<std::size_t>(l) * width : static_cast<std::size_t>(l));
      const int stride = rows ? 1 : width;
      for (int i = 0; i < length; ++i) line[i] = first[static_cast<std::size_t>(i) * stride];
      for (int i = 0; i < length; ++i) {
        double value = 0;
        for (int k = -reach; k <= reach; ++k) value += kernel[k + reach] * line[std::clamp(i + k, 0, length - 1)];
        first[static_cast<std::size_t>(i) * stride] = value / sum;
      }
    }
  }
}

inline io::GreyImage take(const Photograph& photo, std::uint64_t seed) {
  const int s = photo.fine, margin = static_cast<int>(std::ceil(4 * photo.blur_px)) + 1;
  const int width = (photo.width + 2 * margin) * s, height = (photo.height + 2 * margin) * s;
  std::vector<double> fine(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      fine[static_cast<std::size_t>(y) * width + x] =
          radiance(photo, (x + 0.5) / s - 0.5 - margin, (y + 0.5) / s - 0.5 - margin);
  if (photo.blur_px > 0) blur_lines(fine, width, height, photo.blur_px * s);
  io::GreyImage image;
  image.width = photo.width, image.height = photo.height;
  Random random(seed, 77);
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      double sum = 0;
      for (int i = 0; i < s; ++i)
        for (int j = 0; j < s; ++j)
          sum += fine[static_cast<std::size_t>((y + margin) * s + i) * width + (x + margin) * s + j];
      const double value = sum / (s * s) + photo.noise * random.normal();
      image.bytes.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)));
    }
  return image;
}

}  // namespace gonio::tests
