// A clear coat, smooth or rough, over another surface: varnish on wood, lacquer on metal. Light is refracted into the
// coat at its mean plane, scattered by the base, and refracted out, or thrown back to the base any number of times:
//   f = F D G2 / (4 wiz woz)  +  T(wo) T(wi) A A / eta^2 (f_base(wo', wi') + trapped(wo') trapped(wi') gain / pi)
// w': the direction inside; T as in surface/interface_coat.h; A = exp(-sigma_a thickness / w'z), Bouguer's law on each
// way; the last term is light that the interface throws back, surface/interface_trap.h. Where the base is Lambertian
// this is `interfaced-diffuse`. Reciprocal where the base is; at eta = 1 without absorption it is the base to the last
// bit. The interface's roughness blurs the gloss alone: light is refracted as by
// a smooth one, so that what a rough coat blurs of a sharp base stays sharp. The term of trapped light rests on a fixed
// sample of the base: energy and albedo() are exact to 5e-2 of a bright metal, to 6e-2 where that is anisotropic. The
// base must let no light through. Where it varies from point to point the sample is drawn at every one, which takes
// 0.1 ms for a matte base, 0.6 ms for a metal and 10 ms where that is anisotropic; `interfaced-diffuse` has no such
// cost. Polarization: the base's matrix between two refractions (surface/polarization.h); trapped light has
// lost it.
#include "surface/interface_trap.h"
#include "surface/polarization.h"

namespace gonio::surface {
namespace {

enum : std::size_t { eta_index, alpha_index, absorption_index, thickness_index };

struct Coat {
  CoatInterface interface;
  Rgb depth;
  const Layer& base;
  const InterfaceTrap& trap;
  Vec3 wo, wo_inside;
  double reflected;
  Rgb passed;  // T A of wo
  double gloss_share, base_share;

