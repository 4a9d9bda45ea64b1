// Light that a path receives: from emitters that its rays meet, and from those that its events sample. World frame,
// metres.
//
// What comes straight from a light is estimated twice, drawn from the light and drawn from the surface; the two are
// joined by the power heuristic (Veach 1997, equation 9.13). A direction from a smooth interface is beyond the lights'
// sampling, and what it meets counts fully.
#pragma once
#include <algorithm>
#include <cmath>

#include "render/carrier.h"
#include "render/free_flight.h"
#include "render/path_setting.h"
#include "render/path_state.h"

namespace gonio::render {

template <class Carrier>
class PathLights {
 public:
  explicit PathLights(const PathSetting& setting) : setting_(setting) {}

  // Distance to the nearest lamp that the ray meets.
  double nearest_lamp(const Path<Carrier>& path) const {
    double nearest = far_away;
    for (const light::Emitter* emitter : setting_.emitters) {
      if (emitter->infinite()) continue;
      const light::Hit hit = emitter->hit(path.origin_m, path.direction);
      if (max_component(hit.radiance) > 0) nearest = std::min(nearest, hit.distance_m);
    }
    return nearest;
  }

  // Lamps on the way from `walked` to `walked + reach`; of those that the camera sees the nearest alone.
  template <class Share>
  void meet_lamps(const Path<Carrier>& path, double walked, double reach, double lamp_m, const Share& share) const {
    if (!counts_what_it_meets(path)) return;
    for (std::size_t i = 0; i < setting_.emitters.size(); ++i) {
      if (setting_.emitters[i]->infinite()) continue;
      const light::Hit hit = setting_.emitters[i]->hit(path.origin_m, path.direction);
      const double way = hit.distance_m - walked;
      if (!(max_component(hit.radiance) > 0) || way < 0 || !(way < reach)) continue;
      if (path.first ? hit.distance_m > lamp_m : left_to_lights(path, i)) continue;
      add(path,
          path.carrier.met(path.direction, hit.radiance * share(way) * heuristic(path, hit), *setting_.emitters[i]), i,
          path.scattered);
    }
  }
  void meet_surroundings(const Path<Carrier>& path) const {
    if (!counts_what_it_meets(path)) return;
    for (std::size_t i = 0; i < setting_.emitters.size(); ++i) {
      if (!setting_.emitters[i]->infinite()) continue;
      const light::Hit hit = setting_.emitters[i]->hit(path.origin_m, path.direction);
      if (!(max_component(hit.radiance) > 0)) continue;
      add(path, path.carrier.met(path.direction, hit.radiance * heuristic(path, hit), *setting_.emitters[i]), i,
          path.scattered);
    }
  }

  // Light that comes straight from one sampled direction to the emitter.
  void light_surface(Path<Carrier>& path, const Meeting& meeting, std::size_t i) const {
    const Vertex& vertex = meeting.vertex;
    const Vec2 u = path.sampler.two();
    const light::Sample sample = setting_.emitters[i]->sample(vertex.point.position_m, u);
    if (!sample.valid) return;
    const Vec3 wi = vertex.frame.to_local(sample.direction);
    const bool through = wi.z < 0 && meeting.transmits;
    const Rgb f = wi.z > 0 || through ? vertex.model->evaluate(vertex.values, vertex.wo, wi) : Rgb{};
    const bool dark = !(max_component(f) > 0);
    if (dark && (!path.first || through)) return;
    const Rgb clear = through ? clear_beyond(path, meeting, sample)
                              : setting_.clear(&vertex.point, vertex.point.position_m, path.inside, sample.direction,
                                               sample.distance_m);
    if (!(max_component(clear) > 0)) return;
    if (path.first) ++path.noticed.seen[i];
    if (dark) return;
    const bool alone = sample.delta || setting_.transport.estimator == Estimator::lights_only;
    const double share = alone ? 1 : power_heuristic(sample.pdf, vertex.model->pdf(vertex.values, vertex.wo, wi));
    Rgb weight = f * sample.weight * clear * (std::abs(wi.z) * share);
    if (through && meeting.keep >= 0) weight *= kept(meeting.keep);
    Carrier branch = path.carrier;
    branch.scatter(vertex, wi, weight);
    add(path, branch.met(sample.direction, {1, 1, 1}, *setting_.emitters[i]), i, path.scattered + 1);
  }
  void light_medium(Path<Carrier>& path, const FreeFlight& flight, std::size_t i) const {
    const Vec2 u = path.sampler.two();
    const light::Sample sample = setting_.emitters[i]->sample(path.origin_m, u);
    if (!sample.valid) return;
    const Rgb clear = setting_.clear(nullptr, path.origin_m, path.inside, sample.direction, sample.distance_m);
    if (!(max_component(clear) > 0)) return;
    if (path.first) ++path.noticed.seen[i];
    const Rgb phase = flight.phase(dot(path.direction, sample.direction));
    const bool alone = sample.delta || setting_.transport.estimator == Estimator::lights_only;
    const double share = alone ? 1 : power_heuristic(sample.pdf, flight.density(phase));
    Carrier branch = path.carrier;
    branch.depolarize(sample.direction, phase * sample.weight * clear * share);
    add(path, branch.met(sample.direction, {1, 1, 1}, *setting_.emitters[i]), i, path.scattered + 1);
  }
  // Light of one emitter that a caller has sampled, in units of its weight.
  void add_sampled(const Path<Carrier>& path, Vec3 direction, Rgb weight, std::size_t i) const {
    Carrier branch = path.carrier;
    branch.depolarize(direction, weight);
    add(path, branch.met(direction, {1, 1, 1}, *setting_.emitters[i]), i, path.scattered + 1);
  }

 private:
  // Lamp, smooth interfaces, and a last event that the camera sees directly: see light_tracer.h.
  bool left_to_lights(const Path<Carrier>& path, std::size_t emitter) const {
    return path.alone && path.sees_spread && setting_.left_to_lights(emitter);
  }
  bool counts_what_it_meets(const Path<Carrier>& path) const {
    return path.alone || setting_.transport.estimator == Estimator::combined;
  }
  static double heuristic(const Path<Carrier>& path, const light::Hit& hit) {
    return path.alone ? 1 : power_heuristic(path.density, hit.pdf);
  }
  static double power_heuristic(double pdf, double other) { return pdf * pdf / (pdf * pdf + other * other); }

  // `scattered`: events that spread the light on its whole way.
  void add(const Path<Carrier>& path, const typename Carrier::Value& value, std::size_t emitter, int scattered) const {
    const Rgb scale = path.scale * (scattered > 1 ? setting_.scene.appearance.indirect_strength : 1);
    Carrier::deposit(value, scale, path.planes);
    if (setting_.transport.per_light) path.planes[1 + extra_ + emitter] += Carrier::radiance(value) * scale;
  }
  Rgb clear_beyond(const Path<Carrier>& path, const Meeting& meeting, const light::Sample& sample) const {
    const SurfacePoint other = beyond(meeting.vertex.point);
    return setting_.clear(&other, other.position_m, meeting.crossing ? meeting.crossing->inside_beyond : path.inside,
                          sample.direction, sample.distance_m);
  }

  static Rgb kept(int band) { return {band == 0 ? 3.0 : 0, band == 1 ? 3.0 : 0, band == 2 ? 3.0 : 0}; }

  const PathSetting& setting_;
  std::size_t extra_ = Carrier::planes().size();
};

}  // namespace gonio::render
