// Paths from the camera; see integrator.h. World frame, metres.
//
//   L(x, wo) = L_e + sum over lights  f cos weight V + integral of  f cos L(y, -wi) dwi           (Kajiya 1986,
//   equation 1)
// split for transport.indirect into what the camera receives from lights directly or after one scattering event, and
// the rest:
//   pixel = gain vignetting (L_direct + strength L_indirect)
#include <algorithm>
#include <cmath>

#include "render/integrator.h"
#include "render/vertex.h"

namespace gonio::render {
namespace {

constexpr int roulette_from = 3;  // scattering events before paths may be ended at random

// Veach 1997, equation 9.13 with beta = 2.
double power_heuristic(double pdf, double other) {
  return pdf * pdf / (pdf * pdf + other * other);
}

struct Split {  // radiance by the number of scattering events
  Rgb direct, indirect;
};

class PathIntegrator final : public Integrator {
 public:
  PathIntegrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Transport& transport)
      : scene_(scene),
        view_(scene.views[view]),
        caster_(caster),
        transport_(transport),
        rotation_(matrix_of(view_.world_from_camera.rotation)) {
    for (const std::size_t light : view_.lights) emitters_.push_back(scene.appearance.lights[light].emitter.get());
    named_ = emitters_.size();
    if (scene.appearance.ambient) emitters_.push_back(scene.appearance.ambient.get());
  }

  std::vector<std::string> planes() const override { return {""}; }
  std::size_t lights() const override { return emitters_.size(); }

  void trace(Vec2 pixel, Sampler& sampler, std::span<Rgb> planes, Noticed& noticed) const override {
    const Split light = split(pixel, sampler, noticed);
    const double factor = scene::vignetting(scene_.appearance.vignetting_falloff, view_.camera.width_px(),
                                            view_.camera.height_px(), pixel);
    planes[0] += (light.direct + light.indirect * scene_.appearance.indirect_strength) * view_.gain * factor;
  }

  PixelGeometry geometry(int x, int y, const Noticed& noticed) const override { return geometry_of(x, y, noticed); }

 private:
  std::pair<Vec3, Vec3> world_ray(Vec2 pixel) const {
    const camera::Ray ray = view_.camera.ray(pixel);
    return {rotation_ * ray.origin_m + view_.world_from_camera.translation_m, rotation_ * ray.direction};
  }

  Split split(Vec2 pixel, Sampler& sampler, Noticed& noticed) const {
    auto [origin_m, direction] = world_ray(pixel);
    auto point = caster_.closest(origin_m, direction);
    Split light{.direct = seen_lights(origin_m, direction, point), .indirect = {}};
    if (point) ++noticed.met;
    Rgb throughput{1, 1, 1};
    for (int event = 1; point && event <= transport_.max_bounces; ++event) {
      const bool first = event == 1;
      const Vertex vertex(scene_, *point, -direction);
      Rgb& sum = first ? light.direct : light.indirect;
      for (std::size_t i = 0; i < emitters_.size(); ++i)
        sum += throughput * from_light(vertex, *emitters_[i], sampler.two(), first ? &noticed.seen[i] : nullptr);
      const Vec2 u = sampler.two();
      const surface::Sample next = vertex.model->sample(vertex.values, vertex.wo, u, sampler.uniform());
      if (!(next.pdf > 0)) break;
      direction = vertex.frame.to_world(next.wi);
      if (!(dot(point->geometric_normal, direction) > 0)) break;
      throughput *= next.weight;
      const auto onwards = caster_.closest_from(*point, direction);
      if (transport_.estimator == Estimator::combined)
        sum += throughput * met_lights(point->position_m, direction, next.pdf, onwards);
      if (first && scene_.appearance.indirect_strength == 0) break;
      if (!survives(event, throughput, sampler)) break;
      point = onwards;
    }
    return light;
  }

