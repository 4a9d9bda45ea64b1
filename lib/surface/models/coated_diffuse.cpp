// Diffuse base under a rough dielectric interface (varnish, glaze, plastic).
//   f = F(wi.h) D(h) G2 / (4 wiz woz)  +  f_base(wi, wo) (1 - E(wi)) (1 - E(wo)) / (1 - E_mean)
// The interface is GGX (surface/microfacet.h) with exact Fresnel factor of the index that f0 implies; E is its
// directional reflectance (surface/interface_albedo.h). Kelemen & Szirmay-Kalos 2001: reciprocal, and a white
// Lambertian base reflects all light. `albedo` is the base as seen through the interface, internal reflections
// included: what a photograph with crossed polarizers shows. At f0 = 0 the interface vanishes, and evaluate, sample and
// pdf are those of `diffuse` to the last bit. The base loses polarization (surface/polarization.h). albedo() is exact
// for sigma_rad = 0 up to the tables' error; for a rough base the base's part is scaled by its reflectance.
#include "surface/fresnel.h"
#include "surface/hemisphere.h"
#include "surface/interface_albedo.h"
#include "surface/matte.h"
#include "surface/microfacet.h"
#include "surface/polarization.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t { albedo_index, sigma_index, f0_index, alpha_index, form_index };

Matte matte_of(const Values& values) {
  return {values.scalar(sigma_index), values.scalar(form_index)};
}

// What depends on the parameters and wo alone.
struct Coat {
  double f0, eta, alpha, passes_out;  // passes_out: 1 - E(wo)
  Coat(const Values& values, Vec3 wo)
      : f0(values.scalar(f0_index)),
        eta(eta_of_f0(f0)),
        alpha(values.scalar(alpha_index)),
        passes_out(1 - dielectric_albedo(wo.z, alpha, f0)) {}
  double passes(Vec3 wi) const {
    return passes_out * (1 - dielectric_albedo(wi.z, alpha, f0)) / (1 - dielectric_albedo_mean(alpha, f0));
  }
  // Share of samples for the interface: by reflected power.
  double share(Rgb base) const {
    const double interface = 1 - passes_out, below = passes_out * mean(base);
    return interface + below > 0 ? interface / (interface + below) : 0;
  }
};

// What depends on the parameters alone, each with the slope by what it depends on. Remembered by each thread.
struct CoatSlopes {
  using T = Dual<1>;
  double sigma, stated_f0;
  T f0, alpha, eta;  // eta by f0
  AlbedoSlopes mean;
  OrenNayarOf<T> rough;

  // An interface of nothing is where the slope by f0 begins.
  explicit CoatSlopes(const Values& values)
      : sigma(values.scalar(sigma_index)),
        stated_f0(values.scalar(f0_index)),
        f0(T::unknown(std::max(1e-12, stated_f0), 0)),
        alpha(T::unknown(values.scalar(alpha_index), 0)),
        eta(eta_of_f0(f0)),
        mean(dielectric_albedo_mean_slopes(alpha.v, f0.v)),
        rough(T::unknown(sigma, 0)) {}
  static const CoatSlopes& of(const Values& values) {
    thread_local CoatSlopes last(values);
    if (last.stated_f0 != values.scalar(f0_index) || last.alpha.v != values.scalar(alpha_index) ||
        last.sigma != values.scalar(sigma_index))
      last = CoatSlopes(values);
    return last;
  }
};

