// See unwrap.h.
#include "probe/unwrap.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "probe/fill.h"
#include "probe/projection.h"
#include "probe/remap.h"

namespace gonio::probe {
namespace {

double smooth_step(double t) {
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

double angle_between(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

// Bilinear among pixels that are used; weight zero where one of the four is not.
bool look_up(const Facing& face, Vec2 p, Rgb& sum) {
  const int w = face.radiance.width, x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
  if (x < 0 || y < 0 || x + 1 >= w || y + 1 >= face.radiance.height) return false;
  Rgb value{};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      if (face.used[static_cast<std::size_t>(y + j) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x + i)] ==
          0)
        return false;
      const double weight = (i == 1 ? p.x - x : 1 - (p.x - x)) * (j == 1 ? p.y - y : 1 - (p.y - y));
      const float* v = &face.radiance.data[face.radiance.index(x + i, y + j, 0)];
      value += Rgb{v[0], v[1], v[2]} * weight;
    }
  sum += value;
  return true;
}

// Does a ray meet the ball? Its rim is known less well than the rest.
bool meets(Vec3 origin_m, Vec3 direction, const Ball& ball) {
  constexpr double margin = 1.1;
  const Vec3 way = ball.centre_m - origin_m;
  const double ahead = dot(way, direction);
  return ahead > 0 && dot(way, way) - ahead * ahead < std::pow(margin * ball.radius_m, 2);
}

class TexelView {  // how one view sees texels
 public:
  TexelView(const BallView& view, const Facing& face, const UnwrapWish& wish)
      : view_(view),
        face_(face),
        wish_(wish),
        mirror_(view.mirror()),
        camera_from_world_(inverse(view.world_from_camera)) {
    // The camera stands at its own distance, not at that of the surroundings.
    const double away = mirror_.eye_distance_m();
    hidden_rad_ = std::isfinite(away) ? std::atan2(wish.camera_radius_m, away) : 0;
  }

  // Of a texel's middle; zero where the view shows nothing. `footprint`: a pixel's width as a direction.
  double weight(Vec3 direction, double& footprint) const {
    const auto shown = mirror_.shown(direction, wish_.distance_m);
    if (!shown) return 0;
    const double steepest = std::cos(wish_.steepest_rad);
    constexpr double fade = 0.5;  // of the cosine that is left, and of the camera's radius
    double f = smooth_step((shown->cosine - steepest) / (fade * (1 - steepest) * 0.2));
    if (hidden_rad_ > 0) f *= smooth_step((angle_between(direction, mirror_.towards_eye()) / hidden_rad_ - 1) / fade);
    const double along = shown->along_rad / view_.radius_px, across = shown->across_rad / view_.radius_px;
    footprint = std::sqrt(along * across);
    return f / (along * along * (1.0 / 12 + view_.sigma_px * view_.sigma_px) + across * across / 12);
  }
  // Adds the radiance there; false where the picture has none.
  bool add(Vec3 direction, Rgb& sum) const {
    const auto shown = mirror_.shown(direction, wish_.distance_m);
    if (!shown) return false;
    const auto pixel = view_.camera.project(camera_from_world_ * shown->point_m);
    return pixel && look_up(face_, *pixel, sum);
  }

