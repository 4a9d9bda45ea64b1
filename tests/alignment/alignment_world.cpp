// See alignment_world.h.
#include "alignment/alignment_world.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>

#include "alignment/mask_regions.h"

namespace gonio::alignment::testing {
namespace {

Solid globe(const char* name, int around, int down, const std::function<Vec3(double, double)>& place) {
  Solid s{.name = name};
  for (int i = 0; i <= down; ++i)
    for (int j = 0; j < around; ++j) s.positions_m.push_back(place(pi * i / down, 2 * pi * j / around));
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * around + j % around); };
  for (int i = 0; i < down; ++i)
    for (int j = 0; j < around; ++j) {
      s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return s;
}

using Hole = std::array<int, 4>;  // x from, to, y from, to

// Blocks of a grid, their outer faces; each hole through it makes one handle.
Solid plate(const char* name, std::array<int, 3> n, const std::vector<Hole>& holes,
            const std::function<Vec3(Vec3)>& bend) {
  Solid s{.name = name, .genus = static_cast<int>(holes.size())};
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<int, 3> p) {
    const auto [it, fresh] = known.try_emplace(p, static_cast<std::uint32_t>(s.positions_m.size()));
    if (fresh) s.positions_m.push_back(bend(Vec3{1.0 * p[0], 1.0 * p[1], 1.0 * p[2]} / n[0]));
    return it->second;
  };
  const auto solid = [&](std::array<int, 3> p) {
    for (int k = 0; k < 3; ++k)
      if (p[k] < 0 || p[k] >= n[k]) return false;
    return std::none_of(holes.begin(), holes.end(),
                        [&](const Hole& h) { return p[0] >= h[0] && p[0] < h[1] && p[1] >= h[2] && p[1] < h[3]; });
  };
  for (int x = 0; x < n[0]; ++x)
    for (int y = 0; y < n[1]; ++y)
      for (int z = 0; z < n[2]; ++z) {
        if (!solid({x, y, z})) continue;
        for (int axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beside{x, y, z};
            beside[axis] += side == 1 ? 1 : -1;
            if (solid(beside)) continue;
            std::array<std::array<int, 3>, 4> c;
            for (int k = 0; k < 4; ++k) {
              c[k] = {x, y, z};
              c[k][axis] += side;
              c[k][(axis + 1) % 3] += k == 1 || k == 2;
              c[k][(axis + 2) % 3] += k >= 2;
            }
            if (side == 0) std::swap(c[1], c[3]);
            const std::uint32_t a = vertex(c[0]), b = vertex(c[1]), d = vertex(c[2]), e = vertex(c[3]);
            s.triangles.push_back({a, b, d}), s.triangles.push_back({a, d, e});
          }
      }
  return s;
}

// Twisted and bent, so that no two sides are alike.
std::function<Vec3(Vec3)> bent(double k) {
  return [k](Vec3 v) {
    v = v - Vec3{0.5, 0.3, 0.1};
    const double a = 1.1 * v.x + 0.3 * k, y = v.y * (1 + 0.5 * v.x),
                 z = v.z * (1 - 0.3 * v.x) + 0.25 * v.x * v.x * (1 + 0.1 * k);
    return Vec3{v.x, std::cos(a) * y - std::sin(a) * z, std::sin(a) * y + std::cos(a) * z} * 0.13;
  };
}

double lowest(const Body& body) {
  double low = HUGE_VAL;
  for (const Vec3 p : body.shape->positions_m()) low = std::min(low, body.place_m(p).z);
  return low;
}

