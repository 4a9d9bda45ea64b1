// Filling of the light cache: camera rays, shadow rays, diffuse paths.
//
// Sub-samples are jittered on a grid, whose error for an edge falls as samples^(-3/4) (Mitchell 1996); direct_sigma is
// the spread of the sub-samples divided by that. Spheres are sampled in the cone they subtend (Shirley, Wang &
// Zimmerman 1996) with the same two numbers for all radii, so that the tables are smooth in the radius; radiance I /
// (pi r^2) keeps the intensity I. Paths: directions by cosine (density cos / pi), the first stratified; no roulette,
// cut at the monomials' degree.
#include "relighting/light_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"
#include "relighting/lamp_shadows.h"
#include "render/ray_caster.h"
#include "surface/microfacet.h"

namespace gonio::relighting {
namespace {

using render::RayCaster;
using render::SurfacePoint;

constexpr std::size_t radius_count = radii_m.size();
constexpr double gloss_alpha = 0.1;     // roughness of the lobe that `mirrored` is collected from
constexpr double margin_change = 0.02;  // relative change of the irradiance that tells that an edge is near

struct SubSample {
  bool found = false;
  int column = 0, row = 0;  // of the pixel's sub-samples
  SurfacePoint point;
  Vec3 wo;
};

// V cos / d^2 of a small light (V cos of a directional one).
struct SmallLight {
  bool visible = false;
  double irradiance = 0;
};
SmallLight small_light(const RayCaster& caster, const SurfacePoint& point, const LightSource& light) {
  Vec3 wi = light.direction;
  double distance_m = render::far_away, falloff = 1;
  if (!light.directional) {
    const Vec3 to_light = light.position_m - point.position_m;
    const double square = dot(to_light, to_light);
    distance_m = std::sqrt(square);
    wi = to_light / distance_m;
    falloff = 1 / square;
  }
  const bool visible = !caster.occluded(point, wi, distance_m);
  return {visible, visible ? std::max(0.0, dot(point.normal, wi)) * falloff : 0};
}

// A direction in the cone of a sphere; `cap` is 1 - cos of the cone's half angle.
struct ConeSample {
  Vec3 wi;
  double distance_m, cap;
};
ConeSample sample_cone(const SurfacePoint& point, const LightSource& light, double radius_m, Vec2 u) {
  const Vec3 to_light = light.position_m - point.position_m;
  const double square = dot(to_light, to_light), distance_m = std::sqrt(square);
  const double sine2 = std::min(1.0, radius_m * radius_m / square);
  const double cap = sine2 / (1 + std::sqrt(1 - sine2));  // without cancellation
  const double z = 1 - u.x * cap, across = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * pi * u.y;
  return {Basis(to_light / distance_m).to_world({across * std::cos(phi), across * std::sin(phi), z}),
          distance_m - radius_m, cap};
}

// One sample of the irradiance of a sphere of unit intensity, 1/m^2.
double sphere_light(const RayCaster& caster, const SurfacePoint& point, const LightSource& light, double radius_m,
                    Vec2 u) {
  const ConeSample s = sample_cone(point, light, radius_m, u);
  const double cosine = dot(point.normal, s.wi);
  if (cosine <= 0 || caster.occluded(point, s.wi, s.distance_m)) return 0;
  return cosine * 2 * s.cap / (radius_m * radius_m);
}

// What hides the largest sphere from a facet, as far as a few rays from each sub-sample tell.
enum class Edges { none, near, hidden };
Edges edges_near(const RayCaster& caster, const std::vector<const SubSample*>& samples, const LightSource& light,
                 Random& random) {
  constexpr int rays = 4;
  std::size_t seen = 0;
  bool above = true;
  for (const SubSample* s : samples) {
    const Vec3 to_light = light.position_m - s->point.position_m;
    above = above && dot(s->point.normal, to_light) > radii_m.back() &&
            dot(s->point.geometric_normal, to_light) > radii_m.back();
    for (int k = 0; k < rays; ++k) {
      const ConeSample c =
          sample_cone(s->point, light, radii_m.back(), {random.uniform(), (k + random.uniform()) / rays});
      if (!caster.occluded(s->point, c.wi, c.distance_m)) ++seen;
    }
  }
  if (seen == 0) return Edges::hidden;
  return above && seen == samples.size() * rays ? Edges::none : Edges::near;
}

Vec3 cosine_about(Vec3 normal, Vec2 u) {  // density cos / pi
  const double across = std::sqrt(u.x), phi = 2 * pi * u.y;
  return Basis(normal).to_world({across * std::cos(phi), across * std::sin(phi), std::sqrt(1 - u.x)});
}

// Sums of what paths brought from every source, term by term, and the spread of that at albedo 1/2.
struct Gathered {
  std::vector<double> coefficient, sum, square, path, lit;
  Gathered(std::size_t lights, const render::Monomials& monomials)
      : coefficient((lights + 1) * monomials.size()),
        sum(lights + 1),
        square(lights + 1),
        path(lights + 1),
        lit(lights * monomials.surfaces() * 4) {}
};

// The cache of one pixel: facets, patches and tables numbered from zero.
class PixelBuilder {
 public:
  PixelBuilder(const RayCaster& caster, const View& view, std::span<const LightSource> lights,
               const render::Monomials& monomials, const CacheOptions& options)
      : caster_(caster), view_(view), lights_(lights), monomials_(monomials), options_(options) {}

