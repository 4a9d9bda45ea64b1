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
  std::optional<MirrorBall::Reflection> ray(std::size_t pixel, Vec2 off = {}) const {
    const auto w = static_cast<std::size_t>(view_.picture.width);
    const Vec2 middle{static_cast<double>(pixel % w), static_cast<double>(pixel / w)};
    const camera::Ray ray = view_.camera.ray(middle + off);
    return mirror_.reflect(view_.world_from_camera * ray.origin_m, view_.world_from_camera.rotate(ray.direction));
  }
  double solid_angle(const MirrorBall::Reflection& r) const {
    const Vec2 spread = mirror_.spread_rad(r.offset);
    return spread.x * spread.y / (radius_px_ * radius_px_);
  }
  // Of a square of a pixel, `side` long, by the rays at its sides: the lens and a ball that is off its axis included,
  // which change it by per cents.
  std::optional<double> solid_angle(std::size_t pixel, Vec2 off, double side) const {
    const double h = side / 2;
    const auto left = ray(pixel, off - Vec2{h, 0}), right = ray(pixel, off + Vec2{h, 0}),
               above = ray(pixel, off - Vec2{0, h}), below = ray(pixel, off + Vec2{0, h});
    if (!left || !right || !above || !below) return {};
    return norm(cross(right->direction - left->direction, below->direction - above->direction));
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

// Radiance of the pixels about a region: mean, and scatter of its mean channel; zero where there are none.
struct Border {
  Rgb level{};
  double scatter = 0;
};
Border border_of(const Facing& face, const std::vector<std::size_t>& region, const std::vector<std::uint8_t>& bright) {
  const int width = face.radiance.width, height = face.radiance.height;
  Rgb sum{};
  double count = 0, squares = 0;
  for (const std::size_t pixel : region) {
    const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
    for (const auto& [dx, dy] : around) {
      if (x + 2 * dx < 0 || y + 2 * dy < 0 || x + 2 * dx >= width || y + 2 * dy >= height) continue;
      const auto next =
          static_cast<std::size_t>(y + 2 * dy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x + 2 * dx);
      if (face.used[next] == 0 || bright[next] != 0) continue;
      const Rgb light = light_at(face, next);
      sum += light, squares += mean(light) * mean(light), ++count;
    }
  }
  if (!(count > 0)) return {};
  return {sum / count, std::sqrt(std::max(0.0, squares / count - std::pow(mean(sum) / count, 2)))};
}

// The pixels about a region that are used and belong to no region: the lamp's edge runs through them, and what they
// have of it is too dim to be found. `cut`: some are not used.
std::vector<std::size_t> edge_of(const Facing& face, const std::vector<std::size_t>& region,
                                 const std::vector<std::uint8_t>& bright, bool& cut) {
  const int width = face.radiance.width, height = face.radiance.height;
  std::vector<std::size_t> edge;
  for (const std::size_t pixel : region) {
    const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
    for (const auto& [dx, dy] : around) {
      const bool inside = x + dx >= 0 && y + dy >= 0 && x + dx < width && y + dy < height;
      const auto next =
          static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x + dx);
      if (!inside || face.used[next] == 0)
        cut = true;
      else if (bright[next] == 0)
        edge.push_back(next);
    }
  }
  std::ranges::sort(edge);
  edge.erase(std::ranges::unique(edge).begin(), edge.end());
  return edge;
}

void add_outer(Mat3& sum, Vec3 v, double factor = 1) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum(i, j) += factor * v[i] * v[j];
}
Vec3 across(Vec3 v, Vec3 direction) {
  return v - direction * dot(v, direction);
}

