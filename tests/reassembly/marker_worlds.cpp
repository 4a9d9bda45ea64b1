// See marker_worlds.h.
#include "reassembly/marker_worlds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

namespace gonio::tests {
namespace {

using reassembly::Outline;
using reassembly::View;

Vec3 direction_of(Random& random) {
  const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}
Vec3 normal3(Random& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

// Snell's law for a ray d that meets a surface with normal n (either side), from index a to index b.
std::optional<Vec3> refract(Vec3 d, Vec3 n, double a, double b) {
  if (dot(d, n) > 0) n = -n;
  const double ratio = a / b, cosine = -dot(d, n), k = 1 - ratio * ratio * (1 - cosine * cosine);
  if (k < 0) return {};
  return normalized(d * ratio + n * (ratio * cosine - std::sqrt(k)));
}

struct Ball {
  Vec3 centre;
  double radius = 0, hollow = 0, index = 1.5;  // air within `hollow`
};
struct Slab {  // a round window between n.x = offset and offset + thickness
  Vec3 normal;
  double offset = 0, thickness = 0;
  Vec3 centre;
  double radius = 0, index = 1.5;
};
struct TracedRay {
  Vec3 origin, direction;
};

// Where a ray from outside meets a sphere first; nothing where it passes.
std::optional<Vec3> hit(Vec3 centre, double radius, TracedRay ray) {
  const Vec3 o = ray.origin - centre;
  const double b = dot(o, ray.direction), disc = b * b - dot(o, o) + radius * radius;
  if (disc <= 0 || b >= 0) return {};
  return ray.origin + ray.direction * (-b - std::sqrt(disc));
}
std::optional<TracedRay> through(const Ball& ball, TracedRay ray) {
  const auto in = hit(ball.centre, ball.radius, ray);
  if (!in) return ray;
  auto d = refract(ray.direction, (*in - ball.centre) / ball.radius, 1, ball.index);
  if (!d) return {};
  Vec3 at = *in;
  if (const auto inner = ball.hollow > 0 ? hit(ball.centre, ball.hollow, {at, *d}) : std::nullopt) {
    const auto air = refract(*d, (*inner - ball.centre) / ball.hollow, ball.index, 1);
    if (!air) return {};
    at = *inner + *air * (-2 * dot(*inner - ball.centre, *air));
    d = refract(*air, (at - ball.centre) / ball.hollow, 1, ball.index);
    if (!d) return {};
  }
  const double along = dot(at - ball.centre, *d);
  at += *d * (-along + std::sqrt(along * along + ball.radius * ball.radius - dot(at - ball.centre, at - ball.centre)));
  const auto after = refract(*d, (at - ball.centre) / ball.radius, ball.index, 1);
  if (!after) return {};
  return TracedRay{at, *after};
}
std::optional<TracedRay> through(const Slab& slab, TracedRay ray) {
  const double down = dot(ray.direction, slab.normal);
  if (std::abs(down) < 0.05) return {};
  const double from = dot(ray.origin, slab.normal);
  const bool below = from < slab.offset;
  const double first = below ? slab.offset : slab.offset + slab.thickness;
  const Vec3 in = ray.origin + ray.direction * ((first - from) / down);
  const auto inside = refract(ray.direction, slab.normal, 1, slab.index);
  if (!inside) return {};
  const Vec3 out = in + *inside * (slab.thickness / std::abs(dot(*inside, slab.normal)));
  return TracedRay{out, ray.direction};
}

using Optics = std::function<std::optional<TracedRay>(TracedRay)>;

// The direction in which a camera sees a point through some optics: Newton's method on where the traced ray passes it,
// from the direct direction and from others between that and `centre`, the middle of the optics.
std::optional<Vec3> apparent(Vec3 camera, Vec3 target, Vec3 centre, const Optics& optics) {
  const auto miss = [&](Vec3 direction, const Basis& basis) -> std::optional<Vec2> {
    const auto out = optics({camera, direction});
    if (!out) return {};
    const Vec3 to = target - out->origin, off = to - out->direction * dot(to, out->direction);
    if (dot(to, out->direction) <= 0) return {};
    return Vec2{dot(off, basis.t), dot(off, basis.b)};
  };
  for (const double share : {1.0, 0.8, 0.6, 0.4, 0.2, -0.2, -0.5}) {
    Vec3 d = normalized(normalized(centre - camera) * (1 - share) + normalized(target - camera) * share);
    for (int step = 0; step < 40; ++step) {
      const Basis basis(d);
      const auto r = miss(d, basis);
      if (!r) break;
      if (norm(*r) < 1e-10) return d;
      const double h = 1e-7;
      const auto rx = miss(normalized(d + basis.t * h), basis), ry = miss(normalized(d + basis.b * h), basis);
      if (!rx || !ry) break;
      const double a = (rx->x - r->x) / h, b = (ry->x - r->x) / h, c = (rx->y - r->y) / h, e = (ry->y - r->y) / h;
      const double det = a * e - b * c;
      if (std::abs(det) < 1e-9) break;
      const Vec2 change{-(e * r->x - b * r->y) / det, -(a * r->y - c * r->x) / det};
      double part = 1;  // halved until it gains
      for (; part > 1e-3; part /= 2) {
        const auto there = miss(normalized(d + (basis.t * change.x + basis.b * change.y) * part), basis);
        if (there && norm(*there) < norm(*r)) break;
      }
      if (part <= 1e-3) break;
      d = normalized(d + (basis.t * change.x + basis.b * change.y) * part);
    }
  }
  return {};
}

bool passes(const Ball& ball, Vec3 from, Vec3 to) {
  const Vec3 d = normalized(to - from), o = ball.centre - from;
  const double along = dot(o, d);
  return along > 0 && along < norm(to - from) && norm(o - d * along) < ball.radius;
}
Rigid<frame::World, frame::Camera> looking(Vec3 from, Vec3 at, double roll) {
  const Vec3 z = normalized(at - from);
  const Basis basis(z);
  const Vec3 x = basis.t * std::cos(roll) + basis.b * std::sin(roll), y = cross(z, x);
  return {quaternion_of(Mat3{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}}), from};
}
class Maker {
 public:
  Maker(const WorldWish& wish, std::uint64_t seed) : wish_(wish), random_(seed, 77) {}
  std::vector<std::vector<Vec3>> layouts() {
    std::vector<std::vector<Vec3>> out;
    for (int p = 0; p < wish_.pieces; ++p) {
      const int kind = static_cast<int>(random_.below(3));  // a ball, a pot, a lid
      const double size = random_.uniform(0.03, 0.06);
      auto& layout = out.emplace_back();
      for (int tries = 0; static_cast<int>(layout.size()) < wish_.markers && tries < 100000; ++tries) {
        Vec3 c = direction_of(random_) * (size * random_.uniform(0.9, 1.15));
        const double turn = random_.uniform(0, 2 * pi), r = size * random_.uniform(0.9, 1.1);
        if (kind == 1) c = {r * std::cos(turn), r * std::sin(turn), random_.uniform(-size, size)};
        if (kind == 2)
          c = {r * std::cos(turn) * random_.uniform(0.2, 1.1), r * std::sin(turn), random_.uniform(-0.2, 0.2) * size};
        if (std::ranges::all_of(layout, [&](Vec3 o) { return norm(o - c) > 3 * wish_.marker_radius_m; }))
          layout.push_back(c);
      }
    }
    return out;
  }