  ViewCache operator()(int x, int y) const {
    Random random(options_.seed, static_cast<std::uint64_t>(y) * 65536u + static_cast<std::uint64_t>(x));
    const std::vector<SubSample> samples = look(x, y, random);
    std::vector<std::uint32_t> surfaces;
    std::size_t found = 0;
    for (const SubSample& s : samples) {
      if (!s.found) continue;
      ++found;
      if (std::find(surfaces.begin(), surfaces.end(), s.point.surface) == surfaces.end())
        surfaces.push_back(s.point.surface);
    }
    std::sort(surfaces.begin(), surfaces.end());
    ViewCache out;
    const auto sky = 1 - static_cast<double>(found) / static_cast<double>(samples.size());
    out.pixels.push_back({x, y, static_cast<float>(sky), 0, static_cast<std::uint32_t>(surfaces.size())});
    for (const std::uint32_t surface : surfaces) add_facet(samples, surface, random, out);
    return out;
  }

 private:
  std::vector<SubSample> look(int x, int y, Random& random) const {
    const int side = options_.samples;
    std::vector<SubSample> samples;
    samples.reserve(static_cast<std::size_t>(side * side));
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        Vec2 at{x - 0.5 + (i + random.uniform()) / side, y - 0.5 + (j + random.uniform()) / side};
        if (options_.outer_px > 0) at = beside(x, y, i, j, random);
        const camera::Ray ray = view_.model.ray(at);
        const Vec3 direction = view_.world_from_camera.rotate(ray.direction);
        const auto met = caster_.closest(view_.world_from_camera * ray.origin_m, direction);
        samples.push_back({met.has_value(), i, j, met.value_or(SurfacePoint{}), -direction});
      }
    return samples;
  }

  // Anywhere in the pixel, moved into sector i and band j of the ring; both are stratified, in another order.
  Vec2 beside(int x, int y, int i, int j, Random& random) const {
    const int n = options_.samples;
    const double inner2 = options_.inner_px * options_.inner_px, outer2 = options_.outer_px * options_.outer_px;
    const double r = std::sqrt(inner2 + (j + random.uniform()) / n * (outer2 - inner2));
    const double phi = 2 * pi * (i + random.uniform()) / n;
    const double u = ((i + j) % n + random.uniform()) / n, v = ((i + 2 * j) % n + random.uniform()) / n;
    return {x - 0.5 + u + r * std::cos(phi), y - 0.5 + v + r * std::sin(phi)};
  }

  void add_facet(const std::vector<SubSample>& samples, std::uint32_t surface, Random& random, ViewCache& out) const {
    std::vector<const SubSample*> mine;
    for (const SubSample& s : samples)
      if (s.found && s.point.surface == surface) mine.push_back(&s);
    const std::vector<std::vector<const SubSample*>> patches = parted(mine);
    std::vector<Edges> edges;
    for (const LightSource& light : lights_)
      edges.push_back(light.directional || !options_.penumbrae ? Edges::none
                                                               : edges_near(caster_, mine, light, random));
    Facet facet{surface, 0, static_cast<std::uint32_t>(out.patches.size()), static_cast<std::uint32_t>(patches.size())};
    Spread spread(lights_.size());
    for (const auto& patch : patches) {
      out.patches.push_back(mean_patch(patch, samples.size()));
      facet.weight += out.patches.back().weight;
      for (std::size_t l = 0; l < lights_.size(); ++l) add_direct(patch, l, edges[l], random, spread, out);
    }
    out.facets.push_back(facet);
    if (options_.shadows) {
      std::vector<const SurfacePoint*> points;
      for (const SubSample* sample : mine) points.push_back(&sample->point);
      for (const LightSource& light : lights_) {
        const bool any = cast_shadows_about(caster_, points, light, out.shadows);
        out.shadow_table.push_back(any ? static_cast<std::int32_t>(out.shadows.size() / shadow_nodes) - 1 : -1);
      }
    }
    const double n = static_cast<double>(mine.size());
    for (std::size_t l = 0; l < lights_.size(); ++l) {
      const double mean = spread.sum[l] / n;
      out.direct_sigma.push_back(
          static_cast<float>(std::sqrt(std::max(0.0, spread.square[l] / n - mean * mean)) / std::pow(n, 0.75)));
    }
    out.margin.insert(out.margin.end(), spread.margin.begin(), spread.margin.end());
    add_indirect(mine, random, out);
  }

