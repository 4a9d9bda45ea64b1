#include "explain/images/conditions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "light/polarized_emitter.h"
#include "relighting/fixed_pattern.h"
#include "relighting/observed.h"

namespace gonio::explain::images {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

enum Which : std::size_t {
  image_radius_at,
  half_at,
  exitance_at,
  incidence_at,
  phase_at,
  shadow_edge_at,
  distance_at,
  visibility_at,
  open_sky_at,
  radiance_at,
  identity_at,
  emission_at,
  indirect_at,
  row_at,
  column_at,
  mean_at,
  mirrored_at,
  hue_at,
  edge_at,
  depth_at,
  exposure_at,
  time_at,
  temperature_at,
  x_at,
  y_at,
  z_at,
  pixel_at,
  plane_at,
  excitation_at,
  picture_at,
  count
};
// In the order of Which. Structure of those with `relative` scales with the signal.
struct Description {
  const char *name, *unit, *stage;
  bool relative;
};
constexpr std::array<Description, count> descriptions{{
    {"camera.image-radius", "half width", "optics", true},
    {"surface.half-angle", "rad", "surface", true},
    {"surface.exitance-angle", "rad", "surface", true},
    {"surface.incidence-angle", "rad", "surface", true},
    {"surface.phase-angle", "rad", "surface", true},
    {"light.shadow-edge-distance", "rad", "light", false},
    {"light.distance", "m", "light", true},
    {"light.visibility", "1", "light", false},
    {"scene.ambient-visibility", "1", "light", false},
    {"image.radiance", "W/(m^2 sr)", "sensor", false},
    {"light.identity", "1", "light", true},
    {"light.emission-angle", "rad", "light", true},
    {"scene.indirect-irradiance", "1", "transport", false},
    {"camera.image-y", "px", "sensor", true},
    {"camera.image-x", "px", "sensor", true},
    {"image.mean", "W/(m^2 sr)", "optics", false},
    {"image.mirrored-radiance", "W/(m^2 sr)", "optics", false},
    {"image.hue", "1", "sensor", false},
    {"image.edge-distance", "px", "optics", false},
    {"scene.depth", "m", "optics", true},
    {"image.exposure", "s", "sensor", true},
    {"image.time", "s", "light", true},
    {"image.temperature", "K", "sensor", true},
    {"scene.x", "m", "surface", true},
    {"scene.y", "m", "surface", true},
    {"scene.z", "m", "surface", true},
    {"camera.pixel", "1", "sensor", true},
    {"light.plane-azimuth", "rad", "light", true},
    {"surface.excitation", "1", "surface", false},
    {"image.identity", "1", "sensor", true},
}};
using Known = std::array<double, count>;

double angle(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// Distance of a pixel from the nearest place, within reach, where another surface or none is seen: only as far as its
// own sub-samples and those of the pixels around it that were computed tell. 0: the pixel itself shows two things.
double edge_distance(const Pixel& pixel) {
  return pixel.facets == 1 && pixel.sky == 0 ? 1 : 0;
}

// Of the s axis of incidence and exitance about the light's way, from the lamp's own axis (light/polarized_emitter.h):
// an axis has no sign, 0 to pi.
double plane_azimuth(const LightSource& light, Vec3 wi, const Patch& patch, Vec3 centre_m) {
  const Vec3 towards = light.directional ? light.direction : light.position_m - centre_m;
  if (!(norm(towards) > 0)) return none;
  const Vec3 x = light::Sheet::before(normalized(towards), 0, 0).of(-wi).x;
  const Vec3 s = optics::scattering_axis(wi, patch.wo);
  const double azimuth = std::atan2(dot(s, cross(-wi, x)), dot(s, x));
  return azimuth < 0 ? azimuth + pi : azimuth;
}

class Describer {
 public:
  Describer(const ImageModel& model, const Recording& image)
      : model_(model), image_(image), cache_(model.cache(image.view)) {}

  // Conditions of a pixel that do not depend on the colour; the largest facet stands for it.
  Known of(const Pixel& pixel) const {
    Known c;
    c.fill(none);
    c[image_radius_at] = image_radius(image_.picture, pixel.x, pixel.y);
    if (!image_.lights.empty()) c[identity_at] = static_cast<double>(image_.lights[0]);
    c[row_at] = pixel.y;
    c[column_at] = pixel.x;
    c[edge_at] = edge_distance(pixel);
    c[exposure_at] = image_.exposure_s.value_or(none);
    c[time_at] = image_.time_s.value_or(none);
    c[temperature_at] = image_.temperature_K.value_or(none);
    if (pixel.facets > 0) of_facet(largest(pixel), c);
    return c;
  }

 private:
  std::size_t largest(const Pixel& pixel) const {
    std::size_t f = pixel.first_facet;
    for (std::size_t k = 1; k < pixel.facets; ++k)
      if (cache_.facets[pixel.first_facet + k].weight > cache_.facets[f].weight) f = pixel.first_facet + k;
    return f;
  }

  void of_facet(std::size_t f, Known& c) const {
    const std::size_t lights = model_.layout().lights.size(), terms = model_.monomials().size();
    const Patch& patch = cache_.patches[cache_.facets[f].first_patch];
    const auto& pose = model_.recordings().views[image_.view].world_from_camera;
    c[exitance_at] = angle(dot(patch.normal, patch.wo));
    c[open_sky_at] = cache_.indirect[(f * (lights + 1) + lights) * terms] / pi;
    c[x_at] = patch.position_m.x;
    c[y_at] = patch.position_m.y;
    c[z_at] = patch.position_m.z;
    c[depth_at] = (inverse(pose) * patch.position_m).z;
    if (image_.lights.empty()) return;
    const std::size_t l = image_.lights[0];
    const LightSource& light = model_.layout().lights[l];
    Vec3 wi = light.direction;
    if (!light.directional) {
      const Vec3 to_light = light.position_m - patch.position_m;
      c[distance_at] = norm(to_light);
      wi = to_light / c[distance_at];
      const float margin = cache_.margin[f * lights + l];
      c[shadow_edge_at] = std::isnan(margin) ? none : margin;
      c[emission_at] = angle(-dot(wi, normalized(model_.layout().centre_m - light.position_m)));
    }
    c[visibility_at] = cache_.visible[cache_.facets[f].first_patch * lights + l];
    c[incidence_at] = angle(dot(patch.normal, wi));
    c[phase_at] = angle(dot(wi, patch.wo));
    c[plane_at] = plane_azimuth(light, wi, patch, model_.layout().centre_m);
    if (c[visibility_at] > 0 && c[incidence_at] < pi / 2)
      c[half_at] = angle(dot(patch.normal, normalized(wi + patch.wo)));
    double indirect = 0;  // at albedo 1/2, over what a lamp overhead at the centre's distance gives
    const float* terms_of = &cache_.indirect[(f * (lights + 1) + l) * terms];
    for (std::size_t m = 1; m < terms; ++m) {
      int degree = 0;
      for (const std::uint8_t e : model_.monomials().exponents(m)) degree += e;
      indirect += terms_of[m] * std::pow(0.5, degree);
    }
    const double d = light.directional ? 1 : norm(light.position_m - model_.layout().centre_m);
    c[indirect_at] = indirect * d * d;
  }

  const ImageModel& model_;
  const Recording& image_;
  const ViewCache& cache_;
};

// Displacements in px: along the image radius, and along x and y over the rows.
std::vector<Condition> edge_shifts(const ImageModel& model, const std::vector<std::vector<std::uint32_t>>& picked,
                                   const std::array<std::vector<double>, 2>& across) {
  std::vector<Condition> all{{"camera.edge-shift-radial", "half width", "optics", {}, {}, "px"},
                             {"camera.edge-shift-x", "px", "pose", {}, {}, "px"},
                             {"camera.edge-shift-y", "px", "pose", {}, {}, "px"}};
  if (std::ranges::none_of(across[0], [](double v) { return v != 0; })) return {};
  std::size_t row = 0;
  for (std::size_t g = 0; g < picked.size(); ++g) {
    const Recording& image = model.recordings().images[g];
    const ViewCache& cache = model.cache(image.view);
    for (const std::uint32_t p : picked[g]) {
      const Pixel& pixel = cache.pixels[p];
      const double x = pixel.x - 0.5 * (image.picture.width - 1), y = pixel.y - 0.5 * (image.picture.height - 1);
      const double r = std::hypot(x, y);
      for (int k = 0; k < 3; ++k, ++row) {
        all[0].values.push_back(image_radius(image.picture, pixel.x, pixel.y));
        all[0].direction.push_back(r > 0 ? (x * across[0][row] + y * across[1][row]) / r : 0);
        for (std::size_t a = 0; a < 2; ++a) {
          all[a + 1].values.push_back(pixel.y);
          all[a + 1].direction.push_back(across[a][row]);
        }
      }
    }
  }
  return all;
}

}  // namespace

std::vector<Condition> image_conditions(const ImageModel& model, const std::vector<std::vector<std::uint32_t>>& picked,
                                        std::span<const double> prediction,
                                        const std::array<std::vector<double>, 2>& across) {
  const std::vector<double> relative(prediction.begin(), prediction.end());
  std::vector<Condition> all;
  for (const Description& d : descriptions)
    all.push_back({d.name, d.unit, d.stage, {}, d.relative ? relative : std::vector<double>{}});
  const FixedPattern pattern = fixed_pattern(model.recordings());
  std::size_t row = 0;
  for (std::size_t g = 0; g < picked.size(); ++g) {
    const Recording& image = model.recordings().images[g];
    const ViewCache& cache = model.cache(image.view);
    const Describer describe(model, image);
    for (const std::uint32_t p : picked[g]) {
      Known known = describe.of(cache.pixels[p]);
      known[picture_at] = static_cast<double>(g);
      const Rgb mirrored = opposite(image, cache.pixels[p]);
      const std::size_t place =
          3 * (static_cast<std::size_t>(cache.pixels[p].y) * static_cast<std::size_t>(image.picture.width) +
               static_cast<std::size_t>(cache.pixels[p].x));
      const double sum = prediction[row] + prediction[row + 1] + prediction[row + 2];
      const Rgb lamp = image.lights.empty() ? Rgb{} : model.layout().start.lights[image.lights[0]].intensity;
      for (int k = 0; k < 3; ++k, ++row) {
        known[excitation_at] = lamp[k] > 0 ? lamp.z / lamp[k] : none;  // what blue brings for what the band brings
        known[radiance_at] = prediction[row];
        known[mean_at] = image.mean[k];
        known[mirrored_at] = mirrored[k];
        known[pixel_at] = pattern.views[image.view].deviation[place + static_cast<std::size_t>(k)];
        known[hue_at] = sum > 0 ? 3 * prediction[row] / sum - 1 : none;
        for (std::size_t i = 0; i < count; ++i) all[i].values.push_back(known[i]);
      }
    }
  }
  for (Condition& c : all)  // lamps flicker and fields ripple in every picture anew
    c.within_groups = c.name == "camera.image-x" || c.name == "camera.image-y" || c.name == "camera.image-radius";
  for (Condition& shift : edge_shifts(model, picked, across)) all.push_back(std::move(shift));
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