  MarkerWorld world(const std::vector<std::vector<Vec3>>& layouts) {
    put_pieces(layouts);
    put_cameras();
    for (std::size_t v = 0; v < world_.views.size(); ++v) see(v);
    for (std::size_t v = 0; v < world_.views.size(); ++v) disturb(world_.views[v]);
    world_.wish.seed = 1;
    if (wish_.radius_known) world_.wish.radius_m = wish_.marker_radius_m;
    return std::move(world_);
  }

 private:
  void put_pieces(const std::vector<std::vector<Vec3>>& layouts) {
    const double about = layouts.size() > 1 ? 0.1 : 0.02, start = random_.uniform(0, 2 * pi);
    for (std::size_t p = 0; p < layouts.size(); ++p) {
      const double turn = start + 2 * pi * static_cast<double>(p) / static_cast<double>(layouts.size());
      const Vec3 place{about * std::cos(turn), about * std::sin(turn), random_.uniform(-0.02, 0.02)};
      world_.truth.push_back({quaternion_of_rotation_vector(direction_of(random_) * random_.uniform(0, pi)), place});
      double size = 1;
      for (const Vec3 c : layouts[p]) size = std::min(size, norm(c));
      bodies_.push_back({place, 0.85 * size});
      if (random_.uniform() < 0.5) bodies_.back().hollow = bodies_.back().radius - random_.uniform(0.0015, 0.004);
      world_.centres.push_back(layouts[p]);
      auto& piece = world_.pieces.emplace_back();
      piece.object = "piece" + std::to_string(p);
      for (const Vec3 c : layouts[p]) {
        const double s = wish_.tomograph_m;
        piece.markers.push_back({std::to_string(piece.markers.size()), c + normal3(random_) * s,
                                 wish_.radius_known ? wish_.marker_radius_m : 0,
                                 Mat3{{s * s, 0, 0, 0, s * s, 0, 0, 0, s * s}}});
      }
    }
    slab_ = {direction_of(random_), 0, random_.uniform(0.004, 0.012)};
    slab_.offset = random_.uniform(0, 0.02);
    slab_.centre = direction_of(random_) * 0.08;
    slab_.radius = random_.uniform(0.03, 0.08);
    mirror_ = normalized(Vec3{random_.normal(), random_.normal(), 0.3 * random_.normal()});
  }

