// Diffuse surface: Lambert's law, f = albedo / pi, or one of the rough laws of surface/matte.h where sigma_rad > 0,
// scaled where its reflectance would exceed one. Reflects at most albedo; sampling is cosine-weighted; albedo() is as
// exact as stated there.
#include "geom/dual.h"
#include "surface/hemisphere.h"
#include "surface/matte.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t { albedo_index, sigma_index, form_index };

Matte matte_of(const Values& values) {
  return {values.scalar(sigma_index), values.scalar(form_index)};
}

class Diffuse final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "diffuse",
        .sentence =
            "A matte surface: the same radiance in all directions, or brighter towards the light where it is rough "
            "(the Oren-Nayar model).",
        .source =
            "Lambert 1760; Oren & Nayar 1994, equations 27, 28, 30 (scaled where their albedo would exceed 1); "
            "Fujii 2012",
        .parameters = {{.name = "albedo",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .upper = 1,
                        .meaning = "share of the light that is reflected, of linear red, green and blue"},
                       {.name = "sigma_rad",
                        .unit = "rad",
                        .preset = 0,
                        .lower = 0,
                        .upper = pi / 2,
                        .meaning = "standard deviation of the facets' slope angle; 0 is Lambert's law"},
                       matte_form_parameter()},
    };
    return info;
  }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    return matte_of(values).brdf(values.rgb(albedo_index), wo, wi);
  }
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    if (!matte_of(values).has_slopes()) return Model::evaluate_with_slopes(values, wo, wi, slopes);
    slopes[albedo_index] = slopes[sigma_index] = slopes[form_index] = {};
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Dual<1> shape = OrenNayarOf(Dual<1>::unknown(values.scalar(sigma_index), 0)).shape(wo, wi) / pi;
    slopes[albedo_index] = {shape.v, shape.v, shape.v};
    slopes[sigma_index] = values.rgb(albedo_index) * shape.d[0];
    return values.rgb(albedo_index) * shape.v;
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double) const override {
    const Vec3 wi = cosine_direction(u);
    if (wo.z <= 0 || wi.z <= 0) return {};
    return {wi, matte_of(values).weight(values.rgb(albedo_index), wo, wi), cosine_density(wi)};
  }
  double pdf(const Values&, Vec3 wo, Vec3 wi) const override { return wo.z > 0 ? cosine_density(wi) : 0; }
  bool proportional_to_albedo(const Values& values) const override { return matte_of(values).proportional(); }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    return matte_of(values).reflectance(values.rgb(albedo_index), wo.z);
  }
};

}  // namespace

const Model& diffuse() {
  static const Diffuse model;
  return model;
}

}  // namespace gonio::surface
