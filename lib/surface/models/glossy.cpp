// Matte base under a clear interface whose gloss needs more than one lobe: `coated-diffuse` with a second population of
// facets (tails, haze), a direction (brushed, woven) and light that is sent back to the lamp (fabric, beads, dust).
//   f = (1 - retro) (F lobes + f_base (1 - E(wi)) (1 - E(wo)) / (1 - E_mean)) + retro lobe_back
// Lobes: surface/gloss_lobes.h, surface/retro_lobe.h. E is the mixture of the two populations' reflectances
// (surface/interface_albedo.h), at the roughness that each direction sees where the surface has a direction, an
// approximation: energy closes to 0.02 there. Reciprocal; a mixture of parts none of which returns more than it
// receives. At second_share = 0, anisotropy = 0 and retro = 0 it is `coated-diffuse`. The base and what is sent back
// have lost their polarization. albedo() is exact for sigma_rad = 0 up to the tables' error.
#include "surface/facet_slopes.h"
#include "surface/fresnel.h"
#include "surface/gloss_lobes.h"
#include "surface/hemisphere.h"
#include "surface/interface_albedo.h"
#include "surface/interface_loss.h"
#include "surface/matte.h"
#include "surface/polarization.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t {
  albedo_index,
  sigma_index,
  f0_index,
  alpha_index,
  share_index,
  second_index,
  a0_index,
  a45_index,
  retro_index,
  retro_alpha_index,
  retro_falloff_index,
  form_index
};

struct Interface {
  double f0, alpha, share, second;
  Astigmatism a;
  explicit Interface(const Values& v)
      : f0(v.scalar(f0_index)),
        alpha(v.scalar(alpha_index)),
        share(v.scalar(share_index)),
        second(v.scalar(second_index)),
        a{v.scalar(a0_index), v.scalar(a45_index)} {}
  double reflects(Vec3 w) const {
    const double first = dielectric_albedo(w.z, roughness_towards(alpha, a, w), f0);
    return share > 0 ? (1 - share) * first + share * dielectric_albedo(w.z, roughness_towards(second, a, w), f0)
                     : first;
  }
  double reflects_mean() const {
    const Vec3 above{0, 0, 1};
    const double first = dielectric_albedo_mean(roughness_towards(alpha, a, above), f0);
    return share > 0 ? (1 - share) * first + share * dielectric_albedo_mean(roughness_towards(second, a, above), f0)
                     : first;
  }
};

// What depends on the parameters and wo alone.
struct Here {
  Interface interface;
  GlossLobes lobes;
  double eta, reflected, passes_out;
  double retro, gloss_share, retro_share;  // shares: of samples, by reflected power
  RetroLobe back;
  Vec3 wo;
  Rgb albedo;
  Matte rough;

  Here(const Values& v, Vec3 to_eye)
      : interface(v),
        lobes(interface.alpha, interface.share, interface.second, interface.a, to_eye),
        eta(eta_of_f0(interface.f0)),
        reflected(interface.f0 > 0 ? interface.reflects(to_eye) : 0),
        passes_out((1 - reflected) / (1 - (interface.f0 > 0 ? interface.reflects_mean() : 0))),
        retro(v.scalar(retro_index)),
        back(v.scalar(retro_alpha_index), v.scalar(retro_falloff_index)),
        wo(to_eye),
        albedo(v.rgb(albedo_index)),
        rough(v.scalar(sigma_index), v.scalar(form_index)) {
    const double below = (1 - reflected) * mean(albedo), above = reflected + below;
    const double sent = retro > 0 ? retro * back.power_at_most(wo) : 0, all = (1 - retro) * above + sent;
    retro_share = all > 0 ? sent / all : 0;
    gloss_share = all > 0 ? (1 - retro) * reflected / all : 0;
  }
  double gloss(Vec3 wi) const {
    if (!(interface.f0 > 0)) return 0;
    return fresnel_dielectric(half_cosine(wo, wi), eta) * lobes.lobe(wi, half_vector(wo, wi));
  }
  Rgb base(Vec3 wi) const {
    const Rgb matte = rough.brdf(albedo, wo, wi);
    return interface.f0 > 0 ? matte * (passes_out * (1 - interface.reflects(wi))) : matte;
  }
  Rgb evaluate(Vec3 wi) const {
    const double g = gloss(wi);
    const Rgb coated = Rgb{g, g, g} + base(wi);
    if (!(retro > 0)) return coated;
    const double r = retro * back.lobe(wo, wi);
    return coated * (1 - retro) + Rgb{r, r, r};
  }
  double pdf(Vec3 wi) const {
    double density = std::max(0.0, 1 - gloss_share - retro_share) * cosine_density(wi);
    if (gloss_share > 0) density += gloss_share * lobes.pdf(wi);
    if (retro_share > 0) density += retro_share * back.pdf(wo, wi);
    return density;
  }
  Vec3 direction(Vec2 u, double u_lobe) const {
    if (u_lobe < gloss_share) return lobes.direction(u, u_lobe / gloss_share);
    if (u_lobe - gloss_share < retro_share) return back.direction(wo, u);
    return cosine_direction(u);
  }
};

