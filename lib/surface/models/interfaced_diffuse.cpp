// Matte material within a clear one: light is refracted in, scattered, in part thrown back by the inside of the
// interface to be scattered again, and refracted out. With T(w) = 1 - E(w) (surface/interface_coat.h), the radiance of
// the base is the same in all directions, and summing its bounces against the interface's inside,
//   R = 1 - (1 - E_mean) / eta^2                              reflectance of the interface to diffuse light from inside
//   f = F D G2 / (4 wiz woz)  +  T(wi) T(wo) albedo / (pi eta^2 (1 - albedo R))
// 1 / eta^2: radiance spreads as it leaves. The hemispherical integral of the second term is
// T(wi) albedo (1 - R) / (1 - albedo R), as 2 integral of T cos = eta^2 (1 - R): a white base returns all light,
// exactly. Saunderson 1942; Wolff 1994 for smooth interfaces; Hannemose et al. 2020, section 4, of which this is the
// "interfaced" model: through the rough interface, diffusely reflected, through it again. Unlike `coated-diffuse`,
// whose albedo is that of the base as seen through its interface, `albedo` here is the base's own, as it would be
// measured without the interface: a coat of varnish darkens it and deepens its colour, the more the lower the albedo.
// At eta = 1 it is `diffuse`. The base loses polarization (surface/polarization.h). albedo() is exact up to the tables'
// error.
#include "surface/facet_slopes.h"
#include "surface/interface_coat.h"
#include "surface/polarization.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t { albedo_index, eta_index, alpha_index };

// What depends on the parameters and wo alone.
struct Interfaced {
  CoatInterface interface;
  double reflected, inside;  // E(wo), R
  Rgb colour;                // albedo / (1 - albedo R)
  double share;              // of samples for the interface: by reflected power

  Interfaced(const Values& values, Vec3 wo)
      : interface(values.scalar(eta_index), values.scalar(alpha_index)),
        reflected(interface.reflects(wo.z)),
        inside(interface.reflects_mean_inside()) {
    const auto often = [&](double a) { return a / (1 - a * inside); };
    const Rgb albedo = values.rgb(albedo_index);
    colour = {often(albedo.x), often(albedo.y), often(albedo.z)};
    const double below = mean(returned());
    share = reflected + below > 0 ? reflected / (reflected + below) : 0;
  }
  Rgb returned() const { return colour * ((1 - reflected) * (1 - inside)); }
  Rgb beneath(Vec3 wi) const {
    const double eta = interface.eta();
    return colour * ((1 - reflected) * interface.passes(wi.z) / (pi * eta * eta));
  }
  Rgb evaluate(Vec3 wo, Vec3 wi) const {
    const double gloss = interface.gloss(wo, wi);
    return Rgb{gloss, gloss, gloss} + beneath(wi);
  }
  double pdf(Vec3 wo, Vec3 wi) const { return share * interface.gloss_pdf(wo, wi) + (1 - share) * cosine_density(wi); }
};

class InterfacedDiffuse final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "interfaced-diffuse",
        .sentence = "A matte material within a clear one: plastic, paint, print; by the albedo of what is inside.",
        .source = "Saunderson 1942; Wolff 1994; Walter et al. 2007",
        .parameters = {{.name = "albedo",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .upper = 1,
                        .meaning = "albedo of the base itself, without the interface, of linear red, green and blue"},
                       {.name = "eta",
                        .unit = "1",
                        .preset = 1.5,
                        .lower = 1,
                        .upper = max_coat_eta,
                        .meaning = "index of refraction of the clear material; 1: no interface"},
                       {.name = "alpha",
                        .unit = "1",
                        .preset = 0.1,
                        .lower = 0,
                        .upper = max_alpha,
                        .meaning = "GGX roughness of the interface; 0 is perfectly smooth"}},
    };
    return info;
  }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Interfaced(values, wo).evaluate(wo, wi) : Rgb{};
  }
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    std::fill_n(slopes.begin(), 3, Rgb{});
    if (wo.z <= 0 || wi.z <= 0) return {};
    using T = Dual<3>;  // the band's albedo, eta, alpha
    const T eta = T::unknown(values.scalar(eta_index), eta_index);
    const CoatInterfaceOf<T> interface(eta, T::unknown(values.scalar(alpha_index), alpha_index));
    const T gloss = interface.gloss(wo, wi), inside = interface.reflects_mean_inside(),
            through = interface.passes(wo.z) * interface.passes(wi.z) / (pi * eta * eta);
    Rgb value;
    for (int c = 0; c < 3; ++c) {
      const T albedo = T::unknown(values.rgb(albedo_index)[c], albedo_index);
      put_band(gloss + albedo / (1 - albedo * inside) * through, c, value, slopes);
    }
    return value;
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const Interfaced here(values, wo);
    const bool gloss = u_lobe < here.share;
    const Vec3 wi = gloss ? here.interface.gloss_direction(wo, u) : cosine_direction(u);
    if (gloss && here.interface.smooth()) {
      const double weight = here.reflected / here.share;
      return {.wi = wi, .weight = {weight, weight, weight}, .pdf = here.share, .delta = true};
    }
    const double density = wi.z > 0 ? here.pdf(wo, wi) : 0;
    if (!(density > 0)) return {};
    return {wi, here.evaluate(wo, wi) * (wi.z / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Interfaced(values, wo).pdf(wo, wi) : 0;
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    const double eta = values.scalar(eta_index);
    if (eta == 1) return Model::mueller(values, wo, wi);
    const Interfaced here(values, wo);
    const double gloss = here.interface.gloss(wo, wi);
    const Rgb all = here.evaluate(wo, wi);
    const optics::Mueller facet = dielectric_facet(eta, wo, wi), matte = matte_beneath(eta, wo, wi);
    const auto band = [&](double f) {
      return mixed(facet, matte, here.interface.mirrors(wo, wi) ? 1 : share_of(gloss, f));
    };
    return {band(all.x), band(all.y), band(all.z)};
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const Interfaced here(values, wo);
    return Rgb{here.reflected, here.reflected, here.reflected} + here.returned();
  }
};

}  // namespace

const Model& interfaced_diffuse() {
  static const InterfacedDiffuse model;
  return model;
}

}  // namespace gonio::surface