  void put_cameras() {
    const Vec3 up = direction_of(random_);
    while (static_cast<int>(world_.views.size()) < wish_.views) {
      Vec3 d = direction_of(random_);
      if (dot(d, up) < 0) d = -d;
      if (wish_.clutter == Clutter::mirror && dot(d, mirror_) > 0) d = d - mirror_ * (2 * dot(d, mirror_));
      const Vec3 from = normalized(d + up * 0.3) * random_.uniform(0.85, 1.15);
      const double roll = random_.uniform(0, 2 * pi);
      const Vec3 sideways = looking(from, {}, roll).rotate({1, 0, 0});
      const int both = wish_.stereo && static_cast<int>(world_.views.size()) + 1 < wish_.views ? 2 : 1;
      const double baseline = random_.uniform(0.15, 0.3);
      for (int k = 0; k < both; ++k) {
        const Vec3 at = from + sideways * (baseline * k);
        View view;
        view.image = "image" + std::to_string(world_.views.size());
        view.world_from_camera = looking(at, normal3(random_) * 0.005, roll);
        world_.views.push_back(view);
      }
    }
    world_.origins.resize(world_.views.size());
  }

  void see(std::size_t v) {
    const Vec3 camera = world_.views[v].world_from_camera.translation_m;
    std::size_t shown = 0;
    for (std::size_t p = 0; p < world_.centres.size(); ++p)
      for (std::size_t k = 0; k < world_.centres[p].size(); ++k) {
        const Vec3 at = world_.truth[p] * world_.centres[p][k];
        if (random_.uniform() >= wish_.missing) shown += look_at(v, at, {SeenAs::directly, p, k});
        if (wish_.clutter == Clutter::mirror && random_.uniform() < 0.8) {
          const Vec3 virtual_at = at + mirror_ * (2 * (0.2 - dot(at, mirror_)));
          add(v, normalized(virtual_at - camera), std::asin(wish_.marker_radius_m / norm(virtual_at - camera)),
              {SeenAs::reflected, p, k});
        }
      }
    const auto extra = static_cast<int>(std::lround(wish_.falsely * static_cast<double>(shown)));
    for (int i = 0; i < extra; ++i) {
      const Vec3 at = direction_of(random_) * 0.16;
      const double half = std::asin(wish_.marker_radius_m / norm(at - camera)) * random_.uniform(0.85, 1.15);
      add(v, normalized(at - camera), half, {});
    }
  }