 private:
  const BallView& view_;
  const Facing& face_;
  const UnwrapWish& wish_;
  MirrorBall mirror_;
  Rigid<frame::Camera, frame::World> camera_from_world_;
  double hidden_rad_ = 0;
};

// Mean of one view over a texel, and the share of the texel that it shows.
struct Seen {
  Rgb radiance;
  double share = 0;
};
Seen seen(const TexelView& view, const SphereMap& map, int x, int y, int samples) {
  Seen result;
  int met = 0;
  double top = std::cos(pi * y / map.height), bottom = std::cos(pi * (y + 1) / map.height);
  for (int j = 0; j < samples; ++j)
    for (int i = 0; i < samples; ++i) {
      // Evenly in the cosine of the colatitude: each sample stands for the same solid angle.
      const double z = top + (bottom - top) * (j + 0.5) / samples, r = std::sqrt(std::max(0.0, 1 - z * z));
      const double phi = pi - 2 * pi * (x + (i + 0.5) / samples) / map.width;
      met += view.add({r * std::cos(phi), r * std::sin(phi), z}, result.radiance);
    }
  if (met > 0) result.radiance = result.radiance / met;
  result.share = static_cast<double>(met) / (samples * samples);
  return result;
}

// Samples a side: one and a half to each pixel's footprint.
int samples_for(double texel_rad, double footprint_rad) {
  return static_cast<int>(std::clamp(std::ceil(1.5 * texel_rad / footprint_rad), 2.0, 12.0));
}

}  // namespace

MirrorBall mirror_before(const camera::CameraModel& camera, const Rigid<frame::World, frame::Camera>& world_from_camera,
                         const Ball& ball) {
  if (camera.orthographic()) return MirrorBall::parallel(ball, -world_from_camera.rotate({0, 0, 1}));
  return {ball, world_from_camera.translation_m};
}

MirrorBall BallView::mirror(const Ball& there) const {
  return mirror_before(camera, world_from_camera, there);
}

Facing facing(const BallView& view, const UnwrapWish& wish) {
  const io::Image& p = view.picture;
  Facing face{io::Image(p.width, p.height, {"R", "G", "B"}), std::vector<std::uint8_t>(p.pixels(), 0)};
  const MirrorBall mirror = view.mirror();
  constexpr double margin_px = 1.5;  // pixels at the outline are mixed with what lies behind
  const double steepest = std::cos(wish.steepest_rad);
  const std::size_t channels = p.channels.size();
  parallel_for(0, static_cast<std::size_t>(p.height), [&](std::size_t y) {
    for (int x = 0; x < p.width; ++x) {
      const std::size_t i = y * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(x);
      if (!view.counts.empty() && view.counts[i] == 0) continue;
      const camera::Ray ray = view.camera.ray({static_cast<double>(x), static_cast<double>(y)});
      const auto r =
          mirror.reflect(view.world_from_camera * ray.origin_m, view.world_from_camera.rotate(ray.direction));
      if (!r || (1 - r->offset) * view.radius_px < margin_px || r->cosine < steepest) continue;
      if (std::ranges::any_of(view.others, [&](const Ball& b) { return meets(r->point_m, r->direction, b); })) continue;
      const float* v = &p.data[i * channels];
      const Rgb light = channels >= 3 ? Rgb{v[0], v[1], v[2]} : Rgb{v[0], v[0], v[0]};
      if (!is_finite(light)) continue;
      const Rgb share = wish.metal.reflectance(r->cosine);
      for (int c = 0; c < 3; ++c)
        face.radiance.data[3 * i + static_cast<std::size_t>(c)] = static_cast<float>(light[c] / share[c]);
      face.used[i] = 1;
    }
  });
  return face;
}

Unwrapped unwrapped(const std::vector<BallView>& views, const std::vector<Facing>& faces, const UnwrapWish& wish) {
  const SphereMap map = sized(Projection::lat_long, wish.columns / 2);
  Unwrapped result{io::Image(map.width, map.height, {"R", "G", "B"}),
                   io::Image(map.width, map.height, {"Y", "footprint"}), 0};
  std::vector<TexelView> all;
  for (std::size_t v = 0; v < views.size(); ++v) all.emplace_back(views[v], faces[v], wish);
  const double row_rad = pi / map.height;
  parallel_for(0, static_cast<std::size_t>(map.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < map.width; ++x) {
      const Vec3 middle = direction_at(map, {x + 0.5, y + 0.5})->unit;
      Rgb sum{};
      double weights = 0, most_share = 0, finest = 0;
      for (const TexelView& view : all) {
        double footprint = 0;
        const double w = view.weight(middle, footprint);
        if (!(w > 0)) continue;
        const Seen here = seen(view, map, x, y, samples_for(row_rad, footprint));
        if (!(here.share > 0)) continue;
        sum += here.radiance * (w * here.share), weights += w * here.share;
        most_share = std::max(most_share, here.share);
        if (finest == 0 || footprint < finest) finest = footprint;
      }
      if (weights > 0) sum = sum / weights;
      for (int c = 0; c < 3; ++c) result.radiance.at(x, y, c) = static_cast<float>(std::max(0.0, sum[c]));
      result.weight.at(x, y, 0) = static_cast<float>(most_share);
      result.weight.at(x, y, 1) = static_cast<float>(finest);
    }
  });
  const std::vector<double> sr = solid_angles(map);
  for (std::size_t i = 0; i < sr.size(); ++i) result.blind_sr += sr[i] * (1 - double{result.weight.data[2 * i]});
  if (wish.fill) fill_unseen(result.radiance, result.weight);
  return result;
}

}  // namespace gonio::probe
