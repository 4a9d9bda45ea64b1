// `metal` whose gloss needs more than one lobe: a second population of facets, a direction that fits can find, and
// light that is sent back to the lamp.
//   f = (1 - retro) ((1 - s) metal(alpha) + s metal(alpha_2)) + retro lobe_back
// metal(alpha) is the lobe of surface/metal_lobe.h with Schlick's Fresnel factor and what meets several facets; the
// rest is that of surface/gloss_lobes.h and surface/retro_lobe.h. anisotropy and azimuth_rad are those of `metal`;
// anisotropy_0 and anisotropy_45 add to them as astigmatisms add. Roughness below 0.001 is taken as that: there are no
// deltas. albedo() is as exact as that of `metal`. Reciprocal, and energy as there.
#include "surface/fresnel.h"
#include "surface/gloss_lobes.h"
#include "surface/metal_lobe.h"

namespace gonio::surface {
namespace {

constexpr double least_alpha = 1e-3;
// Beyond this ratio of roughnesses Roughness cannot go.
constexpr double largest_stretch = 1.15;

enum : std::size_t {
  f0_index,
  alpha_index,
  anisotropy_index,
  azimuth_index,
  share_index,
  second_index,
  a0_index,
  a45_index,
  retro_index,
  retro_alpha_index,
  retro_falloff_index
};

// The lobe's roughness with both statements of its direction, `metal`'s and the astigmatism.
Roughness roughness_of(const Values& v, double alpha) {
  const double own = -0.5 * std::log(1 - 0.9 * v.scalar(anisotropy_index)), azimuth = 2 * v.scalar(azimuth_index);
  double a0 = own * std::cos(azimuth) + v.scalar(a0_index), a45 = own * std::sin(azimuth) + v.scalar(a45_index);
  const double centre = std::max(least_alpha, alpha) * std::exp(-own), r = std::hypot(a0, a45);
  if (r > largest_stretch) a0 *= largest_stretch / r, a45 *= largest_stretch / r;
  return stretched(centre, {a0, a45});
}

struct Here {
  Rgb f0;
  double share, retro, second_share, retro_share;  // the latter two: of samples
  RetroLobe back;
  Vec3 wo;
  MetalLobe<Slopes::ggx> first, second;