// A smooth random field of the given standard deviation: independent at nodes `cell` pixels apart, interpolated.
class Field {
 public:
  Field(int size, double cell, double sigma, std::mt19937_64& random)
      : nodes_(static_cast<int>(size / cell) + 4), cell_(cell), value_(static_cast<std::size_t>(nodes_) * nodes_) {
    std::normal_distribution<double> normal;
    for (double& v : value_) v = sigma * normal(random);
  }
  double at(double x, double y) const {
    const double u = x / cell_ + 1, v = y / cell_ + 1;
    const int i = std::clamp(static_cast<int>(std::floor(u)), 0, nodes_ - 2),
              k = std::clamp(static_cast<int>(std::floor(v)), 0, nodes_ - 2);
    const double a = u - i, b = v - k;
    const std::array<double, 4> w{(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
    const auto node = [&](int di, int dk) { return value_[static_cast<std::size_t>(k + dk) * nodes_ + i + di]; };
    return (w[0] * node(0, 0) + w[1] * node(1, 0) + w[2] * node(0, 1) + w[3] * node(1, 1)) /
           std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
  }

 private:
  int nodes_;
  double cell_;
  std::vector<double> value_;
};

}  // namespace

Labels photographed(const Setting& setting, std::size_t station, std::size_t lamp, const WorldWish& wish,
                    std::mt19937_64& random) {
  constexpr int fine = 4;
  const int n = wish.size_px;
  const auto body = filled(setting, {station, 0, {}}, n, n, fine),
             dark = filled(setting, {station, 0, lamp}, n, n, fine);
  const Field dx(n, 4, wish.error_px, random), dy(n, 4, wish.error_px, random);
  Labels labels{std::vector<std::uint8_t>(static_cast<std::size_t>(n) * n)};
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      int of_object = 0, of_shadow = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const double u = x + (k % fine - 1.5) / fine, v = y + (k / fine - 1.5) / fine;
        const long i = std::lround((u + dx.at(u, v) + 0.5) * fine - 0.5),
                   j = std::lround((v + dy.at(u, v) + 0.5) * fine - 0.5);
        if (i < 0 || j < 0 || i >= n * fine || j >= n * fine) continue;
        const auto place = static_cast<std::size_t>(j) * n * fine + static_cast<std::size_t>(i);
        if (body[place])
          ++of_object;
        else if (dark[place])
          ++of_shadow;
      }
      const int tie = static_cast<int>(random() % 2);
      labels.of[static_cast<std::size_t>(y) * n + x] = 2 * of_object + tie > fine * fine                 ? object
                                                       : 2 * (of_object + of_shadow) + tie > fine * fine ? shadow
                                                                                                         : ground;
    }
  // Blobs seven pixels wide on rims, as many as spoil that share of them.
  std::vector<int> rim;
  for (int y = 1; y < n - 1; ++y)
    for (int x = 1; x < n - 1; ++x) {
      const int c = y * n + x;
      if (labels.of[c] != ground && (labels.of[c + 1] == ground || labels.of[c - 1] == ground ||
                                     labels.of[c + n] == ground || labels.of[c - n] == ground))
        rim.push_back(c);
    }
  std::poisson_distribution<int> blobs(std::max(1e-9, wish.outliers * static_cast<double>(rim.size()) / 6));
  for (int b = wish.outliers > 0 ? blobs(random) : 0; b > 0 && !rim.empty(); --b) {
    const int c = rim[random() % rim.size()], x0 = c % n, y0 = c / n;
    const std::uint8_t label = labels.of[c], to = random() % 2 ? label : ground, from = to == ground ? label : ground;
    for (int y = std::max(0, y0 - 3); y <= std::min(n - 1, y0 + 3); ++y)
      for (int x = std::max(0, x0 - 3); x <= std::min(n - 1, x0 + 3); ++x)
        if ((x - x0) * (x - x0) + (y - y0) * (y - y0) <= 10 && labels.of[y * n + x] == from) labels.of[y * n + x] = to;
  }
  return labels;
}

void add_rims(World& world, const Labels& labels, std::size_t station, std::size_t lamp, const WorldWish& wish) {
  const int n = wish.size_px;
  std::vector<MaskRegions::Mask> masks;
  for (const std::uint8_t what : {object, shadow}) {
    MaskRegions::Mask mask{what, "solid", "mask", what == shadow, std::vector<float>(labels.of.size()), true};
    for (std::size_t i = 0; i < labels.of.size(); ++i) mask.share[i] = labels.of[i] == what ? 1.0F : 0.0F;
    masks.push_back(std::move(mask));
  }
  const auto regions = std::make_shared<const MaskRegions>(n, n, std::move(masks));
  for (const std::uint8_t what : {object, shadow}) {
    if (what == object && lamp > 0) continue;
    SeenRim rim{what, "view", 1.2, regions->rim(what, 1.2, false)};
    RimSubject subject{station, 0, {}};
    if (what == shadow) subject.lamp = lamp;
    const auto unseen = [regions, what](Vec2 p) { return regions->hides(what, p); };
    world.input.question.sightings.push_back({subject, rim.in_picture, unseen});
    world.input.rims.push_back(std::move(rim));
  }
}