  // What the eye sees of the lights themselves. A lamp in front of a surface hides it: `point` is emptied.
  Rgb seen_lights(Vec3 origin_m, Vec3 direction, std::optional<SurfacePoint>& point) const {
    Rgb surroundings;
    light::Hit nearest;
    for (const light::Emitter* emitter : emitters_) {
      const light::Hit hit = emitter->hit(origin_m, direction);
      if (!reaches(*emitter, hit, point)) continue;
      if (emitter->infinite())
        surroundings += hit.radiance;
      else if (hit.distance_m < nearest.distance_m)
        nearest = hit;
    }
    if (!std::isfinite(nearest.distance_m)) return surroundings;
    point.reset();
    return nearest.radiance;
  }

  // Arvo & Kirk 1990: a path goes on with probability q and counts 1 / q.
  static bool survives(int event, Rgb& throughput, Sampler& sampler) {
    const double q = std::min(1.0, max_component(throughput));
    if (!(q > 0)) return false;
    if (event < roulette_from || q == 1) return true;
    if (sampler.uniform() >= q) return false;
    throughput *= 1 / q;
    return true;
  }

  static bool reaches(const light::Emitter& emitter, const light::Hit& hit, const std::optional<SurfacePoint>& point) {
    if (max_component(hit.radiance) <= 0) return false;
    return !point || (!emitter.infinite() && hit.distance_m < point->distance_m);
  }

  // Radiance towards the eye of light that comes straight from one sampled direction to the emitter.
  Rgb from_light(const Vertex& vertex, const light::Emitter& emitter, Vec2 u, std::uint32_t* seen) const {
    const light::Sample sample = emitter.sample(vertex.point.position_m, u);
    if (!sample.valid) return {};
    const Vec3 wi = vertex.frame.to_local(sample.direction);
    const Rgb f = wi.z > 0 ? vertex.model->evaluate(vertex.values, vertex.wo, wi) : Rgb{};
    const bool dark = max_component(f) <= 0;
    if ((dark && !seen) || caster_.occluded(vertex.point, sample.direction, sample.distance_m)) return {};
    if (seen) ++*seen;
    if (dark) return {};
    const bool alone = sample.delta || transport_.estimator == Estimator::lights_only;
    const double share = alone ? 1 : power_heuristic(sample.pdf, vertex.model->pdf(vertex.values, vertex.wo, wi));
    return f * sample.weight * (wi.z * share);
  }

  // Radiance of the emitters that a direction drawn from the surface happens to meet.
  Rgb met_lights(Vec3 origin_m, Vec3 direction, double pdf, const std::optional<SurfacePoint>& beyond) const {
    Rgb sum;
    for (const light::Emitter* emitter : emitters_) {
      const light::Hit hit = emitter->hit(origin_m, direction);
      if (reaches(*emitter, hit, beyond)) sum += hit.radiance * power_heuristic(pdf, hit.pdf);
    }
    return sum;
  }

  PixelGeometry geometry_of(int x, int y, const Noticed& noticed) const {
    PixelGeometry geometry;
    geometry.distance_m.resize(named_);
    geometry.visibility.resize(named_);
    for (std::size_t i = 0; i < named_ && noticed.met > 0; ++i)
      geometry.visibility[i] = static_cast<double>(noticed.seen[i]) / noticed.met;
    const auto [origin_m, direction] = world_ray({static_cast<double>(x), static_cast<double>(y)});
    const auto point = caster_.closest(origin_m, direction);
    if (!point) return geometry;
    geometry.position_m = point->position_m;
    geometry.normal = point->normal;
    geometry.id = static_cast<int>(point->instance) + 1;
    for (std::size_t i = 0; i < named_; ++i) {
      const light::Sample sample = emitters_[i]->sample(point->position_m, {0, 0});
      if (sample.valid && std::isfinite(sample.distance_m)) geometry.distance_m[i] = sample.distance_m;
    }
    return geometry;
  }

  const scene::Scene& scene_;
  const scene::View& view_;
  const RayCaster& caster_;
  Transport transport_;
  Mat3 rotation_;                                // world_from_camera
  std::vector<const light::Emitter*> emitters_;  // the named ones first, then ambient
  std::size_t named_ = 0;
};

}  // namespace

std::unique_ptr<Integrator> path_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                            const Transport& transport) {
  return std::make_unique<PathIntegrator>(scene, view, caster, transport);
}

}  // namespace gonio::render