  // As few patches as keep the normals of each together. GGX of roughness alpha at its peak, with the mean normal of a
  // square over which normals turn by d along each side instead of all of them: too high by d^2 / (3 alpha^2), 0.7 % of
  // a lobe of 0.05 here; less beside the peak, and none of its integral.
  std::vector<std::vector<const SubSample*>> parted(const std::vector<const SubSample*>& samples) const {
    constexpr double most_turn_rad = 0.01;  // from corner to corner
    Vec3 sum;
    for (const SubSample* s : samples) sum += s->point.normal;
    const Vec3 mean = normalized(sum);
    double least = 1;
    for (const SubSample* s : samples) least = std::min(least, dot(s->point.normal, mean));
    const double turn = 2 * std::acos(std::clamp(least, -1.0, 1.0));
    int side = 1;
    while (side < options_.patches && turn > side * most_turn_rad) side = std::min(2 * side, options_.patches);
    std::vector<std::vector<const SubSample*>> patches(static_cast<std::size_t>(side * side));
    for (const SubSample* s : samples) {
      const int place = side * s->column / options_.samples + side * (side * s->row / options_.samples);
      patches[static_cast<std::size_t>(place)].push_back(s);
    }
    std::erase_if(patches, [](const auto& p) { return p.empty(); });
    return patches;
  }

  static Patch mean_patch(const std::vector<const SubSample*>& samples, std::size_t of_pixel) {
    Patch patch;
    for (const SubSample* s : samples) {
      patch.position_m += s->point.position_m;
      patch.normal += s->point.normal;
      patch.wo += s->wo;
    }
    const double n = static_cast<double>(samples.size());
    patch.weight = static_cast<float>(n / static_cast<double>(of_pixel));
    patch.position_m = patch.position_m / n;
    patch.normal = normalized(patch.normal);
    patch.wo = normalized(patch.wo);
    return patch;
  }

  struct Spread {  // of the small lights' irradiance within a facet
    std::vector<double> sum, square;
    std::vector<float> margin;
    explicit Spread(std::size_t lights)
        : sum(lights), square(lights), margin(lights, std::numeric_limits<float>::quiet_NaN()) {}
  };

  void add_direct(const std::vector<const SubSample*>& samples, std::size_t l, Edges edges, Random& random,
                  Spread& spread, ViewCache& out) const {
    const LightSource& light = lights_[l];
    std::array<double, radius_count> mean{};
    double visible = 0;
    for (const SubSample* s : samples) {
      const SmallLight small = small_light(caster_, s->point, light);
      visible += small.visible ? 1 : 0;
      spread.sum[l] += small.irradiance;
      spread.square[l] += small.irradiance * small.irradiance;
      mean[0] += small.irradiance;
      const Vec2 u{random.uniform(), random.uniform()};
      for (std::size_t r = 1; r < radius_count; ++r)
        mean[r] += edges == Edges::near ? sphere_light(caster_, s->point, light, radii_m[r], u) : small.irradiance;
    }
    const double n = static_cast<double>(samples.size());
    for (std::size_t r = 0; r < radius_count; ++r) out.direct.push_back(static_cast<float>(mean[r] / n));
    out.visible.push_back(static_cast<float>(visible / n));
    if (edges != Edges::near) return;
    for (std::size_t r = 1; r < radius_count; ++r)
      if (std::abs(mean[r] - mean[0]) > margin_change * std::max(mean[0], mean[r])) {
        const auto angle = static_cast<float>(radii_m[r] / norm(light.position_m - samples[0]->point.position_m));
        if (!(spread.margin[l] <= angle)) spread.margin[l] = angle;
        break;
      }
  }

