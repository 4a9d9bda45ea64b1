// A thin sheet that lets light through diffusely: paper, a leaf, cloth, a lamp shade, alike on both sides.
//   f = (1 - translucent) matte(wo, wi)      on the eye's side, the rough laws of surface/matte.h
//   f = translucent albedo / pi              for light from the other side
// What the albedo absorbs is lost on either way. The sheet has no thickness and bounds no medium. albedo() is what goes
// either way. At translucent = 0 it is `diffuse`.
#include "surface/hemisphere.h"
#include "surface/matte.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t { albedo_index, sigma_index, form_index, translucent_index };

class Sheet final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "sheet",
        .sentence = "A thin matte sheet that lets light through: paper, a leaf, cloth, a lamp shade.",
        .source = "Lambert 1760; Oren & Nayar 1994; Fujii 2012",
        .parameters = {{.name = "albedo",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .upper = 1,
                        .meaning = "share of the light that is not absorbed, of linear red, green and blue"},
                       {.name = "sigma_rad",
                        .unit = "rad",
                        .preset = 0,
                        .lower = 0,
                        .upper = pi / 2,
                        .meaning = "standard deviation of the facets' slope angle, for what is reflected"},
                       matte_form_parameter(),
                       {.name = "translucent",
                        .unit = "1",
                        .preset = 0,
                        .lower = 0,
                        .upper = 1,
                        .meaning = "share of what is not absorbed that goes through"}},
    };
    return info;
  }
  bool thin() const override { return true; }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z == 0) return {};
    const double through = values.scalar(translucent_index);
    if (wi.z < 0) return values.rgb(albedo_index) * (through / pi);
    return matte_of(values).brdf(values.rgb(albedo_index), wo, wi) * (1 - through);
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const double through = values.scalar(translucent_index);
    Vec3 wi = cosine_direction(u);
    if (!(wi.z > 0)) return {};
    const bool beyond = u_lobe < through;
    const double share = beyond ? through : 1 - through, density = share * cosine_density(wi);
    if (!(density > 0)) return {};
    if (beyond) wi.z = -wi.z;
    return {wi, evaluate(values, wo, wi) * (std::abs(wi.z) / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0) return 0;
    const double through = values.scalar(translucent_index);
    return (wi.z < 0 ? through : 1 - through) * cosine_density({wi.x, wi.y, std::abs(wi.z)});
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const double through = values.scalar(translucent_index);
    return matte_of(values).reflectance(values.rgb(albedo_index), wo.z) * (1 - through) +
           values.rgb(albedo_index) * through;
  }
  bool proportional_to_albedo(const Values& values) const override { return matte_of(values).proportional(); }

 private:
  static Matte matte_of(const Values& values) { return {values.scalar(sigma_index), values.scalar(form_index)}; }
};

}  // namespace

const Model& sheet() {
  static const Sheet model;
  return model;
}

}  // namespace gonio::surface
