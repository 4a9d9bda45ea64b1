// See traced_scene.h. Shirley, Wang & Zimmerman 1996 for the lamp's solid angle.
#include "sealed/traced_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"

namespace gonio::sealed {
namespace {

constexpr double near_m = 1e-6, far_m = 1e9;

struct Hit {
  double way = far_m;
  Vec3 point, normal;
  std::size_t matter = 0;
  bool table = false;
};

double ball_way(const Ball& b, Vec3 o, Vec3 d) {
  const Vec3 to = o - b.centre;
  const double half = dot(to, d), rest = dot(to, to) - b.radius * b.radius, root = half * half - rest;
  if (root < 0) return far_m;
  const double first = -half - std::sqrt(root), second = -half + std::sqrt(root);
  return first > near_m ? first : second > near_m ? second : far_m;
}

double box_way(const Scene& s, Vec3 o, Vec3 d, int& axis) {
  double in = -far_m, out = far_m;
  axis = -1;
  int in_axis = -1, out_axis = -1;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < s.box_lower[k] || o[k] > s.box_upper[k]) return far_m;
      continue;
    }
    double a = (s.box_lower[k] - o[k]) / d[k], b = (s.box_upper[k] - o[k]) / d[k];
    if (a > b) std::swap(a, b);
    if (a > in) in = a, in_axis = k;
    if (b < out) out = b, out_axis = k;
  }
  if (in > out) return far_m;
  axis = in > near_m ? in_axis : out_axis;
  return in > near_m ? in : out > near_m ? out : far_m;
}

bool wire_hides(const Wire& w, Vec3 o, Vec3 d, double way) {
  if (!(w.radius > 0)) return false;
  const Vec3 along = normalized(w.to - w.from), across = cross(d, along);
  const double sine = norm(across);
  if (sine < 1e-9) return false;
  const Vec3 gap = w.from - o;
  if (std::abs(dot(gap, across)) / sine > w.radius) return false;
  const double t = dot(cross(gap, along), across) / (sine * sine), u = dot(cross(gap, d), across) / (sine * sine);
  return t > near_m && t < way && u > 0 && u < norm(w.to - w.from);
}

std::optional<Hit> nearest(const Scene& s, Vec3 o, Vec3 d) {
  Hit h;
  for (const Ball& b : s.balls)
    if (const double way = ball_way(b, o, d); way < h.way) {
      h = {way, o + d * way, {}, b.matter, false};
      h.normal = (h.point - b.centre) / b.radius;
    }
  if (s.box_lower.x < s.box_upper.x) {
    int axis = -1;
    if (const double way = box_way(s, o, d, axis); way < h.way) {
      const double sign = d[axis] > 0 ? -1 : 1;
      h = {way, o + d * way, {axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0}, s.box_matter, false};
    }
  }
  if (d.z != 0) {
    const double way = -o.z / d.z;
    const Vec3 p = o + d * way;
    if (way > near_m && way < h.way && std::abs(p.x) < s.table_half && std::abs(p.y) < s.table_half)
      h = {way, p, {0, 0, d.z < 0 ? 1.0 : -1.0}, s.table_matter, true};
  }
  if (h.way >= far_m) return {};
  return h;
}

bool visible(const Scene& s, Vec3 from, Vec3 to) {
  const Vec3 way = to - from;
  const double length = norm(way);
  const Vec3 d = way / length;
  for (const Ball& b : s.balls)
    if (ball_way(b, from, d) < length) return false;
  int axis = -1;
  if (s.box_lower.x < s.box_upper.x && box_way(s, from, d, axis) < length) return false;
  return !wire_hides(s.wire, from, d, length);
}

// Two axes across a unit vector.
std::array<Vec3, 2> across(Vec3 n) {
  const Vec3 a = normalized(cross(std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, n));
  return {a, cross(n, a)};
}

Rgb sent_back(const Scene& s, const Hit& h, Vec3 wi, Vec3 wo, const Polarized& light = {}) {
  const Matter& m = s.matters[h.matter];
  const Vec3 lay = h.table ? Vec3{std::cos(s.table_lay), std::sin(s.table_lay), 0} : across(h.normal)[0];
  const Scattering f = scatter(m, h.normal, lay, wi, wo, light);
  Rgb result = m.albedo * f.base;
  result += {f.coat, f.coat, f.coat};
  if (h.table && s.stain.depth != 0) {
    const Vec3 off = h.point - s.stain.centre;
    result *= 1 - s.stain.depth * std::exp(-0.5 * dot(off, off) / (s.stain.radius * s.stain.radius));
  }
  return result;
}

// Radiance towards wo of one lamp's direct light: the lamp's cap of directions is sampled evenly (u, v in [0, 1)).
Rgb by_lamp(const Scene& s, const Hit& h, const Lamp& lamp, Vec3 wo, double u, double v) {
  const Vec3 to = lamp.position - h.point;
  const double d2 = dot(to, to), d = std::sqrt(d2);
  Vec3 wi = to / d;
  double arrives = d2, cap = 0;  // intensity over arrives = irradiance at right angles
  if (lamp.radius > 0) {
    const double cos_edge = std::sqrt(std::max(0.0, 1 - lamp.radius * lamp.radius / d2));
    const double c = 1 - u * (1 - cos_edge), sine = std::sqrt(std::max(0.0, 1 - c * c));
    const auto [a, b] = across(wi);
    wi = wi * c + a * (sine * std::cos(2 * pi * v)) + b * (sine * std::sin(2 * pi * v));
    cap = 2 * pi * (1 - cos_edge);
    arrives = pi * lamp.radius * lamp.radius / cap;  // radiance I / (pi r^2) over the cap
  }
  const double cosine = dot(h.normal, wi);
  if (cosine <= 0 || dot(h.normal, wo) <= 0) return {};
  const Vec3 from = h.point + h.normal * near_m;
  if (!visible(s, from, lamp.radius > 0 ? from + wi * (d - lamp.radius) : lamp.position)) return {};
  return lamp.intensity * sent_back(s, h, wi, wo, lamp.light) * (cosine / arrives);
}

