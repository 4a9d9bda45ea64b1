// See bright_lights.h: regions of single views.
#include "probe/bright_lights.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::probe {
namespace {

constexpr std::array<std::array<int, 2>, 8> around{
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

Rgb light_at(const Facing& face, std::size_t pixel) {
  const float* v = &face.radiance.data[3 * pixel];
  return {v[0], v[1], v[2]};
}

// What the pixels of a ball say: ray and solid angle of each.
class BallPixels {
 public:
  BallPixels(const BallView& view, const MirrorBall& mirror) : view_(view), mirror_(mirror) {
    // The outline of a ball that was moved or swollen is larger in proportion to the sine of its half angle.
    const MirrorBall there = view.mirror();
    radius_px_ = view.radius_px * mirror.ball().radius_m / there.ball().radius_m;
    if (!view.camera.orthographic()) radius_px_ *= there.eye_distance_m() / mirror.eye_distance_m();
  }
  std::optional<MirrorBall::Reflection> ray(std::size_t pixel) const {
    const auto w = static_cast<std::size_t>(view_.picture.width);
    const camera::Ray ray = view_.camera.ray({static_cast<double>(pixel % w), static_cast<double>(pixel / w)});
    return mirror_.reflect(view_.world_from_camera * ray.origin_m, view_.world_from_camera.rotate(ray.direction));
  }
  double solid_angle(const MirrorBall::Reflection& r) const {
    const Vec2 spread = mirror_.spread_rad(r.offset);
    return spread.x * spread.y / (radius_px_ * radius_px_);
  }

 private:
  const BallView& view_;
  const MirrorBall& mirror_;
  double radius_px_ = 0;
};

// Connected pixels (eight neighbours) of `bright`.
std::vector<std::vector<std::size_t>> regions_of(std::vector<std::uint8_t> bright, int width) {
  const int height = static_cast<int>(bright.size()) / width;
  std::vector<std::vector<std::size_t>> regions;
  for (std::size_t first = 0; first < bright.size(); ++first) {
    if (bright[first] == 0) continue;
    std::vector<std::size_t> region{first};
    bright[first] = 0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      const int x = static_cast<int>(region[k]) % width, y = static_cast<int>(region[k]) / width;
      for (const auto& [dx, dy] : around) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
        const auto next =
            static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x + dx);
        if (bright[next] == 0) continue;
        bright[next] = 0;
        region.push_back(next);
      }
    }
    regions.push_back(std::move(region));
  }
  return regions;
}

// Mean radiance of the pixels about a region; zero where there are none.
Rgb border_level(const Facing& face, const std::vector<std::size_t>& region, const std::vector<std::uint8_t>& bright) {
  const int width = face.radiance.width, height = face.radiance.height;
  Rgb sum{};
  double count = 0;
  for (const std::size_t pixel : region) {
    const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
    for (const auto& [dx, dy] : around) {
      if (x + 2 * dx < 0 || y + 2 * dy < 0 || x + 2 * dx >= width || y + 2 * dy >= height) continue;
      const auto next =
          static_cast<std::size_t>(y + 2 * dy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x + 2 * dx);
      if (face.used[next] == 0 || bright[next] != 0) continue;
      sum += light_at(face, next), ++count;
    }
  }
  return count > 0 ? sum / count : Rgb{};
}

struct Moments {
  Vec3 point_m, direction;
  Rgb irradiance;
  double sr = 0, half_angle_rad = 0, pixel_sr = 0, effective = 0;
};
Moments moments_of(const Highlight& h, const BallView& view, const MirrorBall& mirror, const Facing& face) {
  const BallPixels pixels(view, mirror);
  Moments m;
  double weights = 0, squares = 0;
  std::vector<std::pair<Vec3, double>> rays;
  for (const std::size_t pixel : h.pixels) {
    const auto r = pixels.ray(pixel);
    if (!r) continue;
    const double sr = pixels.solid_angle(*r);
    const Rgb light = light_at(face, pixel) - h.background;
    const double w = std::max(0.0, mean(light)) * sr;
    m.irradiance += light * sr;
    m.point_m += r->point_m * w, m.direction += r->direction * w;
    m.sr += sr, m.pixel_sr += sr * w, weights += w, squares += w * w;
    rays.emplace_back(r->direction, w);
  }
  if (!(weights > 0)) return {};
  m.point_m = m.point_m / weights, m.direction = normalized(m.direction);
  m.pixel_sr /= weights, m.effective = weights * weights / squares;
  double spread = 0;
  for (const auto& [direction, w] : rays) spread += w * std::pow(norm(cross(direction, m.direction)), 2);
  // A disc of half angle a has the second moment a^2 / 2; a pixel adds a twelfth of its area for each direction.
  m.half_angle_rad = std::sqrt(std::max(0.0, 2 * (spread / weights - m.pixel_sr / 6)));
  return m;
}

void add_outer(Mat3& sum, Vec3 v, double factor = 1) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum(i, j) += factor * v[i] * v[j];
}

// What the picture's own noise does to a region's middle and to its irradiance.
void add_noise(Highlight& h, const BallView& view, const Facing& face, const MirrorBall& mirror) {
  if (view.variance.data.empty()) return;
  const BallPixels pixels(view, mirror);
  const double all = mean(h.irradiance);
  const std::size_t channels = view.picture.channels.size();
  for (const std::size_t pixel : h.pixels) {
    const auto r = pixels.ray(pixel);
    const float green = view.picture.data[pixel * channels + channels / 2];
    if (!r || !(green > 0)) continue;
    const double over = mean(light_at(face, pixel)) / double{green}, sr = pixels.solid_angle(*r);
    const double variance = double{view.variance.data[pixel * channels + channels / 2]} * over * over * sr * sr;
    add_outer(h.covariance, r->direction - h.direction * dot(r->direction, h.direction), variance / (all * all));
    h.irradiance_sigma += Rgb{1, 1, 1} * variance;
  }
}

