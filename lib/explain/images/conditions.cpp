#include "explain/images/conditions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::explain::images {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct PixelConditions {
  double image_radius = none, incidence = none, exitance = none, half = none, phase = none, light_distance = none,
         shadow_edge = none, visibility = none, open_sky = none, light = none;
};

double angle(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// The largest facet of the pixel stands for it.
PixelConditions of_pixel(const ImageModel& model, const Recording& image, const ViewCache& cache, const Pixel& pixel,
                         std::size_t terms) {
  PixelConditions c;
  c.image_radius = image_radius(image.picture, pixel.x, pixel.y);
  if (!image.lights.empty()) c.light = static_cast<double>(image.lights[0]);
  if (pixel.facets == 0) return c;
  std::size_t f = pixel.first_facet;
  for (std::size_t k = 1; k < pixel.facets; ++k)
    if (cache.facets[pixel.first_facet + k].weight > cache.facets[f].weight) f = pixel.first_facet + k;
  const std::size_t lights = model.layout().lights.size();
  const Patch& patch = cache.patches[cache.facets[f].first_patch];
  c.exitance = angle(dot(patch.normal, patch.wo));
  c.open_sky = cache.indirect[(f * (lights + 1) + lights) * terms] / pi;
  if (image.lights.empty()) return c;
  const std::size_t l = image.lights[0];
  const LightSource& light = model.layout().lights[l];
  Vec3 wi = light.direction;
  if (!light.directional) {
    const Vec3 to_light = light.position_m - patch.position_m;
    c.light_distance = norm(to_light);
    wi = to_light / c.light_distance;
    const float margin = cache.margin[f * lights + l];
    c.shadow_edge = std::isnan(margin) ? none : margin;
  }
  c.visibility = cache.visible[cache.facets[f].first_patch * lights + l];
  c.incidence = angle(dot(patch.normal, wi));
  c.phase = angle(dot(wi, patch.wo));
  if (c.visibility > 0 && c.incidence < pi / 2) c.half = angle(dot(patch.normal, normalized(wi + patch.wo)));
  return c;
}

}  // namespace

std::vector<Condition> image_conditions(const Recordings& recordings, const ImageModel& model,
                                        const std::vector<std::vector<std::uint32_t>>& picked,
                                        std::span<const double> prediction) {
  const std::vector<double> relative(prediction.begin(), prediction.end());
  std::vector<Condition> all = {
      {"camera.image-radius", "half width", "optics", {}, relative},
      {"surface.half-angle", "rad", "surface", {}, relative},
      {"surface.exitance-angle", "rad", "surface", {}, relative},
      {"surface.incidence-angle", "rad", "surface", {}, relative},
      {"surface.phase-angle", "rad", "surface", {}, relative},
      {"light.shadow-edge-distance", "rad", "light", {}, {}},
      {"light.distance", "m", "light", {}, relative},
      {"light.visibility", "1", "light", {}, {}},
      {"scene.ambient-visibility", "1", "light", {}, {}},
      {"image.radiance", "W/(m^2 sr)", "sensor", {}, {}},
      {"light.identity", "1", "light", {}, relative},
  };
  std::size_t row = 0;
  for (std::size_t g = 0; g < picked.size(); ++g) {
    const Recording& image = recordings.images[g];
    const ViewCache& cache = model.cache(image.view);
    for (const std::uint32_t p : picked[g]) {
      const PixelConditions c = of_pixel(model, image, cache, cache.pixels[p], model.monomials().size());
      for (int k = 0; k < 3; ++k, ++row) {
        const double values[] = {c.image_radius,   c.half,       c.exitance, c.incidence,     c.phase, c.shadow_edge,
                                 c.light_distance, c.visibility, c.open_sky, prediction[row], c.light};
        for (std::size_t i = 0; i < all.size(); ++i) all[i].values.push_back(values[i]);
      }
    }
  }
  // A condition that does not vary says nothing.
  std::erase_if(all, [](const Condition& condition) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const double v : condition.values)
      if (!std::isnan(v)) lower = std::min(lower, v), upper = std::max(upper, v);
    return !(upper > lower);
  });
  return all;
}

}  // namespace gonio::explain::images
