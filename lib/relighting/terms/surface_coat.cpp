// surface.coat: a clear coat on a part of a surface that a single object bears: what direct light changes by where it
// covers. Light by way of other surfaces is left as it is, lamps stand where the base model has them. The search starts
// with the half space, of several directions and places, in which the rough residual is most like the gloss that a coat
// would add.
#include <algorithm>
#include <cmath>

#include "relighting/image_model.h"
#include "relighting/rough.h"
#include "relighting/surface_rule.h"
#include "relighting/uses.h"
#include "surface/coat_region.h"
#include "surface/microfacet.h"

namespace gonio::mechanism {
const Mechanism& surface_coat();
const Mechanism& surface_interface();
}  // namespace gonio::mechanism

namespace gonio::relighting::terms {
namespace {

constexpr double likely_alpha = 0.3, softness = 0.02;  // of the search's start; the edge over the object's extent

struct Gleam {
  std::size_t image;
  Vec3 position_m;  // object frame
  double relative, gloss;
};

Vec3 to_lamp(const LightSource& light, Vec3 from_m) {
  return light.directional ? light.direction : normalized(light.position_m - from_m);
}

// Gloss of a likely coat over matte light, for lamps that reach the patch.
double likely_gloss(const Setting& s, const Patch& patch, const std::vector<std::size_t>& lights) {
  const Basis basis(patch.normal);
  const Vec3 wo = basis.to_local(patch.wo);
  double sum = 0;
  for (const std::size_t l : lights) {
    const Vec3 wi = basis.to_local(to_lamp(s.layout.lights[l], patch.position_m));
    if (wo.z > 0.05 && wi.z > 0.05) sum += surface::Ggx(likely_alpha).lobe(wo, wi, surface::half_vector(wo, wi));
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, lights.size()));
}

// How much of the residual a gloss within the region takes, in its own standard deviations. Every image has a
// brightness of its own (rough.h). `seen`: image after image.
double alike(const std::vector<Gleam>& seen, const surface::CoatRegion& region) {
  const Vec3 towards = region.towards();
  double covariance = 0, of_gloss = 0, of_residual = 0;
  for (std::size_t first = 0, last = 0; first < seen.size(); first = last) {
    double ry = 0, rr = 0, yy = 0, r1 = 0, y1 = 0;
    for (; last < seen.size() && seen[last].image == seen[first].image; ++last) {
      const Gleam& g = seen[last];
      const double r = g.gloss * region.cover_at(dot(towards, g.position_m));
      ry += r * g.relative, rr += r * r, yy += g.relative * g.relative, r1 += r, y1 += g.relative;
    }
    const auto n = static_cast<double>(last - first);
    covariance += ry - r1 * y1 / n, of_gloss += rr - r1 * r1 / n, of_residual += yy - y1 * y1 / n;
  }
  const double spread = of_gloss * of_residual;
  return spread > 0 ? covariance / std::sqrt(spread) : 0;
}

std::optional<surface::CoatRegion> best_region(const std::vector<Gleam>& seen, double& extent_m) {
  Vec3 lower{1e30, 1e30, 1e30}, upper = -lower;
  for (const Gleam& g : seen) {
    lower = {std::min(lower.x, g.position_m.x), std::min(lower.y, g.position_m.y), std::min(lower.z, g.position_m.z)};
    upper = {std::max(upper.x, g.position_m.x), std::max(upper.y, g.position_m.y), std::max(upper.z, g.position_m.z)};
  }
  extent_m = norm(upper - lower);
  surface::CoatRegion best;
  double most = 0;
  for (int e = -2; e <= 2; ++e)
    for (int a = 0; a < (std::abs(e) == 2 ? 1 : 8); ++a) {
      surface::CoatRegion region{a * pi / 4, e * pi / 4, 0, softness * extent_m};
      std::vector<double> along;
      for (const Gleam& g : seen) along.push_back(dot(region.towards(), g.position_m));
      std::sort(along.begin(), along.end());
      for (const double share : {0.2, 0.35, 0.5, 0.65, 0.8}) {
        region.from_m = along[static_cast<std::size_t>(share * static_cast<double>(along.size() - 1))];
        if (const double now = alike(seen, region); now > most) most = now, best = region;
      }
    }
  if (!(most > 0)) return std::nullopt;
  return best;
}

std::vector<Use> candidates(const Setting& s) {
  const RoughResidual rough = rough_residual(s);
  std::vector<Use> uses;
  const mechanism::Mechanism& m = mechanism::surface_coat();
  for (std::size_t k = 0; k < s.layout.surfaces.size(); ++k) {
    const SurfaceState& surface = s.layout.start.surfaces[k];
    const auto bears = [&](const scene::Instance& i) { return i.surface == k; };
    const auto object = std::find_if(s.scene.instances.begin(), s.scene.instances.end(), bears);
    if (std::count_if(s.scene.instances.begin(), s.scene.instances.end(), bears) != 1 || !surface.lambertian() ||
        switched_on(s.document, m.id, s.layout.surfaces[k]) || !widened(surface, mechanism::surface_interface()))
      continue;
    const auto object_from_world = inverse(object->world_from_object);
    std::vector<Gleam> seen;
    for (const RoughResidual::Sight& sight : rough.sights) {
      if (sight.surface != k) continue;
      const Recording& image = s.recordings.images[sight.image];
      const ViewCache& cache = s.model.cache(image.view);
      const Patch& patch = cache.patches[cache.facets[sight.facet].first_patch];
      seen.push_back({sight.image, object_from_world * patch.position_m, std::clamp(sight.relative, -1.0, 2.0),
                      likely_gloss(s, patch, image.lights)});
    }
    if (seen.size() < 50) continue;
    double extent_m = 0;
    const auto region = best_region(seen, extent_m);
    if (!region) continue;
    Use use = target_use(m, {s.layout.surfaces[k]}, {k}, false);
    const double start[4] = {region->azimuth_rad, region->elevation_rad, region->from_m, region->edge_m};
    for (std::size_t i = 0; i < 4; ++i) use.numbers[2 + i].start = use.numbers[2 + i].neutral = start[i];
    use.numbers[4].lower = region->from_m - extent_m, use.numbers[4].upper = region->from_m + extent_m;
    use.numbers[5].lower = 0.1 * softness * extent_m, use.numbers[5].upper = 0.3 * extent_m;
    uses.push_back(use);
  }
  return uses;
}

struct Frames final : Prepared {
  Rigid<frame::Object, frame::World> object_from_world;
};
std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  auto result = std::make_shared<Frames>();
  for (const scene::Instance& i : s.scene.instances)
    if (i.surface == use.targets[0]) result->object_from_world = inverse(i.world_from_object);
  return result;
}