  // Follows a diffuse path that leaves `at` along `wi`; every surface that it meets sends on what the lights give it.
  void follow(SurfacePoint at, Vec3 wi, Random& random, Gathered& gathered) const {
    const std::size_t lights = lights_.size(), terms = monomials_.size();
    std::fill(gathered.path.begin(), gathered.path.end(), 0.0);
    std::size_t term = 0;
    double albedo = 1;
    while (dot(wi, at.geometric_normal) > 0) {
      const auto next = caster_.closest_from(at, wi);
      if (!next) {
        gathered.coefficient[lights * terms + term] += pi;
        gathered.path[lights] += pi * albedo;
        break;
      }
      term = monomials_.times(term, next->surface);
      if (term >= terms) break;
      albedo *= 0.5;
      for (std::size_t l = 0; l < lights; ++l) {
        const double irradiance = small_light(caster_, *next, lights_[l]).irradiance;
        gathered.coefficient[l * terms + term] += irradiance;
        gathered.path[l] += irradiance * albedo;
        if (lights_[l].directional || irradiance == 0) continue;
        const Vec3 away = normalized(next->position_m - lights_[l].position_m) * (irradiance * albedo);
        double* lit = &gathered.lit[(l * monomials_.surfaces() + next->surface) * 4];
        lit[0] += away.x, lit[1] += away.y, lit[2] += away.z, lit[3] += irradiance * albedo;
      }
      at = *next;
      const double u = random.uniform();
      wi = cosine_about(at.normal, {u, random.uniform()});
    }
    for (std::size_t s = 0; s < gathered.path.size(); ++s) {
      gathered.sum[s] += gathered.path[s];
      gathered.square[s] += gathered.path[s] * gathered.path[s];
    }
  }

  // Light by way of other surfaces. Paths start at the sub-samples in turn.
  void add_indirect(const std::vector<const SubSample*>& mine, Random& random, ViewCache& out) const {
    if (options_.paths == 0) return;
    Gathered diffuse(lights_.size(), monomials_), gloss = diffuse;
    for (int k = 0; k < options_.paths; ++k) {
      const SurfacePoint& at = mine[static_cast<std::size_t>(k) % mine.size()]->point;
      const double u = (k + random.uniform()) / options_.paths;
      follow(at, cosine_about(at.normal, {u, random.uniform()}), random, diffuse);
    }
    const surface::Ggx lobe(gloss_alpha);
    int reflected = 0;
    for (int k = 0; k < options_.paths / 4; ++k) {
      const SubSample& from = *mine[static_cast<std::size_t>(k) % mine.size()];
      const Basis basis(from.point.normal);
      const Vec3 wo = basis.to_local(from.wo);
      const double u = random.uniform();
      const Vec3 wi = wo.z > 0 ? surface::mirrored(wo, lobe.visible_normal(wo, {u, random.uniform()})) : Vec3{};
      if (wi.z <= 0) continue;
      ++reflected;
      follow(from.point, basis.to_world(wi), random, gloss);
    }
    const double n = std::max(1, options_.paths), m = std::max(1, reflected);
    for (const double c : diffuse.coefficient) out.indirect.push_back(static_cast<float>(c / n));
    for (const double c : diffuse.lit) out.lit.push_back(static_cast<float>(c / n));
    for (const double c : gloss.coefficient) out.mirrored.push_back(static_cast<float>(c / m));
    for (std::size_t s = 0; s < diffuse.sum.size(); ++s) {
      const double mean = diffuse.sum[s] / n;
      out.indirect_sigma.push_back(
          static_cast<float>(std::sqrt(std::max(0.0, diffuse.square[s] / n - mean * mean) / n)));
    }
  }

  const RayCaster& caster_;
  const View& view_;
  std::span<const LightSource> lights_;
  const render::Monomials& monomials_;
  const CacheOptions& options_;
};

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

ViewCache build_cache(const RayCaster& caster, const View& view, std::span<const LightSource> lights,
                      const render::Monomials& monomials, std::span<const std::array<int, 2>> chosen,
                      const CacheOptions& options) {
  const PixelBuilder build(caster, view, lights, monomials, options);
  std::vector<ViewCache> parts(chosen.size());
  parallel_for(
      0, chosen.size(), [&](std::size_t i) { parts[i] = build(chosen[i][0], chosen[i][1]); }, 16);
  ViewCache all;
  for (ViewCache& part : parts) {
    part.pixels[0].first_facet = static_cast<std::uint32_t>(all.facets.size());
    for (Facet& f : part.facets) f.first_patch += static_cast<std::uint32_t>(all.patches.size());
    append(all.pixels, part.pixels);
    append(all.facets, part.facets);
    append(all.patches, part.patches);
    append(all.direct, part.direct);
    append(all.visible, part.visible);
    for (const std::int32_t t : part.shadow_table)
      all.shadow_table.push_back(t < 0 ? t : t + static_cast<std::int32_t>(all.shadows.size() / shadow_nodes));
    append(all.shadows, part.shadows);
    append(all.indirect, part.indirect);
    append(all.mirrored, part.mirrored);
    append(all.lit, part.lit);
    append(all.indirect_sigma, part.indirect_sigma);
    append(all.direct_sigma, part.direct_sigma);
    append(all.margin, part.margin);
    part = ViewCache{};
  }
  return all;
}

}  // namespace gonio::relighting