namespace {

Vec3 direction(double azimuth, double height) {
  return {std::cos(azimuth) * std::cos(height), std::sin(azimuth) * std::cos(height), std::sin(height)};
}

Rigid<frame::World, frame::Camera> looking(Vec3 eye, Vec3 aim) {
  const Vec3 z = normalized(aim - eye), x = normalized(cross(z, {0, 0, 1})), y = cross(z, x);
  return {quaternion_of(Mat3{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}}), eye};
}

}  // namespace

const std::vector<Solid>& solids() {
  static const std::vector<Solid> all = [] {
    std::vector<Solid> s;
    s.push_back(globe("blob", 80, 48, [](double t, double p) {
      const double r = 0.05 * (1 + 0.25 * std::sin(t) * std::cos(p + 0.4) * std::sin(2 * t) +
                               0.18 * std::sin(3 * p + 1) * std::pow(std::sin(t), 3) + 0.22 * std::cos(2 * t + 0.7) +
                               0.12 * std::sin(2 * p) * std::sin(t) * std::sin(t));
      return Vec3{r * std::sin(t) * std::cos(p), 1.2 * r * std::sin(t) * std::sin(p), 0.9 * r * std::cos(t)};
    }));
    s.push_back(globe("vase", 96, 60, [](double t, double p) {
      const double z = -std::cos(t), r = 0.03 * std::sin(t) * (1 + 0.35 * std::sin(4 * z + 0.6));
      return Vec3{r * std::cos(p), r * std::sin(p), 0.055 * z};
    }));
    s.back().symmetric = true;
    s.push_back(plate("brick", {12, 8, 5}, {}, [](Vec3 v) { return (v - Vec3{0.5, 1.0 / 3, 5.0 / 24}) * 0.1; }));
    s.back().symmetric = true;
    s.push_back(plate("one", {24, 15, 5}, {{6, 15, 4, 11}}, bent(0)));
    s.push_back(plate("two", {24, 15, 5}, {{3, 9, 4, 11}, {13, 21, 3, 9}}, bent(1)));
    s.push_back(plate("three", {24, 15, 5}, {{3, 9, 4, 11}, {12, 16, 3, 6}, {13, 21, 9, 13}}, bent(2)));
    s.push_back(plate("four", {24, 15, 5}, {{2, 6, 3, 6}, {2, 8, 9, 13}, {10, 14, 3, 11}, {17, 22, 5, 9}}, bent(3)));
    s.push_back(plate("five", {24, 15, 5},
                      {{2, 6, 3, 6}, {2, 8, 9, 13}, {10, 14, 3, 6}, {11, 16, 9, 12}, {18, 22, 4, 10}}, bent(4)));
    return s;
  }();
  return all;
}

std::vector<std::uint8_t> filled(const Setting& setting, const RimSubject& subject, int width, int height, int factor) {
  const int w = width * factor, h = height * factor;
  std::vector<std::uint8_t> out(static_cast<std::size_t>(w) * h);
  const Body& body = setting.bodies[subject.body];
  for (std::size_t t = 0; t < body.shape->triangles(); ++t) {
    std::array<Vec2, 3> q;
    bool seen = true;
    for (int i = 0; i < 3; ++i) {
      const Vec3 p = body.place_m(body.shape->positions_m()[body.shape->triangle(t)[i]]);
      const Projected at = subject.lamp ? project_shadow(setting, subject.station, *subject.lamp, p)
                                        : project(setting, subject.station, p);
      seen = seen && at.weight > 0;
      q[i] = (at.pixel + Vec2{0.5, 0.5}) * factor - Vec2{0.5, 0.5};
    }
    const auto area = [](Vec2 a, Vec2 b, double x, double y) {
      return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    };
    if (!seen) continue;
    if (area(q[0], q[1], q[2].x, q[2].y) < 0) std::swap(q[1], q[2]);
    const auto [x0, x1] = std::minmax({q[0].x, q[1].x, q[2].x});
    const auto [y0, y1] = std::minmax({q[0].y, q[1].y, q[2].y});
    for (int y = std::max(0, static_cast<int>(std::ceil(y0))); y <= std::min(h - 1, static_cast<int>(std::floor(y1)));
         ++y)
      for (int x = std::max(0, static_cast<int>(std::ceil(x0))); x <= std::min(w - 1, static_cast<int>(std::floor(x1)));
           ++x)
        if (area(q[0], q[1], x, y) >= 0 && area(q[1], q[2], x, y) >= 0 && area(q[2], q[0], x, y) >= 0)
          out[static_cast<std::size_t>(y) * w + x] = 1;
  }
  return out;
}

