// Paths from the camera, whatever they carry (carrier.h). World frame, metres.
//
//   L(x, wo) = L_e + sum over lights  f |cos| weight V + integral of  f |cos| L(y, -wi) dwi     (Kajiya 1986, eq. 1)
// along rays through media: attenuated by Bouguer's law, or scattered on the way (free_flight.h). The two estimates of
// what comes straight from a light, drawn from the light and drawn from the surface, are joined by the power heuristic
// (Veach 1997, equation 9.13). A direction from a smooth interface is beyond the lights' sampling, and what it meets
// counts fully.
//
// Split for transport.indirect: pixel = gain vignetting (L_direct + strength L_indirect), L_direct what the camera
// receives after at most one scattering event, not counting smooth interfaces.
//
// Dispersion: at the first interface whose index ratio differs between bands one band is drawn at random; where the
// path is refracted it goes on with that band alone, three times as strong. Light sampled through such an interface
// likewise, so that both estimates of one band see the same densities.
//
// Roulette (Arvo & Kirk 1990) acts on the root of the throughput over index^2: a path in glass is not thought weak.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>

#include "render/path_lights.h"
#include "render/subsurface_straight.h"

namespace gonio::render {

template <class Carrier>
class PathLoop {
 public:
  explicit PathLoop(const PathSetting& setting) : setting_(setting) {}

  // One path; what it finds is added to `planes`. `onward`: see Path.
  void trace(Vec2 pixel, double onward, Sampler& sampler, std::span<Rgb> planes, Noticed& noticed) const {
    const auto [origin_m, direction] = setting_.rays.at(pixel, setting_.rays.uses_lens() ? sampler.two() : Vec2{});
    Path<Carrier> path{.carrier = Carrier::start(setting_.camera_x(), direction),
                       .origin_m = origin_m,
                       .direction = direction,
                       .inside = setting_.camera_inside,
                       .left = {},
                       .sampler = sampler,
                       .planes = planes,
                       .scale = setting_.scale(pixel),
                       .noticed = noticed,
                       .begin = planes[0],
                       .onward = onward};
    follow(path);
  }

 private:
  static constexpr int roulette_from = 3;           // scattering events before paths may be ended at random
  static constexpr std::uint64_t work_beneath = 6;  // of a way beneath a surface, in events

  enum class Fate { lost, surface, medium };

  void follow(Path<Carrier>& path) const {
    for (;;) {
      const Fate fate = travel(path);
      if (fate == Fate::lost) break;
      if (path.first) ++path.noticed.met;
      if (!(fate == Fate::medium ? scatter_in_medium(path) : scatter_at_surface(path))) return;
      path.first = false;
    }
    if (path.first) note_near(path);
  }
  static void note_near(const Path<Carrier>& path) { path.noticed.near += mean(path.planes[0] - path.begin); }

  // To the next event. Surfaces that are no interface are passed.
  Fate travel(Path<Carrier>& path) const {
    const double lamp_m =
        path.first ? lights_.nearest_lamp(path) : far_away;  // hides what lies behind it from the camera
    for (double walked = 0;;) {
      auto met = path.left ? setting_.caster.closest_from(*path.left, path.direction)
                           : setting_.caster.closest(path.origin_m, path.direction);
      const double reach = met ? met->distance_m : far_away;
      if (const surface::Medium* medium = setting_.media.at(path.inside)) {
        if (medium->scatters()) {
          const FreeFlight flight(*medium, path.carrier.power());
          const double free = flight.distance_m(path.sampler.uniform());
          lights_.meet_lamps(path, walked, std::min(reach, free), lamp_m,
                             [&](double d) { return flight.reach_weight(d); });
          if (free < reach) {
            if (lamp_m < walked + free) return Fate::lost;
            path.origin_m = (path.left ? path.left->position_m : path.origin_m) + path.direction * free;
            path.left.reset();
            path.carrier.attenuate(flight.scatter_weight(free));
            return Fate::medium;
          }
          path.carrier.attenuate(flight.reach_weight(reach));
        } else {
          lights_.meet_lamps(path, walked, reach, lamp_m, [&](double d) { return transmittance(*medium, d); });
          path.carrier.attenuate(transmittance(*medium, reach));
        }
      } else {
        lights_.meet_lamps(path, walked, reach, lamp_m, [](double) { return Rgb{1, 1, 1}; });
      }
      if (lamp_m < walked + reach) return Fate::lost;
      if (!met) {
        lights_.meet_surroundings(path);
        return Fate::lost;
      }
      path.left = met;
      if (!setting_.media.holds(met->instance)) return Fate::surface;
      const Crossing crossing = setting_.media.crossing(path.inside, *met);
      if (!crossing.passes) return Fate::surface;
      path.inside = crossing.inside_beyond;
      path.left = beyond(*met);
      walked += reach;
    }
  }
  bool is_off(int scattered) const { return scattered > 1 && setting_.scene.appearance.indirect_strength == 0; }