// Where the samples of a pixel lie: Richtmyer's sequence, frac(k sqrt(prime)), turned by a shift of the pixel's own.
// The same whichever effects act, so that pictures with and without one differ by it and by no noise.
class Places {
 public:
  Places(std::uint64_t seed, std::uint64_t pixel) {
    Random random(seed, pixel);
    for (double& s : shift_) s = random.uniform();
  }
  std::array<double, 2> of(int sample, std::size_t pair) const {
    return {coordinate(sample, 2 * pair), coordinate(sample, 2 * pair + 1)};
  }
  enum : std::size_t { in_pixel, in_pupil, on_lamp, bounces };  // pairs; each bounce takes two: way, point on the lamps

 private:
  double coordinate(int sample, std::size_t d) const {
    static const std::array<double, 30> steps = [] {
      static constexpr std::array<int, 30> primes{2,  3,  5,  7,  11, 13, 17, 19, 23, 29, 31,  37,  41,  43,  47,
                                                  53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107, 109, 113};
      std::array<double, 30> s{};
      for (std::size_t k = 0; k < s.size(); ++k) s[k] = std::sqrt(primes[k]);
      return s;
    }();
    const double x = shift_[d] + sample * steps[d];
    return x - static_cast<double>(static_cast<std::int64_t>(x));
  }
  std::array<double, 30> shift_{};
};
constexpr int most_bounces = 6;

// By one point of every lamp.
Rgb direct(const Scene& s, const Hit& h, Vec3 wo, std::array<double, 2> place) {
  Rgb sum;
  for (const Lamp& lamp : s.lamps) sum += by_lamp(s, h, lamp, wo, place[0], place[1]);
  return sum;
}

// Light by way of other surfaces and from the surroundings: cosine-distributed directions off the matte base.
Rgb indirect(const Scene& s, Hit h, Vec3 wo, const Places& places, int sample) {
  Rgb weight{1, 1, 1}, sum;
  for (std::size_t bounce = 0; bounce < most_bounces; ++bounce) {
    const auto [u, v] = places.of(sample, Places::bounces + 2 * bounce);
    const auto [a, b] = across(h.normal);
    const Vec3 wi = h.normal * std::sqrt(1 - u) + a * (std::sqrt(u) * std::cos(2 * pi * v)) +
                    b * (std::sqrt(u) * std::sin(2 * pi * v));
    if (dot(h.normal, wi) < 1e-4 || dot(h.normal, wo) < 1e-4) break;
    weight *= sent_back(s, h, wi, wo) * pi;
    const std::optional<Hit> next = nearest(s, h.point + h.normal * near_m, wi);
    if (!next) {
      sum += weight * s.ambient;
      break;
    }
    if (!s.indirect) break;
    h = *next;
    wo = -wi;
    sum += weight * direct(s, h, wo, places.of(sample, Places::bounces + 2 * bounce + 1));
  }
  return sum;
}

}  // namespace

Eye eye_at(Vec3 position, Vec3 target, double focal_px, int size) {
  Eye e{position, {}, {}, normalized(target - position), focal_px, size, size};
  e.right = normalized(cross(e.forward, {0, 0, 1}));
  e.down = cross(e.forward, e.right);
  return e;
}

Seen look(const Scene& s, const Eye& eye, int x, int y, int samples, std::uint64_t seed) {
  const Places places(seed, static_cast<std::uint64_t>(y * eye.width + x));
  Seen seen{{}, std::vector<Rgb>(s.matters.size())};
  const bool scattered = s.indirect || max_component(s.ambient) > 0;
  for (int k = 0; k < samples; ++k) {
    const auto [u, v] = places.of(k, Places::in_pixel);
    Vec3 d = eye.right * ((x - 0.5 + u - 0.5 * (eye.width - 1)) / eye.focal_px) +
             eye.down * ((y - 0.5 + v - 0.5 * (eye.height - 1)) / eye.focal_px) + eye.forward;
    Vec3 from = eye.position;
    if (eye.pupil_m > 0) {
      const auto [out, around] = places.of(k, Places::in_pupil);
      const double r = eye.pupil_m * std::sqrt(out), a = 2 * pi * around;
      const Vec3 offset = eye.right * (r * std::cos(a)) + eye.down * (r * std::sin(a));
      d = d * eye.focus_m - offset, from += offset;
    }
    d = normalized(d);
    const std::optional<Hit> h = nearest(s, from, d);
    if (!h) {
      seen.radiance += s.ambient / samples;
      continue;
    }
    Rgb radiance = direct(s, *h, -d, places.of(k, Places::on_lamp));
    if (scattered) radiance += indirect(s, *h, -d, places, k);
    seen.of_matter[h->matter] += radiance / samples;
    seen.radiance += radiance / samples;
  }
  return seen;
}

}  // namespace gonio::sealed