class CoatedDiffuse final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "coated-diffuse",
        .sentence = "A matte base under a clear rough interface, such as varnish, glaze or plastic.",
        .source = "Walter et al. 2007; Heitz 2014, 2018; Kelemen & Szirmay-Kalos 2001",
        .parameters =
            {{.name = "albedo",
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
              .meaning =
                  "reflectance of the interface at normal incidence (0.04 for an index of 1.5); 0: no interface"},
             {.name = "alpha",
              .unit = "1",
              .preset = 0.1,
              .lower = min_alpha,
              .upper = max_alpha,
              .meaning = "GGX roughness of the interface"},
             matte_form_parameter()},
    };
    return info;
  }

  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Rgb base = matte_of(values).brdf(values.rgb(albedo_index), wo, wi);
    if (values.scalar(f0_index) <= 0) return base;
    return together(Coat(values, wo), base, wo, wi);
  }

  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    if (!matte_of(values).has_slopes()) return Model::evaluate_with_slopes(values, wo, wi, slopes);
    std::fill_n(slopes.begin(), 5, Rgb{});
    if (wo.z <= 0 || wi.z <= 0) return {};
    using T = CoatSlopes::T;
    const CoatSlopes& at = CoatSlopes::of(values);
    const T fresnel = fresnel_dielectric(half_cosine(wo, wi), at.eta),
            lobe = GgxOf<T>(at.alpha).lobe(wo, wi, half_vector(wo, wi)), shape = at.rough.shape(wo, wi);
    const AlbedoSlopes o = dielectric_albedo_slopes(wo.z, at.alpha.v, at.f0.v),
                       i = dielectric_albedo_slopes(wi.z, at.alpha.v, at.f0.v);
    const double out = 1 - o.value, in = 1 - i.value, mean = 1 - at.mean.value, through = out * in / (pi * mean);
    const auto through_by = [&](double by_o, double by_i, double by_mean) {
      return (through * by_mean - (by_o * in + out * by_i) / pi) / mean;
    };
    const Rgb albedo = values.rgb(albedo_index);
    const auto sum = [&](double gloss, double base) { return Rgb{gloss, gloss, gloss} + albedo * base; };
    const double base = shape.v * through;
    slopes[albedo_index] = {base, base, base};
    slopes[sigma_index] = albedo * (shape.d[0] * through);
    slopes[f0_index] = sum(fresnel.d[0] * lobe.v, shape.v * through_by(o.by_f0, i.by_f0, at.mean.by_f0));
    slopes[alpha_index] = sum(fresnel.v * lobe.d[0], shape.v * through_by(o.by_alpha, i.by_alpha, at.mean.by_alpha));
    return sum(fresnel.v * lobe.v, base);
  }

  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const Matte rough = matte_of(values);
    const Rgb albedo = values.rgb(albedo_index);
    if (values.scalar(f0_index) <= 0) {
      const Vec3 wi = cosine_direction(u);
      return wi.z > 0 ? Sample{wi, rough.weight(albedo, wo, wi), cosine_density(wi)} : Sample{};
    }
    const Coat coat(values, wo);
    const Ggx ggx(coat.alpha);
    const double share = coat.share(albedo);
    const Vec3 wi = u_lobe < share ? mirrored(wo, ggx.visible_normal(wo, u)) : cosine_direction(u);
    if (wi.z <= 0) return {};
    const double density = share * ggx.pdf(wo, half_vector(wo, wi)) + (1 - share) * cosine_density(wi);
    if (!(density > 0)) return {};
    return {wi, together(coat, rough.brdf(albedo, wo, wi), wo, wi) * (wi.z / density), density};
  }

  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return 0;
    if (values.scalar(f0_index) <= 0) return cosine_density(wi);
    const Coat coat(values, wo);
    const double share = coat.share(values.rgb(albedo_index));
    return share * Ggx(coat.alpha).pdf(wo, half_vector(wo, wi)) + (1 - share) * cosine_density(wi);
  }

  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (values.scalar(f0_index) <= 0) return Model::mueller(values, wo, wi);
    const Coat coat(values, wo);
    const Rgb base = matte_of(values).brdf(values.rgb(albedo_index), wo, wi);
    const Rgb all = together(coat, base, wo, wi), gloss = together(coat, {}, wo, wi);
    const optics::Mueller facet = dielectric_facet(coat.eta, wo, wi), beneath = matte_beneath(coat.eta, wo, wi);
    return {mixed(facet, beneath, share_of(gloss.x, all.x)), mixed(facet, beneath, share_of(gloss.y, all.y)),
            mixed(facet, beneath, share_of(gloss.z, all.z))};
  }

  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const Rgb base = matte_of(values).reflectance(values.rgb(albedo_index), wo.z);
    if (values.scalar(f0_index) <= 0) return base;
    const double passes = Coat(values, wo).passes_out, reflects = 1 - passes;
    return Rgb{reflects, reflects, reflects} + base * passes;
  }

  bool proportional_to_albedo(const Values& values) const override { return matte_of(values).proportional(); }

 private:
  static Rgb together(const Coat& coat, Rgb base, Vec3 wo, Vec3 wi) {
    const Vec3 h = half_vector(wo, wi);
    const double gloss = fresnel_dielectric(half_cosine(wo, wi), coat.eta) * Ggx(coat.alpha).lobe(wo, wi, h);
    return Rgb{gloss, gloss, gloss} + base * coat.passes(wi);
  }
};

}  // namespace

const Model& coated_diffuse() {
  static const CoatedDiffuse model;
  return model;
}

}  // namespace gonio::surface
