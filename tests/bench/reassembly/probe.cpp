// A room and its reflection in a ball: probe.h.
#include "probe.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "surface/fresnel.h"

namespace gonio::reassembly_experiment {
namespace {

Vec3 direction_of(int x, int y, int width, int height) {
  const double phi = pi - 2 * pi * (x + 0.5) / width, theta = pi * (y + 0.5) / height;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

double soft(double inside, double edge) {  // 1 within, 0 without, over `edge`
  return std::clamp(0.5 + inside / edge, 0.0, 1.0);
}

Vec3 radiance_of(Vec3 d) {
  const double height = 0.5 + 0.5 * d.z, turn = 0.5 + 0.5 * std::sin(std::atan2(d.y, d.x) + 0.6);
  const Vec3 wall{0.32 + 0.12 * turn, 0.34, 0.44 - 0.14 * turn};
  Vec3 sum = wall * (0.25 + 0.9 * height);
  struct Panel {
    double azimuth, elevation, roll;  // degrees; of the middle, and of the panel about it
    Vec3 colour;
  };
  constexpr Panel panels[] = {{-90, 62, 0, {9.5, 9.3, 8.6}},
                              {-160, 40, 80, {9, 9.2, 9}},
                              {-20, 40, 100, {8.6, 9.1, 9.6}},
                              {60, 58, 30, {9.2, 9.2, 9}},
                              {135, 52, -25, {9.4, 9.1, 8.4}}};
  for (const Panel& panel : panels) {
    const double a = panel.azimuth * pi / 180, e = panel.elevation * pi / 180, r = panel.roll * pi / 180;
    const Vec3 middle{std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
    const Vec3 level{-std::sin(a), std::cos(a), 0}, up = cross(middle, level);
    const Vec3 along = level * std::cos(r) + up * std::sin(r), across = cross(middle, along);
    if (dot(d, middle) < 0.2) continue;
    const double s = std::atan2(dot(d, along), dot(d, middle)), t = std::atan2(dot(d, across), dot(d, middle));
    sum += panel.colour * 0.15 * (soft(0.50 - std::abs(s), 0.02) * soft(0.24 - std::abs(t), 0.02));
  }
  return sum;
}

// Bilinear; nothing outside.
bool look_up(const io::Image& picture, Vec2 p, Vec3& value) {
  const double x = std::floor(p.x), y = std::floor(p.y);
  if (!(x >= 0) || !(y >= 0) || x + 1 >= picture.width || y + 1 >= picture.height) return false;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const double u = p.x - x, v = p.y - y;
  double sum[3];
  const int channels[] = {picture.channel("R"), picture.channel("G"), picture.channel("B")};
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](int a, int b) { return static_cast<double>(picture.at(a, b, channels[c])); };
    sum[c] = (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
  }
  value = {sum[0], sum[1], sum[2]};
  return true;
}

struct Glimpse {
  Vec2 pixel;
  double cosine = 0;  // of the angle of incidence on the ball; 0 or less: not seen
};

// All rays parallel to the camera's axis: normals lie over the outline's disc as over a sphere seen from afar (Debevec
// 1998), turned by the camera's pose alone.
Glimpse orthographic(const BallView& view, const Unwrap& wish, Vec3 towards) {
  const auto camera_from_world = inverse(view.world_from_camera);
  const Vec3 o = camera_from_world * wish.centre_m;
  const double outline_px = view.focal_px * std::tan(std::asin(wish.radius_m / norm(o)));
  const Vec3 n = normalized(camera_from_world.rotate(towards) + Vec3{0, 0, -1});
  const Vec2 centre = view.principal_px + Vec2{o.x / o.z, o.y / o.z} * view.focal_px;
  return {centre + Vec2{n.x, n.y} * outline_px, -n.z};
}

// n = (v + l) / |v + l|, p = o + R n, the pixel where the camera sees p (the thesis, section 2.H); v from p itself, by
// iteration, so that l is exact for light from afar.
Glimpse perspective(const BallView& view, const Unwrap& wish, Vec3 towards) {
  const Vec3 camera = view.world_from_camera.translation_m;
  Vec3 v = normalized(camera - wish.centre_m), n = v, p;
  for (int round = 0; round < 12; ++round) {
    n = v + towards;
    if (!(norm(n) > 1e-6)) return {};
    n = normalized(n);
    p = wish.centre_m + n * wish.radius_m;
    v = normalized(camera - p);
  }
  const Vec3 seen = inverse(view.world_from_camera) * p;
  return {view.principal_px + Vec2{seen.x / seen.z, seen.y / seen.z} * view.focal_px, dot(n, v)};
}

}  // namespace

io::Image room(int width) {
  io::Image image(width, width / 2, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3 value = radiance_of(direction_of(x, y, image.width, image.height));
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(value[c]);
    }
  return image;
}

io::Image unwrapped(const std::vector<BallView>& views, const Unwrap& wish) {
  io::Image map(wish.width, wish.width / 2, {"R", "G", "B"});
  parallel_for(0, static_cast<std::size_t>(map.height), [&](std::size_t row) {
    for (int x = 0; x < map.width; ++x) {
      const Vec3 towards = direction_of(x, static_cast<int>(row), map.width, map.height);
      Vec3 radiance{};
      double best = 0.08;  // cosine of 85 degrees: beyond, a pixel spans too much
      for (const BallView& view : views) {
        const Glimpse at = wish.perspective ? perspective(view, wish, towards) : orthographic(view, wish, towards);
        Vec3 value;
        if (!(at.cosine > best) || !look_up(*view.picture, at.pixel, value)) continue;
        best = at.cosine;
        if (wish.divided)
          for (int c = 0; c < 3; ++c) {
            const double reflected = surface::fresnel_metal(at.cosine, wish.eta[c], wish.k[c]);
            (c == 0 ? value.x : c == 1 ? value.y : value.z) /= reflected;
          }
        radiance = value;
      }
      for (int c = 0; c < 3; ++c) map.at(x, static_cast<int>(row), c) = static_cast<float>(std::max(0.0, radiance[c]));
    }
  });
  return map;
}

}  // namespace gonio::reassembly_experiment