  bool scatter_at_surface(Path<Carrier>& path) const {
    if (path.surfaces++ >= setting_.transport.max_bounces) return false;
    ++path.events;
    ++path.noticed.events;
    const SurfacePoint& at = *path.left;
    const bool transmits = setting_.transmits[at.surface];  // a sheet lies in one medium
    std::optional<Crossing> crossing;
    std::optional<InterfaceHere> here;
    bool disperses = false;  // and the path still has all bands
    if (setting_.media.any() && !(transmits && setting_.scene.appearance.surfaces[at.surface].model->thin()) &&
        (transmits || !path.inside.empty())) {
      crossing = setting_.media.crossing(path.inside, at);
      const Rgb eta = crossing->eta;
      disperses = path.colour < 0 && (eta.x != eta.y || eta.y != eta.z);
      here = InterfaceHere{eta, path.colour};
      if (path.colour < 0) here->hero = disperses ? static_cast<int>(3 * path.sampler.uniform()) : 0;
    }
    const Vertex vertex(setting_.scene, at, -path.direction, here);
    return scatter_at(path, {vertex, crossing ? &*crossing : nullptr, transmits, disperses ? here->hero : -1});
  }

  // Light of the lamps, and on.
  bool scatter_at(Path<Carrier>& path, const Meeting& meeting) const {
    const bool answers =
        path.first || setting_.spreads[meeting.vertex.point.surface];  // first: what the camera sees is counted
    if (answers && !is_off(path.scattered + 1))
      for (std::size_t i = 0; i < setting_.emitters.size(); ++i) lights_.light_surface(path, meeting, i);
    if (!path.first) return go_on(path, meeting);
    note_near(path);
    return path.onward == 1 ? go_on(path, meeting) : go_on_as_several(path, meeting);
  }

  bool go_on(Path<Carrier>& path, const Meeting& meeting) const {
    const Vertex& vertex = meeting.vertex;
    const Vec2 u = path.sampler.two();
    const surface::Sample next = vertex.model->sample(vertex.values, vertex.wo, u, path.sampler.uniform());
    return next.pdf > 0 && leave(path, meeting, next);
  }

  // Several paths from the first surface (sample_map.h); all end here.
  bool go_on_as_several(Path<Carrier>& path, const Meeting& meeting) const {
    path.carrier.attenuate(Rgb{1, 1, 1} / path.onward);
    const auto count = static_cast<std::uint32_t>(path.onward);
    const Sampler whole = path.sampler;
    for (std::uint32_t k = 0; k < count; ++k) {
      path.sampler = whole.part(k, count);
      Path<Carrier> branch = path;
      if (!go_on(branch, meeting)) continue;
      branch.first = false;
      follow(branch);
    }
    return false;
  }