struct Moments {
  Vec3 point_m, direction;
  Rgb irradiance;
  Mat3 pixel{{}};  // of the direction: what one pixel's uniform error does, in the mean
  double sr = 0, half_angle_rad = 0, effective = 0;
  double spread = 0;  // mean square angle from the middle, the pixels' own taken off
};
// A pixel is the mean of its square, and what is wanted is the integral of light times F (solid angle, direction, ...)
// over the picture, which the ball's mirror bends: sum over pixels of light (F - Laplace(F) / 24), to the third order.
// F at the middle and at the sides gives it, with these weights.
Moments moments_of(const Highlight& h, const BallView& view, const MirrorBall& mirror, const Facing& face) {
  constexpr std::array<std::array<double, 3>, 5> stencil{
      {{0, 0, 5.0 / 3}, {-0.5, 0, -1.0 / 6}, {0.5, 0, -1.0 / 6}, {0, -0.5, -1.0 / 6}, {0, 0.5, -1.0 / 6}}};
  constexpr double side = 0.25;
  const BallPixels pixels(view, mirror);
  Moments m;
  double weights = 0, squares = 0;
  std::vector<std::pair<Vec3, double>> rays;
  for (const std::size_t pixel : h.pixels) {
    const Rgb light = light_at(face, pixel) - h.background;
    std::array<std::optional<MirrorBall::Reflection>, 5> ray;
    std::array<std::optional<double>, 5> sr;
    bool whole = true;
    for (std::size_t k = 0; k < 5 && whole; ++k) {
      const Vec2 off{stencil[k][0], stencil[k][1]};
      ray[k] = pixels.ray(pixel, off), sr[k] = pixels.solid_angle(pixel, off, side);
      whole = ray[k] && sr[k];
    }
    if (!whole) continue;
    double all = 0;
    for (std::size_t k = 0; k < 5; ++k) {
      const double part = *sr[k] / (side * side) * stencil[k][2], w = mean(light) * part;
      m.irradiance += light * part;
      m.point_m += ray[k]->point_m * w, m.direction += ray[k]->direction * w;
      m.sr += part, all += w;
      rays.emplace_back(ray[k]->direction, w);
    }
    add_outer(m.pixel, ray[2]->direction - ray[1]->direction, all / 12);
    add_outer(m.pixel, ray[4]->direction - ray[3]->direction, all / 12);
    weights += all, squares += all * all;
  }
  if (!(weights > 0)) return {};
  m.point_m = m.point_m / weights, m.direction = normalized(m.direction);
  for (double& v : m.pixel.m) v /= weights;
  m.effective = weights * weights / squares;
  for (const auto& [direction, w] : rays) m.spread += w / weights * std::pow(norm(cross(direction, m.direction)), 2);
  m.half_angle_rad = std::sqrt(std::max(0.0, 2 * m.spread));  // an even disc of half angle a has a spread of a^2 / 2
  return m;
}

// Of a region in a picture without noise: that pixels are means, and that what lies behind the lamp is not known.
void add_own_errors(Highlight& h, const Moments& m, double border_scatter) {
  // Pixels are means, which keep a middle but for where an edge runs through them: measured, a seventh of what counting
  // pixels gives. Saturated ones are counted.
  const double within = h.clipped ? 1 : 0.15;
  const Basis f(h.direction);
  const auto of_pixels = [&](Vec3 s, Vec3 t) { return within * within / m.effective * dot(s, m.pixel * t); };
  // Surroundings that rise evenly across a region of half angle a, with this scatter s about it, move the middle of a
  // lamp of the mean radiance L by sqrt(2) s a / (4 L).
  const double light = mean(h.irradiance) / m.sr, tilt = border_scatter * m.half_angle_rad / (4 * light);
  for (const Vec3 s : {f.t, f.b}) {
    add_outer(h.covariance, s, tilt * tilt);
    // How much is missing nobody knows: as much as its longer side.
    if (h.cut) add_outer(h.covariance, s, 2 * std::max(0.0, m.spread) + 4 * dot(s, m.pixel * s));
    for (const Vec3 t : {f.t, f.b})
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) h.covariance(i, j) += of_pixels(s, t) * s[i] * t[j];
  }
  h.irradiance_sigma += Rgb{1, 1, 1} * std::pow(border_scatter * m.sr, 2);
  if (h.cut) h.irradiance_sigma += h.irradiance * h.irradiance;
}

// What the errors of the ball's place do to it.
void add_ball_errors(Highlight& h, const BallView& view, const Facing& face) {
  for (const Ball& variant : view.variants) {
    const Moments moved = moments_of(h, view, view.mirror(variant), face);
    BallShift& shift = h.shifts.emplace_back();
    if (!(mean(moved.irradiance) > 0)) continue;
    shift = {across(moved.direction - h.direction, h.direction), moved.irradiance - h.irradiance};
    add_outer(h.covariance, shift.turn);
    h.irradiance_sigma += shift.more * shift.more;
  }
  const Rgb v = h.irradiance_sigma;
  h.irradiance_sigma = {std::sqrt(v.x), std::sqrt(v.y), std::sqrt(v.z)};
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
    add_outer(h.covariance, across(r->direction, h.direction), variance / (all * all));
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
    h.view = v, h.ball = view.number;
    h.pixels = std::move(region);
    const Border border = border_of(face, h.pixels, bright);
    h.background = border.level;
    const std::vector<std::size_t> edge = edge_of(face, h.pixels, bright, h.cut);
    h.pixels.insert(h.pixels.end(), edge.begin(), edge.end());
    const Moments m = moments_of(h, view, mirror, face);
    if (!(mean(m.irradiance) > wish.least_share * light) || m.sr > 2 * pi * (1 - std::cos(wish.largest_rad))) continue;
    h.point_m = m.point_m, h.direction = m.direction, h.irradiance = m.irradiance;
    h.half_angle_rad = m.half_angle_rad;
    h.focus_m = focus_of(h, view);
    if (!view.clipped.empty())
      h.clipped = std::ranges::any_of(h.pixels, [&](std::size_t p) { return view.clipped[p] != 0; });
    add_own_errors(h, m, border.scatter);
    add_noise(h, view, face, mirror);
    h.own_covariance = h.covariance, h.own_irradiance_variance = h.irradiance_sigma;
    add_ball_errors(h, view, face);
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
