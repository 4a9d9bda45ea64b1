// Photographs of charts, simulated for tests: any pose, uneven light, offset, a lens's blur, noise, a cluttered room.
// The camera's matrix is any 3 x 3; what it should see is known exactly.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "colour/chart.h"
#include "colour/chart_pose.h"
#include "io/image.h"

namespace gonio::colour {

struct Photograph {
  ChartPose pose;
  Mat3 camera{{0.55, 0.4, 0.05, 0.15, 0.9, -0.05, 0.02, 0.1, 0.7}};  // camera's R, G, B from XYZ under D50
  double exposure = 1;
  Vec2 gradient{};            // of the light over the chart's width and height
  Rgb offset{};               // of the camera's numbers over exposure
  double shot = 0, read = 0;  // variance of v: shot v + read^2
  double blur_px = 0;         // sigma
  bool clutter = false;
  std::uint64_t seed = 1;
};

namespace simulated {

inline constexpr double frame = 0.06, frame_reflectance = 0.035;  // about the patches, of the chart's width; dark

struct Blob {  // a thing of the room: a turned rectangle of one colour
  Vec2 centre, half, along;
  Rgb colour;
};

inline std::vector<Blob> room(Random& random, int width, int height) {
  std::vector<Blob> blobs;
  for (int i = 0; i < 40; ++i) {
    const double size = std::max(width, height) * (0.02 + 0.2 * std::pow(random.uniform(), 2));
    const double light = std::pow(10.0, random.uniform(-1.7, 0.3));
    const double turn = random.uniform(0, 2 * pi);
    blobs.push_back({{random.uniform(0, width), random.uniform(0, height)},
                     {size, size * random.uniform(0.2, 1)},
                     {std::cos(turn), std::sin(turn)},
                     Rgb{random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)} * light});
  }
  return blobs;
}

inline Rgb room_at(const std::vector<Blob>& blobs, double x, double y) {
  Rgb colour{0.2, 0.2, 0.2};
  for (const Blob& b : blobs) {
    const double c = b.along.x, s = b.along.y, dx = x - b.centre.x, dy = y - b.centre.y;
    if (std::abs(c * dx + s * dy) < b.half.x && std::abs(c * dy - s * dx) < b.half.y) colour = b.colour;
  }
  return colour;
}

inline void blur(io::Image& image, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> weight;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) weight.push_back(std::exp(-k * k / (2 * sigma * sigma))), sum += weight.back();
  for (const bool along : {true, false}) {
    const io::Image before = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) {
          double v = 0;
          for (int k = -reach; k <= reach; ++k)
            v += weight[static_cast<std::size_t>(k + reach)] *
                 before.at(std::clamp(x + (along ? k : 0), 0, image.width - 1),
                           std::clamp(y + (along ? 0 : k), 0, image.height - 1), c);
          image.at(x, y, c) = static_cast<float>(v / sum);
        }
  }
}

}  // namespace simulated

// What even light without noise or offset gives of a patch.
inline Rgb seen(const Photograph& photograph, const Patch& patch) {
  return photograph.camera * patch.xyz * photograph.exposure;
}

inline io::Image photograph_of(const Chart& chart, const Photograph& p, int width, int height) {
  using namespace simulated;
  Random random(p.seed);
  const auto blobs = p.clutter ? room(random, width, height) : std::vector<Blob>{};
  const Mat3 chart_from_image = optics::inverse(p.pose.image_from_chart);
  const Rgb dark = p.camera * (optics::white_d50 * frame_reflectance);
  const auto light_at = [&](double x, double y) {
    const Vec3 h = chart_from_image * Vec3{x, y, 1};
    const Vec2 at{h.x / h.z, h.y / h.z};
    const double down = frame / chart.height_over_width;
    if (!(h.z > 0) || at.x < -frame || at.x > 1 + frame || at.y < -down || at.y > 1 + down) return room_at(blobs, x, y);
    const double light = 1 + dot(p.gradient, at - Vec2{0.5, 0.5});
    for (const Patch& patch : chart.patches)
      if (std::abs(at.x - patch.centre.x) < patch.size.x / 2 && std::abs(at.y - patch.centre.y) < patch.size.y / 2)
        return p.camera * patch.xyz * light;
    return dark * light;
  };
  io::Image image(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Rgb sum;
      for (const double dy : {-0.25, 0.25})
        for (const double dx : {-0.25, 0.25}) sum += light_at(x + dx, y + dy) * 0.25;
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>((sum[c] + p.offset[c]) * p.exposure);
    }
  if (p.blur_px > 0) blur(image, p.blur_px);
  if (p.shot > 0 || p.read > 0)
    for (float& v : image.data)
      v += static_cast<float>(std::sqrt(std::max(0.0, p.shot * v + p.read * p.read)) * random.normal());
  return image;
}

// A pose as a hand gives one: turned any way, tilted by up to 45 degrees, from a sixth of the picture to most of it.
inline ChartPose random_pose(const Chart& chart, int width, int height, std::uint64_t seed) {
  Random random(seed, 7);
  for (;;) {
    // A chart of width 2, seen by a pinhole of 1.3 picture widths.
    const double tilt = random.uniform(0, pi / 4), azimuth = random.uniform(0, 2 * pi),
                 roll = random.uniform(0, 2 * pi), away = random.uniform(2.6, 9);
    const Vec3 n{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)};
    const Basis basis(n);
    const Vec3 right = basis.t * std::cos(roll) + basis.b * std::sin(roll), down = cross(n, right);
    const Vec2 middle{random.uniform(-0.5, 0.5) * away / 1.3, random.uniform(-0.5, 0.5) * away / 1.3};
    std::array<Vec2, 4> corners;
    bool inside = true;
    for (std::size_t i = 0; i < 4; ++i) {
      const double u = i == 1 || i == 2 ? 1 : -1, v = i >= 2 ? 1 : -1;
      const Vec3 at = right * u + down * (v * chart.height_over_width) + Vec3{middle.x, middle.y, away};
      corners[i] = {width * (0.5 + 1.3 * at.x / at.z), height * 0.5 + width * 1.3 * at.y / at.z};
      inside = inside && at.z > 0.5 && corners[i].x > 4 && corners[i].y > 4 && corners[i].x < width - 5 &&
               corners[i].y < height - 5;
    }
    if (inside) return pose_from_corners(corners, "pose");
  }
}

}  // namespace gonio::colour