  // On along a direction that the surface has drawn. False: the path ends.
  bool leave(Path<Carrier>& path, const Meeting& meeting, const surface::Sample& next) const {
    const Vertex& vertex = meeting.vertex;
    if (next.below) return leave_below(path, vertex, next);
    const Vec3 direction = vertex.frame.to_world(next.wi);
    const bool through = next.wi.z < 0;
    const double side = dot(vertex.point.geometric_normal, direction);
    if (through ? !(side < 0 && meeting.transmits) : !(side > 0)) return false;
    path.carrier.scatter(vertex, next.wi, next.weight);
    if (through && meeting.keep >= 0) {
      path.carrier.keep(meeting.keep);
      path.colour = meeting.keep;
    }
    if (through && meeting.crossing) {
      const double eta = meeting.crossing->eta[std::max(path.colour, 0)];
      path.index_square *= eta * eta;
      path.inside = meeting.crossing->inside_beyond;
    }
    path.left = through ? beyond(vertex.point) : vertex.point;
    path.origin_m = vertex.point.position_m;
    path.direction = direction;
    path.density = next.pdf;
    path.alone = next.delta;
    if (path.first) path.sees_spread = !next.delta;
    path.scattered += next.delta ? 0 : 1;
    if (is_off(path.scattered)) return false;
    return survives(path);
  }

  // Light that has come by way of the medium beneath the surface: it entered elsewhere on the same object.
  bool leave_below(Path<Carrier>& path, const Vertex& exit, const surface::Sample& next) const {
    const surface::Subsurface* beneath = exit.model->subsurface(exit.values);
    if (!beneath) return false;
    path.noticed.events += work_beneath;
    const Vec3 inward = exit.frame.to_world(next.wi);
    path.carrier.depolarize(inward, next.weight);
    path.first = false;
    if (const surface::StraightLight* light = beneath->straight()) {
      const auto fate = straight_.follow(path, exit, inward, *beneath, *light);
      if (fate == StraightWalk<Carrier>::Fate::lost) return false;
      if (fate == StraightWalk<Carrier>::Fate::onwards) return survives(path);
    }
    if (!(beneath->reach_m() > 0)) return false;
    const auto point = draw_entry(setting_.caster, *beneath, exit.point, path.sampler);
    if (!point) return false;
    const EntryModel law(*beneath, *exit.model, exit.point, *point, path.sampler.two());
    Vertex entry(setting_.scene, point->point, point->point.normal);
    entry.model = &law;
    return scatter_at(path, {entry, nullptr, false, -1});
  }

  bool scatter_in_medium(Path<Carrier>& path) const {
    ++path.events;
    ++path.noticed.events;
    const FreeFlight flight(*setting_.media.at(path.inside), path.carrier.power());
    if (!is_off(path.scattered + 1))
      for (std::size_t i = 0; i < setting_.emitters.size(); ++i) lights_.light_medium(path, flight, i);
    if (path.first) note_near(path);
    const auto turn = flight.turn(path.direction, path.sampler.two());
    path.carrier.depolarize(turn.direction, turn.weight);
    path.direction = turn.direction;
    path.density = turn.density;
    path.alone = false;
    if (path.first) path.sees_spread = true;
    ++path.scattered;
    if (is_off(path.scattered)) return false;
    return survives(path);
  }

  // A path goes on with probability q and counts 1 / q. The root keeps paths that may yet meet something bright.
  static bool survives(Path<Carrier>& path) {
    const double q = std::min(1.0, std::sqrt(max_component(path.carrier.power()) * path.index_square));
    if (!(q > 0)) return false;
    if (path.events < roulette_from || q == 1) return true;
    if (path.sampler.uniform() >= q) return false;
    path.carrier.attenuate(Rgb{1, 1, 1} / q);
    return true;
  }

  const PathSetting& setting_;
  PathLights<Carrier> lights_{setting_};
  StraightWalk<Carrier> straight_{setting_, lights_};
};

}  // namespace gonio::render