  // Directly, through what lies before it, or not at all. Was it seen?
  bool look_at(std::size_t v, Vec3 at, Origin origin) {
    const Vec3 camera = world_.views[v].world_from_camera.translation_m;
    Optics optics;
    Vec3 middle = at;
    if (wish_.body_hides)
      for (const Ball& body : bodies_)
        if (passes(body, camera, at)) {
          if (wish_.clutter != Clutter::glass_ball) return false;
          optics = [&](TracedRay ray) { return through(body, ray); };
          middle = body.centre;
        }
    if (wish_.clutter == Clutter::slab) {
      const double a = dot(at, slab_.normal) - slab_.offset, b = dot(camera, slab_.normal) - slab_.offset;
      const Vec3 hit = at + (camera - at) * (a / (a - b)), off = hit - slab_.centre;
      const bool inside = norm(off - slab_.normal * dot(off, slab_.normal)) < slab_.radius;
      if (a < 0 && b > slab_.thickness && inside) optics = [&](TracedRay ray) { return through(slab_, ray); };
    }
    if (!optics) {
      add(v, normalized(at - camera), std::asin(wish_.marker_radius_m / norm(at - camera)), origin);
      return true;
    }
    origin.how = SeenAs::refracted;
    const auto axis = apparent(camera, at, middle, optics);
    if (!axis) return false;
    const Basis basis(*axis);
    const auto one = apparent(camera, at + basis.t * wish_.marker_radius_m, middle, optics),
               two = apparent(camera, at - basis.t * wish_.marker_radius_m, middle, optics);
    if (!one || !two) return false;
    add(v, *axis, std::acos(std::clamp(dot(*one, *two), -1.0, 1.0)) / 2, origin);
    return true;
  }

  void add(std::size_t v, Vec3 direction, double half_angle, Origin origin) {
    const Vec3 axis = inverse(world_.views[v].world_from_camera).rotate(direction);
    if (axis.z < 0.5) return;
    const double s = wish_.noise_px / wish_.focal_px, stretch = random_.uniform(1, 1.4),
                 with = random_.uniform(-0.3, 0.3);
    // L of the covariance of (across, down, half angle).
    const std::array<double, 3> n{random_.normal(), random_.normal(), random_.normal()};
    const double du = s * n[0], dv = s * stretch * n[1], dh = 0.7 * s * (with * n[0] + n[2]);
    Outline o;
    const Vec3 across = reassembly::across_of(axis), down = cross(axis, across);
    o.axis = normalized(axis + across * du + down * dv);
    o.half_angle_rad = half_angle + dh;
    const double uh = 0.7 * s * s * with;
    o.covariance_rad2 = {{s * s, 0, uh, 0, s * s * stretch * stretch, 0, uh, 0, 0.49 * s * s * (1 + with * with)}};
    o.centre_px = {wish_.focal_px * o.axis.x / o.axis.z + 1688, wish_.focal_px * o.axis.y / o.axis.z + 1352};
    o.radius_px = wish_.focal_px * half_angle;
    o.cover = 1;
    world_.views[v].outlines.push_back(o);
    world_.origins[v].push_back(origin);
  }

  // The pose that the solver is given, with its covariance: correlated, and different in each direction.
  void disturb(View& view) {
    if (wish_.camera_m <= 0 && wish_.camera_rad <= 0) return;
    std::array<double, 36> root{};
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j <= i; ++j)
        root[6 * i + j] = (i < 3 ? wish_.camera_rad : wish_.camera_m) *
                          (i == j ? random_.uniform(0.6, 1.2) : random_.uniform(-0.3, 0.3));
    std::array<double, 6> n, off{};
    for (double& x : n) x = random_.normal();
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j) {
        off[i] += root[6 * i + j] * n[j];
        for (std::size_t k = 0; k < 6; ++k) view.covariance[6 * i + j] += root[6 * i + k] * root[6 * j + k];
      }
    auto& pose = view.world_from_camera;
    pose.rotation = normalized(quaternion_of_rotation_vector({off[0], off[1], off[2]}) * pose.rotation);
    pose.translation_m += {off[3], off[4], off[5]};
  }

  WorldWish wish_;
  Random random_;
  MarkerWorld world_;
  std::vector<Ball> bodies_;
  Slab slab_;
  Vec3 mirror_;
};
}  // namespace

