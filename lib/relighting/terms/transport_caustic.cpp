// transport.caustic: photons of every lamp are followed through smooth interfaces (render/light_tracer.h) to the first
// surface that spreads them; a facet receives the flux of those that landed on its surface within its pixel, over the
// area that the pixel cuts out of the surface's tangent plane. Matte light only. Pixels that show the glass itself are
// left out of the comparison (explain/images/images_problem.cpp).
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "relighting/image_model.h"
#include "relighting/uses.h"
#include "render/light_tracer.h"

namespace gonio::mechanism {
const Mechanism& transport_caustic();
}

namespace gonio::relighting::terms {
namespace {

constexpr std::uint32_t photons = 200000;  // for every set of lamps that shine together
constexpr int most_events = 64;
constexpr double near_px = 3;  // of a facet's middle: further away another part of the surface is hidden behind it

struct Landing {
  std::size_t light = 0;
  std::uint32_t surface = 0;
  Vec3 position_m;
  Rgb flux;  // per unit of the lamp's intensity
};

bool spreads(const render::PathSetting& setting, const render::PhotonPath& path) {
  const render::Vertex vertex(setting.scene, *path.left, -path.direction);
  return !setting.transmits[path.left->surface] && vertex.model->pdf(vertex.values, vertex.wo, {0, 0, 1}) > 0;
}

// The flux and place of a photon that reaches a spreading surface by way of smooth interfaces alone.
std::optional<Landing> followed(const render::PathSetting& setting, const render::LightTracer& tracer,
                                render::PhotonPath path, render::Sampler& sampler) {
  for (int event = 0; event < most_events; ++event) {
    const auto fate = tracer.travel(path, sampler);
    if (fate != render::LightTracer::Fate::surface) return {};
    if (spreads(setting, path)) {
      if (path.smooth == 0) return {};
      return Landing{0, path.left->surface, path.left->position_m, path.flux};
    }
    const int spread = path.spread;
    if (!tracer.scatter(path, fate, sampler, 1, nullptr) || path.spread > spread) return {};
  }
  return {};
}

std::vector<Landing> landings(const Setting& s) {
  std::vector<Landing> all;
  std::set<std::vector<std::size_t>> done;
  std::set<std::size_t> traced;
  for (const Recording& image : s.recordings.images) {
    if (!done.insert(image.lights).second) continue;
    const render::PathSetting setting(s.scene, image.entry, s.caster, {});
    if (!setting.caustics || !setting.caustics->any()) continue;
    const render::LightTracer tracer(setting, *setting.caustics, 0);
    const std::set<std::size_t> before = traced;
    for (std::uint32_t i = 0; i < photons; ++i) {
      render::Sampler sampler(9, 1, i);
      const auto path = tracer.start(sampler);
      if (!path || path->emitter >= image.lights.size() || before.contains(image.lights[path->emitter])) continue;
      auto landing = followed(setting, tracer, *path, sampler);
      if (!landing) continue;
      landing->light = image.lights[path->emitter];
      const Rgb intensity = s.layout.start.lights[landing->light].intensity;
      if (!(intensity.x > 0 && intensity.y > 0 && intensity.z > 0)) continue;
      const Rgb flux = landing->flux * (1.0 / photons);
      landing->flux = {flux.x / intensity.x, flux.y / intensity.y, flux.z / intensity.z};
      all.push_back(*landing);
    }
    traced.insert(image.lights.begin(), image.lights.end());
  }
  return all;
}

struct Gathered final : Prepared {
  std::vector<std::vector<Rgb>> irradiance;  // [view][facet][light], of the pixel, per unit of intensity
};

// Where the ray through a pixel position meets the tangent plane of a patch.
Vec3 on_plane(const View& view, const Patch& patch, Vec2 pixel) {
  const camera::Ray ray = view.model.ray(pixel);
  const Vec3 origin_m = view.world_from_camera * ray.origin_m;
  const Vec3 direction = view.world_from_camera.rotate(ray.direction);
  return origin_m + direction * (dot(patch.position_m - origin_m, patch.normal) / dot(direction, patch.normal));
}

struct Footprint {
  double area_m2 = 0, reach_m = 0;
};
Footprint footprint(const View& view, const Patch& patch, const Pixel& pixel) {
  const double x = pixel.x, y = pixel.y;
  const Vec3 across = on_plane(view, patch, {x + 0.5, y}) - on_plane(view, patch, {x - 0.5, y});
  const Vec3 down = on_plane(view, patch, {x, y + 0.5}) - on_plane(view, patch, {x, y - 0.5});
  return {norm(cross(across, down)), near_px * std::max(norm(across), norm(down))};
}

std::vector<Rgb> gathered(const Setting& s, std::size_t v, const std::vector<Landing>& all) {
  const ViewCache& cache = s.model.cache(v);
  const View& view = s.recordings.views[v];
  const std::size_t lights = s.layout.lights.size();
  std::map<std::pair<int, int>, std::size_t> place;
  for (std::size_t p = 0; p < cache.pixels.size(); ++p) place[{cache.pixels[p].x, cache.pixels[p].y}] = p;
  std::vector<Rgb> irradiance(cache.facets.size() * lights);
  const auto camera_from_world = inverse(view.world_from_camera);
  for (const Landing& landing : all) {
    const auto seen = view.model.project(camera_from_world * landing.position_m);
    if (!seen) continue;
    const auto found = place.find({static_cast<int>(std::lround(seen->x)), static_cast<int>(std::lround(seen->y))});
    if (found == place.end()) continue;
    const Pixel& pixel = cache.pixels[found->second];
    for (std::size_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f) {
      if (cache.facets[f].surface != landing.surface) continue;
      const Patch& patch = cache.patches[cache.facets[f].first_patch];
      const Footprint print = footprint(view, patch, pixel);
      if (norm(landing.position_m - patch.position_m) < print.reach_m)
        irradiance[f * lights + landing.light] += landing.flux * (1 / print.area_m2);
    }
  }
  return irradiance;
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use&) {
  const std::vector<Landing> all = landings(s);
  auto result = std::make_shared<Gathered>();
  for (std::size_t v = 0; v < s.model.views(); ++v) result->irradiance.push_back(gathered(s, v, all));
  return result;
}

std::vector<Use> candidates(const Setting& s) {
  const bool glass = std::ranges::any_of(s.scene.appearance.surfaces,
                                         [](const scene::Surface& surface) { return surface.model->transmits(); });
  if (!glass || switched_on(s.document, mechanism::transport_caustic().id)) return {};
  return {scene_use(mechanism::transport_caustic())};
}

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const double strength = use.amounts(frame.state)[0];
  const std::vector<Rgb>& table = static_cast<const Gathered&>(*use.prepared).irradiance[frame.image.view];
  const std::size_t lights = frame.model.layout().lights.size();
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    Rgb sum;
    for (std::size_t k = 0; k < pixel.facets; ++k) {
      const std::size_t f = pixel.first_facet + k;
      const SurfaceState& surface = frame.state.surfaces[frame.cache.facets[f].surface];
      if (!has_parameter(*surface.model, "albedo")) continue;
      const Rgb albedo = surface.values.rgb(parameter_index(*surface.model, "albedo"));
      for (const std::size_t l : frame.image.lights)
        sum += albedo * table[f * lights + l] * frame.state.lights[l].intensity * (1 / pi);
    }
    sum *= exposure_of(frame.state, frame.image, frame.number, pixel) * strength;
    for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] += sum[static_cast<int>(c)];
  }
}

}  // namespace

const Term& transport_caustic() {
  static const Term term{
      .mechanism = mechanism::transport_caustic,
      .reach = Reach::add,
      .candidates = candidates,
      .prepare = prepare,
      .add = add,
  };
  return term;
}

}  // namespace gonio::relighting::terms
