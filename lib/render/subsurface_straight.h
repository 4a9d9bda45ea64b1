// What the refracted ray itself meets beneath a translucent surface (surface::StraightLight). World frame, metres.
//
// Passing (S_dE of the directional dipole): the ray that meets the far side is refracted out of it and goes on from
// there, attenuated over the way d; radiance changes by eta^2 twice, which cancels. It is followed with probability
//   q = transmittance / 2  of the clearest band, the diffuse part otherwise,
// and not at all where the transmittance is below 1e-4. What the far side reflects inwards is lost.
//
// Single scattering (S^(1), Jensen et al. 2001, section 2.3): a point p on the ray at a depth drawn by the attenuation;
// each light is sampled from p, along the straight line, which meets the surface at x after s_i. The way within is that
// of the ray refracted at x, as if the surface were flat: s' = s_i cos_i / cos_12; so is the direction w12 at p.
//   L = T(wo) / eta^2  integral of  sigma_s p_HG(w12, w21) exp(-sigma_t (s + s'))  T(wi) L_i cos_i / cos_12  ds dwi
// Exact for flat surfaces and distant lights. Light that other surfaces send to the object is left out of S^(1).
#pragma once
#include <algorithm>
#include <optional>

#include "render/path_lights.h"
#include "render/subsurface_walk.h"

namespace gonio::render {

template <class Carrier>
class StraightWalk {
 public:
  StraightWalk(const PathSetting& setting, const PathLights<Carrier>& lights) : setting_(setting), lights_(lights) {}

  enum class Fate { diffuse, onwards, lost };  // the diffuse part remains; the path was sent on; it ends here

  Fate follow(Path<Carrier>& path, const Vertex& exit, Vec3 inward, const surface::Subsurface& beneath,
              const surface::StraightLight& light) const {
    if (light.passes) return pass(path, exit, inward, beneath, light.medium);
    const double share = light.single_share;
    if (path.sampler.uniform() >= share) {
      path.carrier.attenuate(grey(1 / (1 - share)));
      return Fate::diffuse;
    }
    path.carrier.attenuate(grey(light.single / (share * beneath.eta() * beneath.eta())));
    scatter_once(path, exit, inward, beneath, light.medium);
    return Fate::lost;
  }

 private:
  static Rgb grey(double x) { return {x, x, x}; }

  Fate pass(Path<Carrier>& path, const Vertex& exit, Vec3 inward, const surface::Subsurface& beneath,
            const surface::Medium& medium) const {
    const Rgb sigma = medium.sigma_a_per_m;
    const double least = std::min({sigma.x, sigma.y, sigma.z}), reach_m = 9.2 / least;  // exp(-9.2) = 1e-4
    const SurfacePoint within = beyond(exit.point);
    const double u = path.sampler.uniform();
    if (!setting_.caster.occluded(within, inward, reach_m)) return Fate::diffuse;
    const auto far_side = setting_.caster.closest_from(within, inward);
    if (!far_side || far_side->instance != exit.point.instance) return Fate::diffuse;
    const Rgb passes = transmittance(medium, far_side->distance_m);
    const double q = max_component(passes) / 2;
    if (u >= q) {
      path.carrier.attenuate(grey(1 / (1 - q)));
      return Fate::diffuse;
    }
    const Vertex vertex(setting_.scene, on_side_of(exit.point, *far_side), -inward);
    const surface::Entrance out = beneath.leave(vertex.values, vertex.frame.to_local(inward), path.sampler.two());
    const Vec3 direction = vertex.frame.to_world(out.onwards);
    if (!(out.share > 0) || !(dot(vertex.point.geometric_normal, direction) > 0)) return Fate::lost;
    path.carrier.depolarize(direction, passes * (out.share / q));
    path.left = vertex.point;
    path.origin_m = vertex.point.position_m;
    path.direction = direction;
    path.alone = true;
    return Fate::onwards;
  }

  void scatter_once(Path<Carrier>& path, const Vertex& exit, Vec3 inward, const surface::Subsurface& beneath,
                    const surface::Medium& medium) const {
    const FreeFlight flight(medium, path.carrier.power());
    const double depth_m = flight.distance_m(path.sampler.uniform());
    const SurfacePoint within = beyond(exit.point);
    if (!std::isfinite(depth_m) || setting_.caster.occluded(within, inward, depth_m)) return;
    path.carrier.attenuate(flight.scatter_weight(depth_m));
    const Vec3 p = exit.point.position_m + inward * depth_m;
    for (std::size_t i = 0; i < setting_.emitters.size(); ++i) {
      const light::Sample sample = setting_.emitters[i]->sample(p, path.sampler.two());
      const Vec2 facet = path.sampler.two();
      if (!sample.valid) continue;
      const auto met = setting_.caster.closest(p, sample.direction);
      if (!met || met->instance != exit.point.instance || met->distance_m > sample.distance_m) continue;
      const Vertex entry(setting_.scene, on_side_of(exit.point, *met), sample.direction);
      const Vec3 wi = entry.wo;
      if (wi.z <= 0) continue;
      const surface::Entrance in = beneath.enter(entry.values, wi, facet);
      const double ratio = wi.z / -in.onwards.z;
      const Rgb clear = setting_.clear(&entry.point, entry.point.position_m, path.inside, sample.direction,
                                       sample.distance_m - met->distance_m);
      const Rgb phase = flight.phase(-dot(entry.frame.to_world(in.onwards), inward));
      lights_.add_sampled(
          path, sample.direction,
          phase * transmittance(medium, met->distance_m * ratio) * clear * sample.weight * (in.share * ratio), i);
    }
  }

  const PathSetting& setting_;
  const PathLights<Carrier>& lights_;
};

}  // namespace gonio::render
