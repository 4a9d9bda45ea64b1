// Path tracing; see path_tracer.h. World frame, metres.
//
//   L(x, wo) = L_e + sum over lights  f cos weight V + integral of  f cos L(y, -wi) dwi           (Kajiya 1986,
//   equation 1)
// split for transport.indirect into what the camera receives from lights directly or after one scattering event, and
// the rest:
//   pixel = gain vignetting (L_direct + strength L_indirect)
#include "render/path_tracer.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/random.h"
#include "render/image_seed.h"
#include "render/strata.h"

namespace gonio::render {
namespace {

constexpr int tile = 16;          // pixels per side of a unit of parallel work
constexpr int roulette_from = 3;  // scattering events before paths may be ended at random

// Veach 1997, equation 9.13 with beta = 2.
double power_heuristic(double pdf, double other) {
  return pdf * pdf / (pdf * pdf + other * other);
}

struct Split {  // radiance by the number of scattering events
  Rgb direct, indirect;
};

// A surface point prepared for shading: directions are local to the shading normal.
struct Vertex {
  const SurfacePoint& point;
  const surface::Model& model;
  surface::Values values;
  Basis basis;
  Vec3 wo;
  Vertex(const SurfacePoint& at, const scene::Surface& surface, Vec3 to_eye)
      : point(at),
        model(*surface.model),
        values(surface.textures.empty() ? surface.values : surface.values_at(at.uv)),
        basis(at.normal),
        wo(basis.to_local(to_eye)) {}
};

class Tracer {
 public:
  Tracer(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Options& options)
      : scene_(scene),
        view_(scene.views[view]),
        caster_(caster),
        options_(options),
        plan_(sample_plan(options.spp)),
        rotation_(matrix_of(view_.world_from_camera.rotation)),
        seed_(seed_of(options.seed, view_.image)) {
    for (const std::size_t light : view_.lights) emitters_.push_back(scene.appearance.lights[light].emitter.get());
    named_ = emitters_.size();
    if (scene.appearance.ambient) emitters_.push_back(scene.appearance.ambient.get());
  }

  // What a thread needs while it works on a tile.
  struct Scratch {
    Strata strata;
    std::vector<std::uint32_t> seen;  // unoccluded samples of each light at the first surface
    std::uint32_t met = 0;            // samples that met a surface
  };
  Scratch scratch() const {
    return {Strata(plan_.side, dimensions()), std::vector<std::uint32_t>(emitters_.size()), 0};
  }

  Pixel pixel(int x, int y, Scratch& scratch) const {
    Pixel result;
    std::fill(scratch.seen.begin(), scratch.seen.end(), 0u);
    scratch.met = 0;
    Rgb spread;  // sum of squared deviations (Welford 1962)
    for (int replicate = 0; replicate < plan_.replicates; ++replicate) {
      throw_if_interrupted();  // a tile with a million samples per pixel lasts minutes
      const Rgb value = replicate_mean(x, y, replicate, scratch);
      const Rgb step = value - result.mean;
      result.mean += step / (replicate + 1);
      spread += step * (value - result.mean);
    }
    result.variance = spread / (static_cast<double>(plan_.replicates) * (plan_.replicates - 1));
    if (options_.geometry) result.geometry = geometry(x, y, scratch);
    return result;
  }

 private:
  // Dimensions that are stratified: the pixel, each light and the continued direction at the first surface.
  std::size_t dimensions() const { return emitters_.size() + 2; }
  std::size_t direction_dimension() const { return emitters_.size() + 1; }

  Rgb replicate_mean(int x, int y, int replicate, Scratch& scratch) const {
    const auto pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(view_.camera.width_px()) +
                       static_cast<std::uint64_t>(x);
    const std::uint64_t stream = ((pixel << 24) + static_cast<std::uint64_t>(replicate)) << 7;
    Random order(seed_, stream + scratch.strata.cells());
    scratch.strata.shuffle(order);
    Rgb sum;
    for (std::size_t sample = 0; sample < scratch.strata.cells(); ++sample) {
      Random random(seed_, stream + sample);  // of its own, so that the length of one path does not disturb the next
      const Vec2 at = Vec2{x - 0.5, y - 0.5} + scratch.strata.draw(0, sample, random);
      const Split light = trace(at, sample, random, scratch);
      const double factor = scene::vignetting(scene_.appearance.vignetting_falloff, view_.camera.width_px(),
                                              view_.camera.height_px(), at);
      sum += (light.direct + light.indirect * scene_.appearance.indirect_strength) * factor;
    }
    return sum * view_.gain / static_cast<double>(scratch.strata.cells());
  }

