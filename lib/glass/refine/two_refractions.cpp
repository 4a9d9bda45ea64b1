// See two_refractions.h.
#include "glass/refine/two_refractions.h"

#include <cmath>

#include "optics/mueller_algebra.h"
#include "render/polarized_carrier.h"
#include "surface/refraction.h"

namespace gonio::glass {
namespace {

using optics::Mueller;
using optics::Stokes;

constexpr double difference = 1e-5;  // cells; of slopes, the index, the absorption alike

// Light of the screen that travels along `travel` in the frame (x, d x x, d).
Stokes emitted(const light::Emitter& emitter, Vec3 travel, double radiance, Vec3& x) {
  const auto polarization = emitter.polarization(travel);
  x = polarization ? polarization->x : Basis(travel).t;
  return (polarization ? polarization->stokes : Stokes{{1, 0, 0, 0}}) * radiance;
}

void add(const Stokes& light, Vec3 travel, Vec3 frame_x, Vec3 camera_x, std::array<double, 3>& stokes) {
  const Vec3 picture_x = render::polarization_axis(camera_x, travel);
  const Stokes seen = optics::frame_change(travel, frame_x, picture_x) * light;
  for (std::size_t k = 0; k < 3; ++k) stokes[k] += seen.s[k];
}

void add_reflection(const PixelRay& ray, Vec3 place, Vec3 outward, double index, const ScreenPicture& screen,
                    const light::Emitter& emitter, double blur_px, std::array<double, 3>& stokes) {
  const double c = -dot(ray.direction, outward);
  const Vec3 back = ray.direction + outward * (2 * c);
  const auto look = screen.look(place, back, blur_px);
  if (!look || look->mean == 0) return;
  Vec3 x;
  const Stokes light = emitted(emitter, -back, look->mean, x);
  const Vec3 axis = optics::scattering_axis(back, -ray.direction);
  add(optics::fresnel_reflection(c, index) * (optics::frame_change(-back, x, axis) * light), -ray.direction, axis,
      ray.camera_x, stokes);
}

}  // namespace

SurfacePatch patch(const SplineField& field, Vec3 at) {
  return {at, field.jet(at)};
}

bool meet(const SurfacePatch& patch, Vec3 origin, Vec3 direction, Vec3& place, Vec3& outward) {
  double t = dot(patch.at - origin, direction);
  const double start = t;
  Vec3 slope;
  for (int k = 0; k < 6; ++k) {
    place = origin + direction * t;
    const Vec3 away = place - patch.at, bent = patch.jet.curve * away;
    slope = patch.jet.slope + bent;
    const double along = dot(slope, direction);
    if (std::abs(along) < 1e-6) return false;
    const double step = -(patch.jet.value + dot(patch.jet.slope, away) + dot(away, bent) / 2) / along;
    t += step;
    if (std::abs(step) < 1e-13 * (1 + std::abs(t))) break;
    if (std::abs(t - start) > 3) return false;
  }
  outward = -normalized(slope);
  return true;
}

SeenThrough seen_through(const PixelRay& ray, const SurfacePatch& first, const SurfacePatch& second,
                         const Glassy& glass, const ScreenPicture& screen, const light::Emitter& emitter,
                         double blur_px) {
  SeenThrough seen;
  Vec3 entry, outward, exit, outward2;
  if (!meet(first, ray.origin, ray.direction, entry, outward)) return seen;
  const double c = -dot(ray.direction, outward);
  if (!(c > 1e-3)) return seen;
  const Vec3 inside = surface::refracted(-ray.direction, outward, glass.index);
  if (!meet(second, entry, inside, exit, outward2)) return seen;
  const double c2 = dot(inside, outward2);
  if (!(c2 > 1e-3) || (1 - c2 * c2) * glass.index * glass.index > 1 - 1e-4) return seen;
  seen.valid = true;
  const Vec3 beyond = surface::refracted(-inside, -outward2, 1 / glass.index);
  if (const auto look = screen.look(exit, beyond, blur_px); look && !ray.hidden) {
    seen.meets_screen_plane = true;
    seen.place_px = look->place_px;
    Vec3 x;
    const Stokes light = emitted(emitter, -beyond, look->mean, x);
    const Vec3 axis2 = optics::scattering_axis(beyond, -inside), axis = optics::scattering_axis(inside, -ray.direction);
    const Mueller in = optics::fresnel_transmission(dot(beyond, outward2), glass.index);
    const Mueller out = optics::fresnel_transmission(-dot(inside, outward), 1 / glass.index);
    const double clear = std::exp(-glass.absorption * norm(exit - entry));
    const Stokes within = in * (optics::frame_change(-beyond, x, axis2) * light);
    const Stokes after = out * (optics::frame_change(-inside, axis2, axis) * within) * clear;
    seen.variance = look->variance * in(0, 0) * out(0, 0) * clear * in(0, 0) * out(0, 0) * clear;
    add(after, -ray.direction, axis, ray.camera_x, seen.stokes);
  }
  add_reflection(ray, entry, outward, glass.index, screen, emitter, blur_px, seen.stokes);
  return seen;
}

PathSlopes slopes_of(const PixelRay& ray, const SurfacePatch& first, const SurfacePatch& second, const Glassy& glass,
                     const ScreenPicture& screen, const light::Emitter& emitter, double blur_px) {
  PathSlopes slopes{};
  const auto at = [&](std::size_t number, double step) {
    std::array<SurfacePatch, 2> patches{first, second};
    Glassy g = glass;
    if (number < 8) {
      SplineField::Jet& jet = patches[number / 4].jet;
      const std::size_t part = number % 4;
      if (part == 0) jet.value += step;
      if (part > 0) jet.slope += Vec3{part == 1 ? step : 0, part == 2 ? step : 0, part == 3 ? step : 0};
    } else {
      (number == 8 ? g.index : g.absorption) += step;
    }
    return seen_through(ray, patches[0], patches[1], g, screen, emitter, blur_px);
  };
  for (std::size_t n = 0; n < path_numbers; ++n) {
    const SeenThrough more = at(n, difference), less = at(n, -difference);
    if (!more.valid || !less.valid) continue;
    for (std::size_t k = 0; k < 3; ++k) slopes[k][n] = (more.stokes[k] - less.stokes[k]) / (2 * difference);
  }
  return slopes;
}

std::array<std::array<double, 4>, 3> normal_slopes(const SurfacePatch& patch, Vec3 origin, Vec3 direction) {
  std::array<std::array<double, 4>, 3> slopes{};
  for (std::size_t n = 0; n < 4; ++n) {
    Vec3 normal[2], place;
    bool met = true;
    for (int side = 0; side < 2; ++side) {
      SurfacePatch moved = patch;
      const double step = side == 0 ? difference : -difference;
      if (n == 0) moved.jet.value += step;
      if (n > 0) moved.jet.slope += Vec3{n == 1 ? step : 0, n == 2 ? step : 0, n == 3 ? step : 0};
      met = met && meet(moved, origin, direction, place, normal[side]);
    }
    for (std::size_t k = 0; met && k < 3; ++k)
      slopes[k][n] = (normal[0][static_cast<int>(k)] - normal[1][static_cast<int>(k)]) / (2 * difference);
  }
  return slopes;
}

}  // namespace gonio::glass
