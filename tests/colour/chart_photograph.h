// Rooms that charts are photographed in, and poses, for tests.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "colour/chart_specimen.h"

namespace gonio::colour {

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

// Forty things of any size and colour, in front of and behind each other.
inline std::function<Rgb(double, double)> cluttered_room(std::uint64_t seed, int width, int height) {
  Random random(seed);
  return [blobs = room(random, width, height)](double x, double y) { return room_at(blobs, x, y); };
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