  Here(const Values& v, Vec3 to_eye)
      : f0(v.rgb(f0_index)),
        share(v.scalar(share_index)),
        retro(v.scalar(retro_index)),
        second_share(share),
        back(v.scalar(retro_alpha_index), v.scalar(retro_falloff_index)),
        wo(to_eye),
        first(roughness_of(v, v.scalar(alpha_index)), false, fresnel_mean(f0), wo),
        second(roughness_of(v, v.scalar(second_index)), false, fresnel_mean(f0), wo) {
    const double metal = (1 - retro) * mean(fresnel_schlick(wo.z, f0)),
                 sent = retro > 0 ? retro * back.power_at_most(wo) : 0;
    retro_share = metal + sent > 0 ? sent / (metal + sent) : 0;
  }
  static Rgb fresnel_mean(Rgb f0) { return f0 + (Rgb{1, 1, 1} - f0) / 21; }
  auto fresnel() const {
    return [f0 = f0](double cosine) { return fresnel_schlick(cosine, f0); };
  }
  Rgb metal(Vec3 wi) const {
    const Rgb narrow = first.evaluate(fresnel(), wi);
    return share > 0 ? narrow * (1 - share) + second.evaluate(fresnel(), wi) * share : narrow;
  }
  double sent(Vec3 wi) const { return retro > 0 ? retro * back.lobe(wo, wi) : 0; }
  Rgb evaluate(Vec3 wi) const {
    const double r = sent(wi);
    return metal(wi) * (1 - retro) + Rgb{r, r, r};
  }
  double pdf(Vec3 wi) const {
    double density = (1 - retro_share) * (1 - second_share) * first.pdf(wi);
    if (second_share > 0) density += (1 - retro_share) * second_share * second.pdf(wi);
    if (retro_share > 0) density += retro_share * back.pdf(wo, wi);
    return density;
  }
};

class GlossyMetal final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "glossy-metal",
        .sentence = "A rough metal by its colour at normal incidence, with two lobes, a direction and light sent back.",
        .source = "Walter et al. 2007; Heitz 2014, 2018; Kulla & Conty 2017; Thibos et al. 1997",
        .parameters = parameters(),
    };
    return info;
  }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Here(values, wo).evaluate(wi) : Rgb{};
  }
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    std::fill_n(slopes.begin(), unknowns, Rgb{});
    if (wo.z <= 0 || wi.z <= 0) return {};
    const auto number = [&](std::size_t i) { return T::unknown(values.scalar(i), i); };
    const Vec3 h = half_vector(wo, wi);
    const MetalLobeSlopes<Slopes::ggx, unknowns> first(directed_of(values, number(alpha_index)), wo, wi, h),
        second(directed_of(values, number(second_index)), wo, wi, h);
    const T share = number(share_index), retro = number(retro_index),
            sent = RetroLobeOf<T>(number(retro_alpha_index), number(retro_falloff_index)).lobe(wo, wi);
    const double rise = schlick_rise(half_cosine(wo, wi));
    Rgb value;
    for (int c = 0; c < 3; ++c) {
      const T f0 = T::unknown(values.rgb(f0_index)[c], f0_index), f = f0 + (1 - f0) * rise, mean = f0 + (1 - f0) / 21;
      const T metal = (1 - share) * first.evaluate(f, mean) + share * second.evaluate(f, mean);
      put_band((1 - retro) * metal + retro * sent, c, value, slopes);
    }
    return value;
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const Here here(values, wo);
    Vec3 wi;
    if (u_lobe < here.retro_share) {
      wi = here.back.direction(wo, u);
    } else {
      const double rest = (u_lobe - here.retro_share) / (1 - here.retro_share);
      const bool wide = rest < here.second_share;
      const double lobe = wide ? rest / here.second_share : (rest - here.second_share) / (1 - here.second_share);
      wi = (wide ? here.second : here.first).sample(here.fresnel(), u, lobe).wi;
    }
    const double density = wi.z > 0 ? here.pdf(wi) : 0;
    if (!(density > 0)) return {};
    return {wi, here.evaluate(wi) * (wi.z / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z > 0 && wi.z > 0 ? Here(values, wo).pdf(wi) : 0;
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const Here here(values, wo);
    Rgb metal = here.first.albedo(here.fresnel());
    if (here.share > 0) metal = metal * (1 - here.share) + here.second.albedo(here.fresnel()) * here.share;
    const double sent = here.retro > 0 ? here.retro * here.back.power(wo) : 0;
    return metal * (1 - here.retro) + Rgb{sent, sent, sent};
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    const Here here(values, wo);
    const Rgb one = here.first.share_of_one_facet(here.fresnel(), wi), all = here.evaluate(wi);
    const Rgb metal = here.metal(wi) * (1 - here.retro);
    const double cosine = half_cosine(wo, wi);
    optics::MuellerRgb result;
    for (int i = 0; i < 3; ++i) {
      const double f0 = std::clamp(here.f0[i], 1e-6, 0.9999);
      result[static_cast<std::size_t>(i)] = mixed(reflected_by(cosine, {1, 2 * std::sqrt(f0 / (1 - f0))}),
                                                  optics::Mueller::depolarizer(), one[i] * share_of(metal[i], all[i]));
    }
    return result;
  }

 private:
  static constexpr std::size_t unknowns = retro_falloff_index + 1;
  using T = Dual<unknowns>;
  // roughness_of() above.
  static DirectedRoughness<unknowns> directed_of(const Values& v, const T& alpha) {
    const auto number = [&](std::size_t i) { return T::unknown(v.scalar(i), i); };
    DirectedRoughness<unknowns> all =
        directed(alpha < least_alpha ? T(least_alpha) : alpha, number(anisotropy_index), number(azimuth_index));
    all.a0 = all.a0 + number(a0_index), all.a45 = all.a45 + number(a45_index);
    const T r = hypot(all.a0, all.a45);
    if (r > largest_stretch) all.a0 = all.a0 * (largest_stretch / r), all.a45 = all.a45 * (largest_stretch / r);
    return all;
  }
  static std::vector<manifest::ParameterInfo> parameters() {
    std::vector<manifest::ParameterInfo> all = {
        {.name = "f0",
         .unit = "1",
         .components = 3,
         .rgb = true,
         .preset = {},
         .lower = 0,
         .upper = 1,
         .meaning = "reflectance at normal incidence, of linear red, green and blue"}};
    for (const auto& p : roughness_parameters(0.1)) all.push_back(p);
    for (const auto& p : gloss_parameters(least_alpha)) all.push_back(p);
    return all;
  }
};

}  // namespace

const Model& glossy_metal() {
  static const GlossyMetal model;
  return model;
}

}  // namespace gonio::surface
