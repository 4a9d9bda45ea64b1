#include "render/caustic.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>

#include "render/light_tracer.h"

namespace gonio::render {
namespace {

constexpr std::uint32_t photons = 20000, camera_paths = 64 * 64;
constexpr int cells = 32, most_events = 64;

class Places {  // cells of space on objects
 public:
  Places(Vec3 centre_m, double size_m) : centre_m_(centre_m), cell_m_(size_m / cells) {}
  void add(std::uint32_t instance, Vec3 p) { all_.insert(key(instance, p)); }
  bool holds(std::uint32_t instance, Vec3 p) const { return all_.contains(key(instance, p)); }
  bool empty() const { return all_.empty(); }

 private:
  std::tuple<std::uint32_t, int, int, int> key(std::uint32_t instance, Vec3 p) const {
    const Vec3 q = (p - centre_m_) / cell_m_;
    return {instance, static_cast<int>(std::floor(q.x)), static_cast<int>(std::floor(q.y)),
            static_cast<int>(std::floor(q.z))};
  }
  Vec3 centre_m_;
  double cell_m_;
  std::set<std::tuple<std::uint32_t, int, int, int>> all_;
};

// A path of either end, as far as smooth interfaces lead.
struct Landing {
  bool found = false, spread = false;
  std::uint32_t instance = 0;
  Vec3 position_m;
};
class Probe {
 public:
  Probe(const PathSetting& setting, const LightTracer& tracer) : setting_(setting), tracer_(tracer) {}
  // found: something that spreads light was reached by way of at least one smooth interface.
  Landing follow(PhotonPath path, Sampler& sampler) const {
    std::uint32_t last = 0;
    for (int event = 0; event < most_events; ++event) {
      const auto fate = tracer_.travel(path, sampler);
      if (fate == LightTracer::Fate::lost) return {};
      if (fate == LightTracer::Fate::medium) return {path.smooth > 0, true, last, path.origin_m};
      const SurfacePoint at = *path.left;
      last = at.instance;
      const int spread = path.spread;
      const bool was_smooth = path.smooth > 0;
      if (was_smooth && spreads(at, path)) return {true, true, at.instance, at.position_m};
      if (!tracer_.scatter(path, fate, sampler, 1, nullptr) || path.spread > spread) return {};
      flux_ = path.flux;
    }
    return {};
  }
  Rgb flux() const { return flux_; }

 private:
  bool spreads(const SurfacePoint& at, const PhotonPath& path) const {
    const Vertex vertex(setting_.scene, at, -path.direction);
    return !setting_.transmits[at.surface] && max_component(vertex.model->albedo(vertex.values, vertex.wo)) > 0 &&
           vertex.model->pdf(vertex.values, vertex.wo, {0, 0, 1}) > 0;
  }
  const PathSetting& setting_;
  const LightTracer& tracer_;
  mutable Rgb flux_;
};

Places seen_through_glass(const PathSetting& setting, const Probe& probe, Places places) {
  const int width = setting.view.camera.width_px(), height = setting.view.camera.height_px();
  for (std::uint32_t i = 0; i < camera_paths; ++i) {
    Sampler sampler(7, 1, i);
    const Vec2 u = sampler.two();
    const WorldRay ray = setting.rays.at({u.x * width - 0.5, u.y * height - 0.5}, sampler.two());
    PhotonPath path;
    path.flux = {1, 1, 1};
    path.origin_m = ray.origin_m;
    path.direction = ray.direction;
    path.inside = setting.camera_inside;
    const Landing landing = probe.follow(path, sampler);
    if (landing.found) places.add(landing.instance, landing.position_m);
  }
  return places;
}

Ball around_everything(const scene::Scene& scene) {
  Vec3 low{far_away, far_away, far_away}, high = -low;
  for (const scene::Instance& instance : scene.instances) {
    const Ball ball = ball_around(instance);
    const Vec3 a = ball.centre_m - Vec3{1, 1, 1} * ball.radius_m, b = ball.centre_m + Vec3{1, 1, 1} * ball.radius_m;
    low = {std::min(low.x, a.x), std::min(low.y, a.y), std::min(low.z, a.z)};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), std::max(high.z, b.z)};
  }
  return {(low + high) * 0.5, norm(high - low) / 2};
}

bool without_extent(const light::Emitter& emitter, Vec3 from_m) {
  const light::Sample sample = emitter.sample(from_m, {0.5, 0.5});
  return sample.valid && sample.delta;
}

}  // namespace

Missing missing_light(const scene::Scene& scene, std::size_t view, const RayCaster& caster) {
  Missing missing;
  const PathSetting setting(scene, view, caster, {});
  if (!setting.caustics) return missing;
  const LightTracer tracer(setting, *setting.caustics, 0);
  const Probe probe(setting, tracer);
  const Ball all = around_everything(scene);
  const Places places = seen_through_glass(setting, probe, {all.centre_m, 2 * all.radius_m});
  if (places.empty()) return missing;
  std::vector<double> lost(setting.emitters.size());
  std::vector<std::set<std::string>> objects(lost.size());
  for (std::uint32_t i = 0; i < photons; ++i) {
    Sampler sampler(8, 1, i);
    const auto path = tracer.start(sampler);
    if (!path || !without_extent(*setting.emitters[path->emitter], all.centre_m)) continue;
    const Landing landing = probe.follow(*path, sampler);
    if (!landing.found || !places.holds(landing.instance, landing.position_m)) continue;
    const auto seen = tracer.view(landing.position_m, {0.5, 0.5});
    // From a little before the camera, so that the surface itself is in nobody's way.
    if (seen && !caster.blocked(seen->sight.origin_m, -seen->to_camera, seen->distance_m * (1 - 1e-4))) continue;
    lost[path->emitter] += mean(probe.flux()) / photons;
    objects[path->emitter].insert(scene.instances[landing.instance].id);
  }
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const double share = lost[i] > 0 ? lost[i] / mean(setting.caustics->power(i)) : 0;
    if (share < 1e-4) continue;
    std::string names;
    for (const std::string& id : objects[i]) names += (names.empty() ? "" : ", ") + id;
    const std::string light = i < setting.named ? scene.appearance.lights[setting.view.lights[i]].id : "ambient";
    missing.lamps.push_back({light, share, names});
  }
  return missing;
}

std::string Missing::sentence() const {
  std::string text;
  for (const Lamp& lamp : lamps) {
    char share[32];
    std::snprintf(share, sizeof share, "%.2g %%", 100 * lamp.share);
    text += (text.empty() ? "" : "; ") + std::string("light \"") + lamp.light + "\" lacks about " + share +
            " of its power, which falls through smooth interfaces on " + lamp.objects +
            ", seen through smooth interfaces";
  }
  if (!text.empty()) text += ": give the lamp a radius, or the interface a roughness, to have it in the picture";
  return text;
}

}  // namespace gonio::render