Vec2 focus_of(const Highlight& h, const BallView& view) {
  const Vec3 normal = (h.point_m - view.ball.centre_m) / view.ball.radius_m;
  const double cosine = std::max(dot(normal, h.direction) / norm(normal), 1e-3), r = view.ball.radius_m;
  const double nearness = view.camera.orthographic() ? 0 : 1 / norm(view.world_from_camera.translation_m - h.point_m);
  return {1 / (nearness + 2 / (r * cosine)), 1 / (nearness + 2 * cosine / r)};
}

// Is the lamp's place on the ball, in the picture, among the pixels that are used?
bool shows(const BallView& view, const Facing& face, const FoundLight& light) {
  const Vec3 way = light.position_m ? *light.position_m - view.ball.centre_m : light.direction;
  const auto shown = view.mirror().shown(normalized(way), light.position_m ? norm(way) : HUGE_VAL);
  if (!shown) return false;
  const auto pixel = view.camera.project(inverse(view.world_from_camera) * shown->point_m);
  if (!pixel) return false;
  const auto x = std::lround(pixel->x), y = std::lround(pixel->y);
  if (x < 0 || y < 0 || x >= face.radiance.width || y >= face.radiance.height) return false;
  return face.used[static_cast<std::size_t>(y) * static_cast<std::size_t>(face.radiance.width) +
                   static_cast<std::size_t>(x)] != 0;
}

}  // namespace

std::vector<Highlight> highlights(const std::vector<BallView>& views, const std::vector<Facing>& faces, std::size_t v,
                                  const LightWish& wish) {
  const BallView& view = views[v];
  const Facing& face = faces[v];
  const MirrorBall mirror = view.mirror();
  const BallPixels pixels(view, mirror);
  double light = 0, all_sr = 0;
  for (std::size_t i = 0; i < face.used.size(); ++i) {
    if (face.used[i] == 0) continue;
    const auto r = pixels.ray(i);
    const double sr = r ? pixels.solid_angle(*r) : 0;
    light += mean(light_at(face, i)) * sr, all_sr += sr;
  }
  std::vector<std::uint8_t> bright(face.used.size(), 0);
  const double level = all_sr > 0 ? wish.ratio * light / all_sr : HUGE_VAL;
  for (std::size_t i = 0; i < bright.size(); ++i)
    bright[i] = face.used[i] != 0 && mean(light_at(face, i)) > level ? 1 : 0;
  std::vector<Highlight> found;
  for (auto& region : regions_of(bright, face.radiance.width)) {
    Highlight h;
    h.view = v;
    h.pixels = std::move(region);
    h.background = border_level(face, h.pixels, bright);
    const Moments m = moments_of(h, view, mirror, face);
    if (!(mean(m.irradiance) > wish.least_share * light) || m.sr > 2 * pi * (1 - std::cos(wish.largest_rad))) continue;
    h.point_m = m.point_m, h.direction = m.direction, h.irradiance = m.irradiance;
    h.half_angle_rad = m.half_angle_rad;
    h.focus_m = focus_of(h, view);
    if (!view.clipped.empty())
      h.clipped = std::ranges::any_of(h.pixels, [&](std::size_t p) { return view.clipped[p] != 0; });
    // Pixels are means, which keep a middle but for the bend of the mirror: measured, a quarter of what counting pixels
    // gives. Saturated ones are counted.
    const double within = h.clipped ? 1 : 0.25;
    const Basis across(h.direction);
    for (const Vec3 t : {across.t, across.b})
      add_outer(h.covariance, t, within * within * m.pixel_sr / (12 * m.effective));
    add_noise(h, view, face, mirror);
    h.own_covariance = h.covariance;
    for (const Ball& variant : view.variants) {
      const Moments moved = moments_of(h, view, view.mirror(variant), face);
      if (!(mean(moved.irradiance) > 0)) continue;
      const Vec3 turn = moved.direction - h.direction;
      add_outer(h.covariance, turn - h.direction * dot(turn, h.direction));
      const Rgb more = moved.irradiance - h.irradiance;
      h.irradiance_sigma += more * more;
    }
    h.irradiance_sigma = {std::sqrt(h.irradiance_sigma.x), std::sqrt(h.irradiance_sigma.y),
                          std::sqrt(h.irradiance_sigma.z)};
    found.push_back(std::move(h));
  }
  std::ranges::stable_sort(found, std::greater{}, [](const Highlight& h) { return mean(h.irradiance); });
  return found;
}

std::vector<FoundLight> agreed(const std::vector<FoundLight>& lights, const std::vector<Highlight>& all,
                               const std::vector<BallView>& views, const std::vector<Facing>& faces) {
  std::vector<FoundLight> kept;
  for (const FoundLight& light : lights) {
    bool by_all = true;
    for (std::size_t v = 0; v < views.size() && by_all; ++v)
      by_all = std::ranges::any_of(light.seen, [&](std::size_t k) { return all[k].view == v; }) ||
               !shows(views[v], faces[v], light);
    if (by_all) kept.push_back(light);
  }
  return kept;
}

void take_out(const std::vector<FoundLight>& lights, const std::vector<Highlight>& all, std::vector<Facing>& faces) {
  for (const FoundLight& light : lights)
    for (const std::size_t k : light.seen)
      for (const std::size_t pixel : all[k].pixels)
        for (int c = 0; c < 3; ++c)
          faces[all[k].view].radiance.data[3 * pixel + static_cast<std::size_t>(c)] =
              static_cast<float>(all[k].background[c]);
}

}  // namespace gonio::probe
