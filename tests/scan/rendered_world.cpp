// See rendered_world.h.
#include "scan/rendered_world.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/parallel.h"
#include "geom/rigid.h"
#include "render/scenes.h"

namespace gonio::tests {
namespace {

constexpr double least_step_m = 1e-9;

Vec3 at_of(const Pinhole& p) {
  return {p.at[0], p.at[1], p.at[2]};
}

// Distance along the ray in units of `direction`.
std::optional<double> meets(const Board& b, Vec3 from, Vec3 direction) {
  const Vec3 n = cross(b.x, b.y);
  const double t = dot(b.middle_m - from, n) / dot(direction, n);
  if (!(t > least_step_m) || !std::isfinite(t)) return std::nullopt;
  const Vec3 at = from + direction * t - b.middle_m;
  return std::abs(dot(at, b.x)) <= b.half_x_m && std::abs(dot(at, b.y)) <= b.half_y_m ? std::optional(t) : std::nullopt;
}

std::optional<double> meets(const std::pair<Vec3, double>& ball, Vec3 from, Vec3 direction) {
  const Vec3 o = from - ball.first;
  const double a = dot(direction, direction), b = dot(o, direction), c = dot(o, o) - ball.second * ball.second,
               root = b * b - a * c;
  if (root < 0) return std::nullopt;
  const double t = (-b - std::sqrt(root)) / a;
  return t > least_step_m ? std::optional(t) : std::nullopt;
}

scene::Scene scene_of(const RenderedWorld& w, const Pinhole& camera, std::shared_ptr<const io::Image> picture) {
  SceneBuilder builder;
  const std::vector<double> scattered(3, w.scattering_per_m), absorbed(3, 2e-3 * w.scattering_per_m);
  const manifest::Parameters solid{{"sigma_s_per_m", scattered}, {"sigma_a_per_m", absorbed}};
  const std::size_t surface =
      w.scattering_per_m > 0 ? builder.surface("directional-dipole", solid) : builder.diffuse(w.albedo);
  for (const Board& b : w.boards) {
    const Vec3 n = cross(b.x, b.y);
    const Mat3 turn{{b.x.x, b.y.x, n.x, b.x.y, b.y.y, n.y, b.x.z, b.y.z, n.z}};
    builder.object(scene::Plane{2 * b.half_x_m, 2 * b.half_y_m}, surface, b.middle_m,
                   rotation_vector_of(quaternion_of(turn)));
  }
  for (const auto& [middle, radius] : w.balls) builder.object(scene::Sphere{radius}, surface, middle);
  const Pinhole& p = w.projector;
  manifest::Parameters lamp{{"position_m", std::vector<double>{p.at[0], p.at[1], p.at[2]}},
                            {"direction", std::vector<double>{std::sin(p.toe_rad), 0, std::cos(p.toe_rad)}},
                            {"up", std::vector<double>{0, -1, 0}},
                            {"fx_px", p.f},
                            {"fy_px", p.f},
                            {"cx_px", 0.5 * (p.width - 1)},
                            {"cy_px", 0.5 * (p.height - 1)},
                            {"watt_per_sr", w.white * pi * w.distance_m * w.distance_m / w.albedo},
                            {"gamma", w.gamma},
                            {"radius_m", w.lens_radius_m},
                            {"focus_m", w.focus_m}};
  builder.light("projector", lamp, std::move(picture));
  const camera::Intrinsics lens{camera.f, camera.f, 0.5 * (camera.width - 1), 0.5 * (camera.height - 1), {}};
  return builder.view(camera::CameraModel(lens, camera.width, camera.height), at_of(camera), {0, camera.toe_rad, 0})
      .scene();
}

}  // namespace

RenderedWorld rendered(const ScanWorld& s) {
  RenderedWorld w;
  w.projector = s.projector, w.distance_m = s.distance, w.ambient = s.ambient, w.gain = s.gain, w.read = s.read;
  w.gamma = s.gamma, w.seed = s.seed;
  if (s.shape == ScanWorld::Shape::ball) {
    w.balls.emplace_back(Vec3{s.ball_x, 0, s.distance}, s.radius);
    return w;
  }
  // Seen from -z: x along the slope, y upwards, x cross y to the cameras.
  const Vec3 x = normalized(Vec3{1, 0, s.tilt}), y{0, -1, 0};
  if (s.shape == ScanWorld::Shape::plane) {
    w.boards.push_back({{0, 0, s.distance}, x, y, 1, 1});
    return w;
  }
  const Vec3 edge{0.01, 0, s.distance + 0.01 * s.tilt};
  w.boards.push_back({edge + 0.5 * x, x, y, 0.5, 1});
  w.boards.push_back({edge - Vec3{0, 0, 0.012} - 0.5 * x, x, y, 0.5, 1});
  w.boards.push_back({edge - Vec3{0, 0, 0.006}, {0, 0, 1}, y, 0.006, 1});
  return w;
}

RenderedWorld groove(double opening_rad, double turn_rad, Vec3 vertex_m, double wall_m) {
  RenderedWorld w;
  w.albedo = 0.8;
  for (const double side : {-1.0, 1.0}) {
    const double a = turn_rad + side * 0.5 * opening_rad;
    const Vec3 along{std::sin(a), 0, -std::cos(a)}, x = along * side, y{0, -1, 0};
    w.boards.push_back({vertex_m + along * (0.5 * wall_m), x, y, 0.5 * wall_m, 0.12});
  }
  return w;
}

std::optional<Vec3> first_met(const RenderedWorld& w, Vec3 from, Vec3 direction) {
  std::optional<double> nearest;
  const auto take = [&nearest](std::optional<double> t) {
    if (t && (!nearest || *t < *nearest)) nearest = t;
  };
  for (const Board& b : w.boards) take(meets(b, from, direction));
  for (const auto& ball : w.balls) take(meets(ball, from, direction));
  return nearest ? std::optional(from + direction * *nearest) : std::nullopt;
}

std::optional<Vec2> lit_by(const RenderedWorld& w, const Pinhole& camera, int x, int y) {
  const auto d = camera.direction(x, y);
  const auto p = first_met(w, at_of(camera), {d[0], d[1], d[2]});
  if (!p) return std::nullopt;
  const Vec3 lens = at_of(w.projector);
  const auto q = first_met(w, lens, *p - lens);
  if (!q || norm(*q - *p) > 1e-6) return std::nullopt;
  const auto u = w.projector.pixel({p->x, p->y, p->z});
  if (u[0] < -0.5 || u[1] < -0.5 || u[0] > w.projector.width - 0.5 || u[1] > w.projector.height - 0.5)
    return std::nullopt;
  return Vec2{u[0], u[1]};
}

RenderedFrames::RenderedFrames(const RenderedWorld& w, const Pinhole& camera, const scan::Sequence& sequence)
    : world_(w), second_(camera.at[0] > 0) {
  const std::size_t frames = sequence.frames.size();
  for (std::size_t first = 0; first < frames; first += 3) {
    auto picture =
        std::make_shared<io::Image>(sequence.width_px, sequence.height_px, std::vector<std::string>{"R", "G", "B"});
    for (std::size_t c = 0; c < 3; ++c)
      for (int y = 0; y < sequence.height_px; ++y)
        for (int x = 0; x < sequence.width_px; ++x)
          picture->at(x, y, static_cast<int>(c)) =
              static_cast<float>(scan::light_at(sequence, std::min(first + c, frames - 1), x, y));
    render::Options options{.spp = w.spp, .seed = w.seed, .geometry = false};
    options.transport.max_bounces = w.bounces;
    pictures_.push_back(render_view(scene_of(w, camera, std::move(picture)), options));
  }
}

scan::CameraFrame RenderedFrames::operator()(std::size_t frame) const {
  const io::Image& picture = pictures_[frame / 3];
  const std::size_t channels = picture.channels.size();
  std::mt19937_64 random(world_.seed * 977 + frame * 31 + (second_ ? 7 : 0));
  scan::CameraFrame f;
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const double light = world_.ambient + picture.data[i * channels + frame % 3];
    const double v = static_cast<double>(std::poisson_distribution<long>(light * world_.gain)(random)) / world_.gain +
                     std::normal_distribution<double>(0, world_.read)(random);
    f.light.push_back(static_cast<float>(std::min(v, 1.0))), f.saturated.push_back(v >= 1);
  }
  return f;
}

scan::Codes decoded(const RenderedFrames& frames, const RenderedWorld& w, const Pinhole& camera,
                    scan::DecodeRequest request) {
  request.width = camera.width, request.height = camera.height;
  request.read = [&](std::size_t frame) { return frames(frame); };
  if (!request.noise) request.noise = manifest::Noise{w.gain, w.read};
  return scan::decode(request);
}

}  // namespace gonio::tests