class Glossy final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "glossy",
        .sentence = "A matte base under a clear rough interface with two lobes, a direction and light sent back.",
        .source = "Walter et al. 2007; Heitz 2014, 2018; Kelemen & Szirmay-Kalos 2001; Thibos et al. 1997",
        .parameters = parameters(),
    };
    return info;
  }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Here(values, wo).evaluate(wi) : Rgb{};
  }
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    if (!matte_of(values).has_slopes()) return Model::evaluate_with_slopes(values, wo, wi, slopes);
    std::fill_n(slopes.begin(), unknowns + 2, Rgb{});
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Linear at = linear(values, wo, wi);
    const Rgb albedo = values.rgb(albedo_index);
    slopes[albedo_index] = {at.base.v, at.base.v, at.base.v};
    for (std::size_t i = 0; i < unknowns; ++i)
      slopes[i + 1] = Rgb{at.rest.d[i], at.rest.d[i], at.rest.d[i]} + albedo * at.base.d[i];
    return Rgb{at.rest.v, at.rest.v, at.rest.v} + albedo * at.base.v;
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const Here here(values, wo);
    const Vec3 wi = here.direction(u, u_lobe);
    const double density = wi.z > 0 ? here.pdf(wi) : 0;
    if (!(density > 0)) return {};
    return {wi, here.evaluate(wi) * (wi.z / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Here(values, wo).pdf(wi) : 0;
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (values.scalar(f0_index) <= 0 && values.scalar(retro_index) <= 0) return Model::mueller(values, wo, wi);
    const Here here(values, wo);
    const double gloss = here.gloss(wi);
    const Rgb base = here.base(wi), all = here.evaluate(wi);
    const optics::Mueller facet = dielectric_facet(here.eta, wo, wi), beneath = matte_beneath(here.eta, wo, wi);
    const auto band = [&](double b, double f) {
      const double coated = (1 - here.retro) * (gloss + b);
      return mixed(mixed(facet, beneath, share_of(gloss, gloss + b)), optics::Mueller::depolarizer(),
                   share_of(coated, f));
    };
    return {band(base.x, all.x), band(base.y, all.y), band(base.z, all.z)};
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const Here here(values, wo);
    const Rgb base = here.rough.reflectance(here.albedo, wo.z) * (1 - here.reflected);
    const double sent = here.retro > 0 ? here.retro * here.back.power(wo) : 0;
    return (Rgb{here.reflected, here.reflected, here.reflected} + base) * (1 - here.retro) + Rgb{sent, sent, sent};
  }

  bool proportional_to_albedo(const Values& values) const override { return matte_of(values).proportional(); }

 private:
  static Matte matte_of(const Values& values) { return {values.scalar(sigma_index), values.scalar(form_index)}; }
  // f = rest + albedo base, by the numbers after the albedo.
  static constexpr std::size_t unknowns = retro_falloff_index;
  using T = Dual<unknowns>;
  struct Linear {
    T rest, base;
  };
  static Linear linear(const Values& values, Vec3 wo, Vec3 wi) {
    const auto number = [&](std::size_t i) { return T::unknown(values.scalar(i), i - 1); };
    // An interface of nothing is where the slope by f0 begins.
    const T f0 = T::unknown(std::max(1e-12, values.scalar(f0_index)), f0_index - 1), share = number(share_index),
            retro = number(retro_index);
    const FacetForm<Slopes::ggx, unknowns> first({number(alpha_index), number(a0_index), number(a45_index)}),
        second({number(second_index), number(a0_index), number(a45_index)});
    const auto both = [&](const auto& of) { return (1 - share) * of(first) + share * of(second); };
    const auto passes = [&](Vec3 w) {
      return 1 - both([&](const auto& facets) { return dielectric_albedo(w.z, facets.roughness_towards(w), f0); });
    };
    const T mean = both([&](const auto& facets) { return dielectric_albedo_mean(facets.roughness_from_above(), f0); });
    const Vec3 h = half_vector(wo, wi);
    const T gloss = fresnel_dielectric(half_cosine(wo, wi), eta_of_f0(f0)) *
                    both([&](const auto& facets) { return facets.reflection(wo, wi, h); });
    const T base = OrenNayarOf<T>(number(sigma_index)).shape(wo, wi) / pi * passes(wo) * passes(wi) / (1 - mean);
    const T sent = RetroLobeOf<T>(number(retro_alpha_index), number(retro_falloff_index)).lobe(wo, wi);
    return {(1 - retro) * gloss + retro * sent, (1 - retro) * base};
  }
  static std::vector<manifest::ParameterInfo> parameters() {
    std::vector<manifest::ParameterInfo> all = {
        {.name = "albedo",
         .unit = "1",
         .components = 3,
         .rgb = true,
         .preset = {},
         .lower = 0,
         .upper = 1,
         .meaning = "albedo of the base as seen through the interface, of linear red, green and blue"},
        {.name = "sigma_rad",
         .unit = "rad",
         .preset = 0,
         .lower = 0,
         .upper = pi / 2,
         .meaning = "standard deviation of the base's facet slope angle; 0 is Lambert's law"},
        {.name = "f0",
         .unit = "1",
         .preset = 0,
         .lower = 0,
         .upper = max_dielectric_f0,
         .meaning = "reflectance of the interface at normal incidence (0.04 for an index of 1.5); 0: no interface"},
        {.name = "alpha",
         .unit = "1",
         .preset = 0.1,
         .lower = min_alpha,
         .upper = max_alpha,
         .meaning = "GGX roughness of the interface"}};
    for (const auto& p : gloss_parameters(min_alpha)) all.push_back(p);
    all.push_back(matte_form_parameter());
    return all;
  }
};

}  // namespace

const Model& glossy() {
  static const Glossy model;
  return model;
}

}  // namespace gonio::surface