WorldWish random_wish(std::uint64_t seed) {
  Random random(seed, 5);
  WorldWish w;
  w.views = 2 + static_cast<int>(random.below(11));
  w.pieces = 1 + static_cast<int>(random.below(3));
  w.markers = 4 + static_cast<int>(random.below(17));
  w.stereo = random.uniform() < 0.6;
  w.noise_px = random.uniform(0.1, 0.5);
  w.missing = random.uniform(0, 0.4);
  w.falsely = random.uniform(0, 0.4);
  const double what = random.uniform();
  w.clutter = what < 0.35  ? Clutter::none
              : what < 0.6 ? Clutter::glass_ball
              : what < 0.8 ? Clutter::slab
                           : Clutter::mirror;
  w.tomograph_m = random.uniform(5e-6, 5e-5);
  if (random.uniform() < 0.5) w.camera_m = random.uniform(2e-5, 1e-4), w.camera_rad = random.uniform(2e-5, 1e-4);
  w.marker_radius_m = random.uniform(0.002, 0.004);
  w.radius_known = random.uniform() < 0.7;
  return w;
}

MarkerWorld make_world(const WorldWish& wish, std::uint64_t seed) {
  Maker maker(wish, seed);
  const auto layouts = maker.layouts();
  return maker.world(layouts);
}
MarkerWorld make_world(const WorldWish& wish, const std::vector<std::vector<Vec3>>& layouts, std::uint64_t seed) {
  return Maker(wish, seed).world(layouts);
}

Unique unique_layout(const MarkerWorld& world, std::size_t piece, double tolerance) {
  std::vector<Vec3> points, own;
  std::vector<std::size_t> which;
  std::size_t seen = 0;
  for (std::size_t p = 0; p < world.pieces.size(); ++p)
    for (std::size_t k = 0; k < world.centres[p].size(); ++k) {
      int views = 0;
      for (std::size_t v = 0; v < world.views.size(); ++v)
        views += std::ranges::any_of(world.origins[v], [&](const Origin& o) {
          return o.how == SeenAs::directly && o.piece == p && o.marker == k;
        });
      if (views < 2) continue;
      points.push_back(world.truth[p] * world.centres[p][k]);
      if (p == piece) ++seen, which.push_back(k);
    }
  const auto& markers = world.centres[piece];
  Unique out{seen, seen >= 3};
  const auto frame_of = [](Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 x = normalized(b - a), z = normalized(cross(b - a, c - a));
    return std::array{x, cross(z, x), z};
  };
  for (std::size_t i = 0; out.only && i < markers.size(); ++i)
    for (std::size_t j = i + 1; out.only && j < markers.size(); ++j)
      for (std::size_t a = 0; out.only && a < points.size(); ++a)
        for (std::size_t b = 0; out.only && b < points.size(); ++b) {
          const double ij = norm(markers[i] - markers[j]);
          if (a == b || std::abs(ij - norm(points[a] - points[b])) > tolerance) continue;
          for (std::size_t k = j + 1; out.only && k < markers.size(); ++k)
            for (std::size_t c = 0; out.only && c < points.size(); ++c) {
              if (std::abs(norm(markers[i] - markers[k]) - norm(points[a] - points[c])) > tolerance ||
                  std::abs(norm(markers[j] - markers[k]) - norm(points[b] - points[c])) > tolerance)
                continue;
              const auto m = frame_of(markers[i], markers[j], markers[k]),
                         w = frame_of(points[a], points[b], points[c]);
              std::size_t hits = 0;
              double off = 0;
              for (std::size_t n = 0; n < markers.size(); ++n) {
                const Vec3 d = markers[n] - markers[i];
                const Vec3 at = points[a] + w[0] * dot(d, m[0]) + w[1] * dot(d, m[1]) + w[2] * dot(d, m[2]);
                hits += std::ranges::any_of(points, [&](Vec3 q) { return norm(q - at) < 2 * tolerance; });
                off = std::max(off, norm(at - world.truth[piece] * markers[n]));
              }
              if (off > 10 * tolerance && hits >= seen) out.only = false;
            }
        }
  return out;
}

}  // namespace gonio::tests