  Coat(const Values& values, Vec3 to_eye)
      : interface(values.scalar(eta_index), values.scalar(alpha_index)),
        depth(values.rgb(absorption_index) * values.scalar(thickness_index)),
        base(*values.base),
        trap(trap_of(values.scalar(eta_index), values.scalar(alpha_index), depth, base)),
        wo(to_eye),
        wo_inside(interface.inwards(to_eye)),
        reflected(interface.reflects(wo.z)),
        passed(passes(wo, wo_inside)) {
    const double at_once = mean(passed * trap.escapes(wo_inside)), later = mean(passed * returned_later());
    const double all = reflected + at_once + later;
    gloss_share = all > 0 ? reflected / all : 0;
    base_share = all > 0 ? at_once / all : 1;
  }
  Rgb passes(Vec3 w, Vec3 inside) const { return exp_of(depth * (-1 / inside.z)) * interface.passes(w.z); }
  Rgb returned_later() const { return trap.trapped(wo_inside) * trap.leaves(); }
  Rgb albedo() const {
    return Rgb{reflected, reflected, reflected} + passed * (trap.escapes(wo_inside) + returned_later());
  }
  // What evaluate() consists of.
  struct Parts {
    double gloss;
    Rgb at_once, later;
  };
  Parts parts(Vec3 wi) const {
    const Vec3 inside = interface.inwards(wi);
    const Rgb often = trap.trapped(wo_inside) * trap.trapped(inside) * trap.gain() / pi;
    const Rgb through = passed * passes(wi, inside) / (interface.eta() * interface.eta());
    return {interface.gloss(wo, wi), through * base.model->evaluate(base.values, wo_inside, inside), through * often};
  }
  Rgb evaluate(Vec3 wi) const {
    const Parts p = parts(wi);
    return Rgb{p.gloss, p.gloss, p.gloss} + (p.at_once + p.later);
  }
  // Of deltas in this direction, their weights times their probabilities; the base draws its own first.
  std::optional<Parts> mirrored(Vec3 wi) const {
    if (norm(wi - Vec3{-wo.x, -wo.y, wo.z}) > 1e-9) return {};
    const Vec3 inside = interface.inwards(wi);
    const Sample s = base.model->sample(base.values, wo_inside, {0.5, 0.5}, 0);
    const bool both = s.delta && norm(s.wi - inside) < 1e-9;
    if (!both && !interface.smooth()) return {};
    return Parts{interface.smooth() ? reflected : 0, both ? passed * passes(wi, inside) * s.weight * s.pdf : Rgb{}, {}};
  }
  optics::MuellerRgb mueller(Vec3 wi) const {
    const double eta = interface.eta();
    const Vec3 inside = interface.inwards(wi);
    const Parts p = mirrored(wi).value_or(parts(wi));
    const optics::Mueller facet = dielectric_facet(eta, wo, wi), matte = matte_beneath(eta, wo, wi);
    optics::MuellerRgb result = base.model->mueller(base.values, wo_inside, inside);
    for (int i = 0; i < 3; ++i) {
      optics::Mueller& m = result[static_cast<std::size_t>(i)];
      const double below = p.at_once[i] + p.later[i];
      m = mixed(beneath(m, eta, wo, wo_inside, wi, inside), matte, share_of(p.at_once[i], below));
      m = mixed(facet, m, share_of(p.gloss, p.gloss + below));
    }
    return result;
  }
  double pdf(Vec3 wi) const {
    const Vec3 inside = interface.inwards(wi);
    const double spread = wi.z / (interface.eta() * interface.eta() * inside.z);  // d(inside) / d(wi)
    return gloss_share * interface.gloss_pdf(wo, wi) +
           base_share * base.model->pdf(base.values, wo_inside, inside) * spread +
           std::max(0.0, 1 - gloss_share - base_share) * cosine_density(wi);
  }
};

bool absent(const Values& values) {
  return values.scalar(eta_index) == 1 &&
         (values.scalar(thickness_index) == 0 || max_component(values.rgb(absorption_index)) == 0);
}

class RoughCoat final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "rough-coat",
        .sentence = "A clear or coloured coat, smooth or rough, over another surface: varnish, lacquer.",
        .source = "Walter et al. 2007; Bouguer 1729; Saunderson 1942",
        .parameters = {{.name = "eta",
                        .unit = "1",
                        .preset = 1.5,
                        .lower = 1,
                        .upper = max_coat_eta,
                        .meaning = "index of refraction of the coat; 1: no interface"},
                       {.name = "alpha",
                        .unit = "1",
                        .preset = 0.1,
                        .lower = 0,
                        .upper = max_alpha,
                        .meaning = "GGX roughness of the coat; 0 is perfectly smooth"},
                       {.name = "sigma_a_per_m",
                        .unit = "1/m",
                        .components = 3,
                        .rgb = true,
                        .preset = 0,
                        .lower = 0,
                        .upper = 1e6,
                        .meaning = "absorption coefficient of the coat"},
                       {.name = "thickness_m",
                        .unit = "m",
                        .preset = 0,
                        .lower = 0,
                        .upper = 0.01,
                        .meaning = "thickness of the coat, for its absorption"}},
        .takes_base = true,
    };
    return info;
  }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    if (absent(values)) return values.base->model->evaluate(values.base->values, wo, wi);
    return Coat(values, wo).evaluate(wi);
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    if (absent(values)) return values.base->model->sample(values.base->values, wo, u, u_lobe);
    const Coat coat(values, wo);
    Vec3 wi;
    if (u_lobe < coat.gloss_share) {
      wi = coat.interface.gloss_direction(wo, u);
      const double weight = coat.reflected / coat.gloss_share;
      if (coat.interface.smooth())
        return {.wi = wi, .weight = {weight, weight, weight}, .pdf = coat.gloss_share, .delta = true};
    } else if (const double rest = u_lobe - coat.gloss_share; rest < coat.base_share) {
      const Sample s = coat.base.model->sample(coat.base.values, coat.wo_inside, u, rest / coat.base_share);
      if (!(s.pdf > 0) || s.below || s.wi.z <= 0) return {};
      wi = coat.interface.outwards(s.wi);
      if (s.delta && wi.z > 0)
        return {.wi = wi,
                .weight = s.weight * coat.passed * coat.passes(wi, s.wi) / coat.base_share,
                .pdf = s.pdf * coat.base_share,
                .delta = true};
    } else {
      wi = cosine_direction(u);
    }
    const double density = wi.z > 0 ? coat.pdf(wi) : 0;
    if (!(density > 0)) return {};
    return {wi, coat.evaluate(wi) * (wi.z / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return 0;
    if (absent(values)) return values.base->model->pdf(values.base->values, wo, wi);
    return Coat(values, wo).pdf(wi);
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (absent(values)) return values.base->model->mueller(values.base->values, wo, wi);
    return Coat(values, wo).mueller(wi);
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    if (absent(values)) return values.base->model->albedo(values.base->values, wo);
    return Coat(values, wo).albedo();
  }
};

}  // namespace

const Model& rough_coat() {
  static const RoughCoat model;
  return model;
}

}  // namespace gonio::surface
