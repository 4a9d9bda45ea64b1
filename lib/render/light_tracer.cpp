#include "render/light_tracer.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace gonio::render {
namespace {

constexpr std::uint64_t chunk = 4096;  // paths of a unit of parallel work, and of one sequence of random numbers
constexpr int most_events = 4096;

// |cos(wi, Ns) / cos(wi, Ng)|, wi the side of the lamp; zero where the two see different sides.
double shading_ratio(const Vertex& vertex, Vec3 travel) {
  const double geometric = -dot(vertex.point.geometric_normal, travel);
  return geometric > 0 && vertex.wo.z > 0 ? vertex.wo.z / geometric : 0;
}

bool differs(Rgb eta) {
  return eta.x != eta.y || eta.y != eta.z;
}

}  // namespace

LightTracer::LightTracer(const PathSetting& setting, const CausticSources& sources, std::size_t extra_planes)
    : setting_(setting), sources_(sources), camera_(setting.view), extra_planes_(extra_planes) {
  for (const light::Emitter* emitter : setting.emitters) {
    const light::Emission e = emitter->infinite() ? light::Emission{} : emitter->emit({0.5, 0.5}, {0.5, 0.5});
    around_.push_back(e.valid && setting.media.any() ? setting.media.around(e.origin_m) : Inside{});
  }
}

void LightTracer::trace(std::uint64_t seed, std::uint64_t first, std::uint64_t count, Splats& splats) const {
  if (count == 0) return;
  const std::uint64_t begin = first / chunk, end = (first + count - 1) / chunk + 1;
  const double share = 1 / static_cast<double>(count);
  parallel_for(begin, end, [&](std::size_t number) {
    const std::uint64_t from = std::max(first, number * chunk), to = std::min(first + count, (number + 1) * chunk);
    for (std::uint64_t i = from; i < to; ++i) {
      Sampler sampler(seed ^ 0x63617573746963u, number, static_cast<std::uint32_t>(i - number * chunk));
      auto path = start(sampler);
      if (!path) continue;
      for (Fate fate = travel(*path, sampler); fate != Fate::lost; fate = travel(*path, sampler))
        if (!scatter(*path, fate, sampler, share, &splats)) break;
    }
  });
}

std::optional<PhotonPath> LightTracer::start(Sampler& sampler) const {
  const Photon photon = sources_.draw(sampler);
  if (!photon.valid) return {};
  PhotonPath path;
  path.emitter = photon.emitter;
  path.flux = photon.flux;
  path.origin_m = photon.origin_m;
  path.direction = photon.direction;
  path.inside = around_[photon.emitter];
  if (setting_.transport.stokes) path.stokes.emplace(*setting_.emitters[photon.emitter], photon.direction);
  return path;
}

LightTracer::Fate LightTracer::travel(PhotonPath& path, Sampler& sampler) const {
  for (;;) {
    const auto met = path.left ? setting_.caster.closest_from(*path.left, path.direction)
                               : setting_.caster.closest(path.origin_m, path.direction);
    const double reach = met ? met->distance_m : far_away;
    if (const surface::Medium* medium = setting_.media.at(path.inside)) {
      if (medium->scatters()) {
        const FreeFlight flight(*medium, path.flux);
        const double free = flight.distance_m(sampler.uniform());
        if (free < reach) {
          path.origin_m = (path.left ? path.left->position_m : path.origin_m) + path.direction * free;
          path.left.reset();
          path.flux *= flight.scatter_weight(free);
          return Fate::medium;
        }
        path.flux *= flight.reach_weight(reach);
      } else {
        path.flux *= transmittance(*medium, reach);
      }
    }
    if (!met || !(max_component(path.flux) > 0)) return Fate::lost;
    path.left = met;
    if (!setting_.media.holds(met->instance)) return Fate::surface;
    const Crossing crossing = setting_.media.crossing(path.inside, *met);
    if (!crossing.passes) return Fate::surface;
    path.inside = crossing.inside_beyond;
    path.left = beyond(*met);
  }
}

bool LightTracer::scatter(PhotonPath& path, Fate fate, Sampler& sampler, double share, Splats* splats) const {
  if (path.smooth + path.spread >= most_events) return false;
  const Rgb before = path.flux;
  const bool goes_on = fate == Fate::medium ? scatter_in_medium(path, sampler, share, splats)
                                            : scatter_at_surface(path, sampler, share, splats);
  if (!goes_on) return false;
  const double q = std::min(1.0, max_component(path.flux) / max_component(before));
  if (!(q > 0) || sampler.uniform() >= q) return false;
  path.flux *= 1 / q;
  return true;
}

