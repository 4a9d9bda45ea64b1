// A two-dimensional sinusoidal micro-structure, as printed to control gloss: z = A sin(2 pi u / lambda_u)
// sin(2 pi v / lambda_v) with rough facets.
//   f = (F(wi.h) + (1 - F(wi.h))^2 rho_d / pi) D(h) G(wi, wo) / (4 (wi.n) (wo.n))
// Luongo et al. 2020, "Microstructure control in 3D printing with digital light processing", appendix B, which refers
// to Luongo et al. 2017 for the scheme (models/ridged.cpp). Density of normals and masking: surface/sinusoid.h, where
// it is said how it differs from the published one, which `projections` brings back. F is Fresnel's factor for the
// complex index eta + i k. Directions are drawn by way of normals: a place on the period, and a slope of the roughness
// there. Residue may cover a share of it (surface/residue.h). Reciprocal. albedo() is a sum over 512 drawn normals.
#include <algorithm>
#include <cmath>

#include "base/progress.h"
#include "surface/interface_albedo.h"
#include "surface/microfacet.h"
#include "surface/residue.h"
#include "surface/ridge_facets.h"
#include "surface/sinusoid.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t {
  amplitude_index,
  u_index,
  v_index,
  alpha_index,
  eta_index,
  k_index,
  rho_index,
  azimuth_index,
  projections_index,
  residue_index  // its share; its roughness follows
};

double slope(const Values& values, std::size_t wavelength) {
  return values.scalar(amplitude_index) * 2 * pi / values.scalar(wavelength);
}

struct PatternTable final : Prepared {
  explicit PatternTable(double width) : blurred(width) {}
  BlurredSine blurred;
};

// Where parameters vary, the table of the uniform ones does not serve, and densities are integrated on the spot.
Sinusoid pattern_of(const Values& values) {
  const auto* table = static_cast<const PatternTable*>(values.prepared);
  return {slope(values, u_index), slope(values, v_index), values.scalar(alpha_index), values.scalar(azimuth_index),
          table ? &table->blurred : nullptr};
}

FacetMaterial material_of(const Values& values) {
  return {values.rgb(eta_index), values.rgb(k_index), values.rgb(rho_index)};
}

// The fourth random number is made of the third one's digits.
Vec3 normal_from(const Sinusoid& pattern, Vec2 u, double u_lobe) {
  const double digits = u_lobe * 65536;
  return pattern.normal(u.x, u.y, {u_lobe, digits - std::floor(digits)});
}

class Sinusoidal final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "sinusoidal",
        .sentence = "A two-dimensional sinusoidal micro-structure with rough facets.",
        .source = "Luongo et al. 2020, appendix B; Heitz 2014",
        .parameters = with_residue(with_facet_material(
            {{.name = "amplitude_m",
              .unit = "m",
              .preset = {},
              .lower = 0,
              .upper = 1e-3,
              .meaning = "height of the crests over the mean plane"},
             {.name = "wavelength_u_m",
              .unit = "m",
              .preset = {},
              .lower = 1e-6,
              .upper = 1e-2,
              .meaning = "wavelength along the tangent"},
             {.name = "wavelength_v_m",
              .unit = "m",
              .preset = {},
              .lower = 1e-6,
              .upper = 1e-2,
              .meaning = "wavelength across the tangent"},
             {.name = "alpha",
              .unit = "1",
              .preset = 0.1,
              .lower = min_alpha,
              .upper = max_alpha,
              .meaning = "Beckmann roughness on top of the pattern"}},
            {{.name = "azimuth_rad",
              .unit = "rad",
              .preset = 0,
              .lower = -pi,
              .upper = pi,
              .meaning = "turns the pattern about the normal; at 0 its u runs along the tangent"},
             {.name = "projections",
              .unit = "1",
              .preset = 0,
              .lower = 0,
              .upper = 1,
              .meaning = "0: masking derived from the pattern's slopes; 1: the published product of projections"}})),
    };
    return info;
  }

  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Sinusoid pattern = pattern_of(values);
    const Vec3 h = half_vector(wo, wi);
    const FacetMaterial material = material_of(values);
    return Residue(values, residue_index)
        .over(material.reflects(dot(wo, h)) * pattern.lobe(wo, wi, h, values.scalar(projections_index)), material, wo,
              wi);
  }

  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const Sinusoid pattern = pattern_of(values);
    const Residue residue(values, residue_index);
    const Vec3 wi =
        residue.direction(wo, u, u_lobe, [&](double which) { return mirrored(wo, normal_from(pattern, u, which)); });
    if (wi.z <= 0) return {};
    const Vec3 h = half_vector(wo, wi);
    const double cosine = dot(wo, h);
    if (!(cosine > 0)) return {};
    const double relief = pattern.density_of_normals(h) * h.z / (4 * cosine), density = residue.pdf(relief, wo, wi);
    if (!(density > 0)) return {};
    if (!residue.none()) return {wi, evaluate(values, wo, wi) * (wi.z / density), density};
    const double masked = pattern.masking(wo, wi, values.scalar(projections_index));
    return {wi, material_of(values).reflects(cosine) * (masked * wi.z * cosine / h.z), density};
  }

  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return 0;
    const Vec3 h = half_vector(wo, wi);
    const double cosine = dot(wo, h);
    if (!(cosine > 0)) return 0;
    return Residue(values, residue_index).pdf(pattern_of(values).density_of_normals(h) * h.z / (4 * cosine), wo, wi);
  }

  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    return material_of(values).mueller(dot(wo, half_vector(wo, wi)));
  }

  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    constexpr int count = 512;
    const Sinusoid pattern = pattern_of(values);
    const auto part = [](double x) { return x - std::floor(x); };
    Rgb sum;
    for (int i = 0; i < count; ++i) {  // Roberts 2018, four dimensions
      const Vec2 roughness{part(0.5 + i * 0.6287067210378087), part(0.5 + i * 0.5385972572236101)};
      const Vec3 h = pattern.normal(part(0.5 + i * 0.8566748838545029), part(0.5 + i * 0.733891856627126), roughness);
      const Vec3 wi = mirrored(wo, h);
      const double cosine = dot(wo, h);
      if (wi.z > 0 && cosine > 0)
        sum += material_of(values).reflects(cosine) *
               (pattern.masking(wo, wi, values.scalar(projections_index)) * wi.z * cosine / h.z);
    }
    return Residue(values, residue_index).albedo(sum / count, material_of(values), wo);
  }

  std::shared_ptr<const Prepared> prepare(const Values& values, const std::filesystem::path&,
                                          const std::string& place) const override {
    const double steepest = std::max(slope(values, u_index), slope(values, v_index));
    if (steepest > steepest_pattern && !place.empty())
      log(LogLevel::warning, place + ": the pattern's slope " + std::to_string(steepest) + " is taken as " +
                                 std::to_string(steepest_pattern) + "; light between its walls is left out");
    return std::make_shared<const PatternTable>(pattern_of(values).least_width());
  }
};

}  // namespace

const Model& sinusoidal() {
  static const Sinusoidal model;
  return model;
}

}  // namespace gonio::surface