  std::pair<Vec3, Vec3> world_ray(Vec2 pixel) const {
    const camera::Ray ray = view_.camera.ray(pixel);
    return {rotation_ * ray.origin_m + view_.world_from_camera.translation_m, rotation_ * ray.direction};
  }

  Split trace(Vec2 pixel, std::size_t sample, Random& random, Scratch& scratch) const {
    auto [origin_m, direction] = world_ray(pixel);
    auto point = caster_.closest(origin_m, direction);
    Split light{.direct = seen_lights(origin_m, direction, point), .indirect = {}};
    if (point) ++scratch.met;
    Rgb throughput{1, 1, 1};
    for (int event = 1; point && event <= options_.max_bounces; ++event) {
      const bool first = event == 1;
      const Vertex vertex(*point, scene_.appearance.surfaces[point->surface], -direction);
      Rgb& sum = first ? light.direct : light.indirect;
      for (std::size_t i = 0; i < emitters_.size(); ++i) {
        const Vec2 u = first ? scratch.strata.draw(i + 1, sample, random) : Vec2{random.uniform(), random.uniform()};
        sum += throughput * from_light(vertex, *emitters_[i], u, first ? &scratch.seen[i] : nullptr);
      }
      const Vec2 u =
          first ? scratch.strata.draw(direction_dimension(), sample, random) : Vec2{random.uniform(), random.uniform()};
      const surface::Sample next = vertex.model.sample(vertex.values, vertex.wo, u, random.uniform());
      if (!(next.pdf > 0)) break;
      direction = vertex.basis.to_world(next.wi);
      if (!(dot(point->geometric_normal, direction) > 0)) break;
      throughput *= next.weight;
      const auto beyond = caster_.closest_from(*point, direction);
      if (options_.estimator == Estimator::combined)
        sum += throughput * met_lights(point->position_m, direction, next.pdf, beyond);
      if (first && scene_.appearance.indirect_strength == 0) break;
      if (!survives(event, throughput, random)) break;
      point = beyond;
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
  static bool survives(int event, Rgb& throughput, Random& random) {
    const double q = std::min(1.0, max_component(throughput));
    if (!(q > 0)) return false;
    if (event < roulette_from || q == 1) return true;
    if (random.uniform() >= q) return false;
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
    const Vec3 wi = vertex.basis.to_local(sample.direction);
    const Rgb f = wi.z > 0 ? vertex.model.evaluate(vertex.values, vertex.wo, wi) : Rgb{};
    const bool dark = max_component(f) <= 0;
    if ((dark && !seen) || caster_.occluded(vertex.point, sample.direction, sample.distance_m)) return {};
    if (seen) ++*seen;
    if (dark) return {};
    const bool alone = sample.delta || options_.estimator == Estimator::lights_only;
    const double share = alone ? 1 : power_heuristic(sample.pdf, vertex.model.pdf(vertex.values, vertex.wo, wi));
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

  PixelGeometry geometry(int x, int y, const Scratch& scratch) const {
    PixelGeometry geometry;
    geometry.distance_m.resize(named_);
    geometry.visibility.resize(named_);
    for (std::size_t i = 0; i < named_ && scratch.met > 0; ++i)
      geometry.visibility[i] = static_cast<double>(scratch.seen[i]) / scratch.met;
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
  const Options& options_;
  SamplePlan plan_;
  Mat3 rotation_;  // world_from_camera
  std::uint64_t seed_;
  std::vector<const light::Emitter*> emitters_;  // the named ones first, then ambient
  std::size_t named_ = 0;
};

}  // namespace

io::Image render(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Options& options) {
  const scene::View& what = scene.views[view];
  const int width = what.camera.width_px(), height = what.camera.height_px();
  const Tracer tracer(scene, view, caster, options);
  std::vector<Pixel> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int columns = (width + tile - 1) / tile, rows = (height + tile - 1) / tile;
  Progress progress(what.image, pixels.size());
  parallel_for(0, static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t index) {
    Tracer::Scratch scratch = tracer.scratch();
    const int left = static_cast<int>(index) % columns * tile, top = static_cast<int>(index) / columns * tile;
    const int right = std::min(left + tile, width), bottom = std::min(top + tile, height);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
            tracer.pixel(x, y, scratch);
    progress.advance(static_cast<std::uint64_t>(right - left) * static_cast<std::uint64_t>(bottom - top));
  });
  std::vector<std::string> lights;
  for (const std::size_t light : what.lights) lights.push_back(scene.appearance.lights[light].id);
  return develop(width, height, pixels, lights, options.geometry);
}

}  // namespace gonio::render