// The surface bare and coated, each with a black and a white base. Where nothing but the albedo has a colour, one
// evaluation with a base that is black in red and white in green yields both.
struct BareAndCoated {
  const surface::Model* model = nullptr;
  surface::Values black, white, coated_black, coated_white;
  bool at_once = false;
  BareAndCoated(SurfaceState surface, std::span<const double> amounts) {
    widen(surface, *widened(surface, mechanism::surface_interface()));
    model = surface.model;
    const std::size_t albedo = parameter_index(*model, "albedo");
    black = white = surface.values;
    black.v[albedo] = {0, 0, 0};
    const auto& parameters = model->info().parameters;
    at_once = std::ranges::count(parameters, 3, &manifest::ParameterInfo::components) == 1;
    white.v[albedo] = {at_once ? 0.0 : 1.0, 1, 1};
    coated_black = coated(black, amounts);
    coated_white = coated(white, amounts);
  }
  surface::Values coated(surface::Values values, std::span<const double> amounts) const {
    values.v[parameter_index(*model, "f0")] = {amounts[0], amounts[0], amounts[0]};
    values.v[parameter_index(*model, "alpha")] = {amounts[1], amounts[1], amounts[1]};
    return values;
  }
  Scattered change(Vec3 wo, Vec3 wi) const {
    if (at_once) {
      const Rgb had = model->evaluate(white, wo, wi), has = model->evaluate(coated_white, wo, wi);
      const double gloss = has.x - had.x, base = has.y - has.x - (had.y - had.x);
      return {{base, base, base}, {gloss, gloss, gloss}};
    }
    const Rgb had = model->evaluate(black, wo, wi), has = model->evaluate(coated_black, wo, wi);
    return {model->evaluate(coated_white, wo, wi) - has - (model->evaluate(white, wo, wi) - had), has - had};
  }
};

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const std::span<const double> a = use.amounts(frame.state);
  const auto& pose = static_cast<const Frames&>(*use.prepared).object_from_world;
  const surface::CoatRegion region{a[2], a[3], a[4], a[5]};
  const Vec3 towards = region.towards();
  const SceneLayout& layout = frame.model.layout();
  const SurfaceState& surface = frame.state.surfaces[use.targets[0]];
  if (!widened(surface, mechanism::surface_interface())) return;
  const BareAndCoated pair(surface, a);
  std::vector<RadiusWeights> radii;
  for (const std::size_t l : frame.image.lights) radii.emplace_back(frame.state.lights[l].radius_m);
  std::size_t slot = 0;
  for (const std::uint32_t p : frame.picked)
    for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
      const Facet& facet = frame.cache.facets[frame.cache.pixels[p].first_facet + k];
      if (facet.surface != use.targets[0]) continue;
      for (std::size_t place = facet.first_patch; place < facet.first_patch + facet.patches; ++place) {
        const Patch& patch = frame.cache.patches[place];
        const double cover = region.cover_at(dot(towards, pose * patch.position_m));
        const Basis basis(patch.normal);
        const Vec3 wo = basis.to_local(patch.wo);
        for (std::size_t j = 0; j < shading.lights; ++j) {
          const std::size_t l = frame.image.lights[j];
          const Vec3 wi = basis.to_local(to_lamp(layout.lights[l], patch.position_m));
          const double light = radii[j].of(&frame.cache.direct[(place * layout.lights.size() + l) * radii_m.size()]);
          if (!(light * cover > 1e-12 && wi.z > 0 && wo.z > 0)) continue;
          const Scattered change = pair.change(wo, wi);
          Scattered& direct = shading.direct[slot * shading.lights + j];
          direct.base += change.base * (light * cover * patch.weight);
          direct.gloss += change.gloss * (light * cover * patch.weight);
        }
      }
    }
}

}  // namespace

const Term& surface_coat() {
  static const Term term{
      .mechanism = mechanism::surface_coat,
      .reach = Reach::shade,
      .order = -5,
      .candidates = candidates,
      .prepare = prepare,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