bool LightTracer::scatter_at_surface(PhotonPath& path, Sampler& sampler, double share, Splats* splats) const {
  const SurfacePoint& at = *path.left;
  const bool transmits = setting_.transmits[at.surface];
  std::optional<Crossing> crossing;
  std::optional<InterfaceHere> here;
  if (setting_.media.any() && (transmits || !path.inside.empty())) {
    crossing = setting_.media.crossing(path.inside, at);
    here = InterfaceHere{crossing->eta, path.colour};
    if (path.colour < 0) here->hero = differs(crossing->eta) ? static_cast<int>(3 * sampler.uniform()) : 0;
  }
  const Vertex vertex(setting_.scene, at, -path.direction, here);
  const double ratio = shading_ratio(vertex, path.direction);
  const bool caustic = path.smooth > 0 || path.spread > 0;
  const Vec2 lens_u = sampler.two(), u = sampler.two();
  if (caustic && splats) connect_surface(path, vertex, crossing ? &*crossing : nullptr, lens_u, share, *splats);
  const surface::Sample next = vertex.model->sample(vertex.values, vertex.wo, u, sampler.uniform());
  if (!(next.pdf > 0) || next.below || (!next.delta && !caustic)) return false;
  const Vec3 direction = vertex.frame.to_world(next.wi);
  const bool through = next.wi.z < 0;
  const double side = dot(at.geometric_normal, direction);
  if (through ? !(side < 0 && transmits) : !(side > 0)) return false;
  path.flux *= next.weight * (ratio * std::abs(side) / std::abs(next.wi.z));
  if (path.stokes) path.flux *= path.stokes->scatter(vertex, next.wi);
  if (through && crossing) {
    const Rgb eta = crossing->eta;
    path.flux *= eta * eta;
    if (path.colour < 0 && differs(eta)) {
      path.colour = here->hero;
      path.flux *= Rgb{path.colour == 0 ? 3.0 : 0, path.colour == 1 ? 3.0 : 0, path.colour == 2 ? 3.0 : 0};
    }
    path.inside = crossing->inside_beyond;
  }
  ++(next.delta ? path.smooth : path.spread);
  path.origin_m = at.position_m;
  path.direction = direction;
  if (through) path.left = beyond(at);
  return max_component(path.flux) > 0;
}

bool LightTracer::scatter_in_medium(PhotonPath& path, Sampler& sampler, double share, Splats* splats) const {
  const bool caustic = path.smooth > 0 || path.spread > 0;
  if (!caustic) return false;
  const FreeFlight flight(*setting_.media.at(path.inside), path.flux);
  const Vec2 lens_u = sampler.two(), u = sampler.two();
  const auto seen = splats ? view(path.origin_m, lens_u) : std::nullopt;
  if (seen) {
    const Rgb clear = setting_.clear(nullptr, path.origin_m, path.inside, seen->to_camera, seen->distance_m);
    const Rgb phase = flight.phase(dot(path.direction, seen->to_camera));
    add(path, *seen, path.flux * phase * clear * (seen->sight.pixels_per_m2 * share), nullptr, *splats);
  }
  const auto turn = flight.turn(path.direction, u);
  path.flux *= turn.weight;
  path.direction = turn.direction;
  if (path.stokes) path.stokes->depolarize(path.direction);
  ++path.spread;
  return true;
}

std::optional<LightTracer::View> LightTracer::view(Vec3 point_m, Vec2 lens_u) const {
  const auto sight = camera_.sight(point_m, lens_u);
  if (!sight) return {};
  const Vec3 arm = sight->origin_m - point_m;
  const double distance = norm(arm);
  const Vec3 to_camera = arm / distance;
  for (const light::Emitter* emitter : setting_.emitters) {  // lamps hide what lies behind them
    if (emitter->infinite()) continue;
    const light::Hit hit = emitter->hit(sight->origin_m, -to_camera);
    if (max_component(hit.radiance) > 0 && hit.distance_m < distance) return {};
  }
  return View{*sight, to_camera, distance};
}

void LightTracer::connect_surface(const PhotonPath& path, const Vertex& vertex, const Crossing* crossing, Vec2 lens_u,
                                  double share, Splats& splats) const {
  const auto seen = view(vertex.point.position_m, lens_u);
  if (!seen) return;
  const Vec3 wi = vertex.frame.to_local(seen->to_camera);
  const bool through = wi.z < 0;
  if (through && !setting_.transmits[vertex.point.surface]) return;
  Rgb f = vertex.model->evaluate(vertex.values, vertex.wo, wi);
  if (!(max_component(f) > 0)) return;
  SurfacePoint side = vertex.point;
  if (through) {
    side = beyond(side);
    if (crossing) f *= crossing->eta * crossing->eta;
  }
  const Inside& inside = through && crossing ? crossing->inside_beyond : path.inside;
  const Rgb clear = setting_.clear(&side, side.position_m, inside, seen->to_camera, seen->distance_m);
  if (!(max_component(clear) > 0)) return;
  const double cosine = std::abs(dot(vertex.point.geometric_normal, seen->to_camera));
  const double factor = shading_ratio(vertex, path.direction) * cosine * seen->sight.pixels_per_m2 * share;
  if (!path.stokes) return add(path, *seen, path.flux * f * clear * factor, nullptr, splats);
  PhotonStokes towards = *path.stokes;
  const Rgb more = towards.scatter(vertex, wi);
  add(path, *seen, path.flux * f * clear * more * factor, &towards, splats);
}

void LightTracer::add(const PhotonPath& path, const View& view, Rgb value, const PhotonStokes* stokes,
                      Splats& splats) const {
  const double strength = path.spread > 0 ? setting_.scene.appearance.indirect_strength : 1;
  const Rgb scaled = value * setting_.scale(view.sight.pixel) * strength;
  splats.add(view.sight.pixel, 0, scaled);
  if (stokes) {
    const std::array<Rgb, 3> seen = stokes->seen(view.to_camera, setting_.camera_x());
    for (std::size_t i = 0; i < 3; ++i) splats.add(view.sight.pixel, i + 1, scaled * seen[i]);
  }
  if (setting_.transport.per_light) splats.add(view.sight.pixel, 1 + extra_planes_ + path.emitter, scaled);
}

}  // namespace gonio::render