namespace {

void photograph_all(World& world, const WorldWish& wish, std::mt19937_64& random) {
  for (std::size_t v = 0; v < world.truth.stations.size(); ++v)
    for (std::size_t l = 0; l < world.truth.lamps_m.size(); ++l) {
      Labels labels = photographed(world.truth, v, l, wish, random);
      if (wish.spoil) wish.spoil(labels, v, random);
      add_rims(world, labels, v, l, wish);
    }
}

}  // namespace

World world_of(const WorldWish& wish) {
  const Solid& solid = solids()[wish.solid];
  std::mt19937_64 random(wish.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  World world;
  world.input.shapes.emplace_back(solid.positions_m, solid.triangles);
  Setting& s = world.truth;
  s.ground = Ground{};
  const double focal = wish.size_px / 0.48, middle = 0.5 * (wish.size_px - 1);
  s.lenses = {{focal, focal, middle, middle}};
  world.input.models.emplace_back(camera::Intrinsics{focal, focal, middle, middle, {}}, wish.size_px, wish.size_px);
  s.bodies = {{&world.input.shapes.back(),
               {normalized(Quaternion{normal(random), normal(random), normal(random), normal(random)}), {}},
               {1, 1, 1}}};
  if (wish.scale_sigma > 0)
    s.bodies[0].scale = Vec3{1 + wish.scale_sigma * normal(random), 1 + wish.scale_sigma * normal(random),
                             1 + wish.scale_sigma * normal(random)};
  s.bodies[0].world_from_object.translation_m.z -= lowest(s.bodies[0]);
  const Vec3 centre = s.bodies[0].centre_m();
  const double radius = world.input.shapes.back().radius_m();
  for (int v = 0; v < wish.views; ++v) {
    const Vec3 eye = centre + direction(2 * pi * uniform(random), 0.35 + 0.6 * uniform(random)) * (9 * radius);
    s.stations.push_back({looking(eye, centre + Vec3{0.004 * normal(random), 0.004 * normal(random), 0}), 0});
    world.input.images_of_station.push_back({"view " + std::to_string(v)});
  }
  for (int l = 0; l < wish.lamps; ++l) {
    const Vec3 towards = direction(2 * pi * uniform(random), 0.7 + 0.6 * uniform(random));
    s.lamps_m.push_back(centre + towards * (radius * (5 + 5 * uniform(random))));
    world.input.lamps.push_back("lamp " + std::to_string(l)), world.input.lamp_stated.push_back(true);
  }
  world.input.bodies = {"solid"}, world.input.cameras = {"camera"};
  photograph_all(world, wish, random);
  Question& q = world.input.question;
  q.freedoms = {{Block::body_turn, 0}, {Block::body_shift, 0}};
  if (wish.scale_sigma > 0) q.freedoms.push_back({Block::body_scale, 0, wish.scale_sigma});
  for (std::size_t l = 0; l < s.lamps_m.size(); ++l) q.freedoms.push_back({Block::lamp_shift, l});
  q.contacts = {{0, 1e-4}};
  Setting start = s;
  start.bodies[0].scale = {1, 1, 1};
  if (wish.from_nothing) {
    start.bodies[0].world_from_object = {};
    for (Vec3& lamp : start.lamps_m) lamp = {0, 0, 1};
  } else {
    const auto any = [&](double length) {
      return normalized(Vec3{normal(random), normal(random), normal(random)}) * length;
    };
    std::vector<double> change(numbers_of(q.freedoms), 0);
    const Vec3 turn = any(5 * pi / 180), shift = any(0.01);
    for (int k = 0; k < 3; ++k) change[k] = turn[k], change[3 + k] = shift[k];
    start = moved(start, q.freedoms, change);
    for (Vec3& lamp : start.lamps_m) lamp += any(0.01);
  }
  world.input.stated = q.stated = start;
  return world;
}

Miss miss_of(const World& world, const Fitted& fitted) {
  Miss miss;
  miss.error = change_between(fitted.setting, world.truth, world.input.question.freedoms);
  for (std::size_t i = 0; i < miss.error.size(); ++i)
    miss.sigma.push_back(std::sqrt(fitted.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i))));
  miss.turn_rad = norm(Vec3{miss.error[0], miss.error[1], miss.error[2]});
  miss.shift_m = norm(Vec3{miss.error[3], miss.error[4], miss.error[5]});
  return miss;
}

}  // namespace gonio::alignment::testing
