// A surface that is several things at once, each on its share of the area:
//   f = (1 - metal - sheen - sheen_forward) f_glossy + metal f_metal + sheen velvet + sheen_forward forward
// f_glossy is the model `glossy` with its own parameters; f_metal the model `metal` of roughness metal_alpha, whose
// reflectance at normal incidence is `albedo`: what is believed a matte colour is that of a bare metal. Lobes of the
// sheen: surface/sheen.h. Shares that exceed one together are divided by their sum. Without shares it is `glossy`.
// Reciprocal; no part returns more than it receives. albedo() is as exact as its parts: within 0.02.
#include "surface/gloss_lobes.h"
#include "surface/hemisphere.h"
#include "surface/matte.h"
#include "surface/microfacet.h"
#include "surface/polarization.h"
#include "surface/sheen.h"
#include "surface/surface.h"

namespace gonio::surface {

const Model& glossy();
const Model& metal();

namespace {

constexpr std::size_t glossy_parameters = 12;
constexpr double least_metal_alpha = 0.02;
enum : std::size_t {
  albedo_index = 0,
  metal_index = glossy_parameters,
  metal_alpha_index,
  sheen_index,
  sheen_width_index,
  forward_index
};

struct Parts {
  const Values& glossy_values;  // glossy() reads the first of them
  Values metal_values;
  Vec3 wo;
  double metal_share, sheen_share, forward_share, glossy_share, width;
  std::array<double, 3> draws{};  // shares of samples: glossy, metal, sheen

  Parts(const Values& v, Vec3 to_eye)
      : glossy_values(v),
        wo(to_eye),
        metal_share(v.scalar(metal_index)),
        sheen_share(v.scalar(sheen_index)),
        forward_share(v.scalar(forward_index)),
        width(v.scalar(sheen_width_index)) {
    const double all = metal_share + sheen_share + forward_share;
    if (all > 1) metal_share /= all, sheen_share /= all, forward_share /= all;
    glossy_share = std::max(0.0, 1 - metal_share - sheen_share - forward_share);
    metal_values.v[0] = v.rgb(albedo_index);
    metal_values.v[1] = v.v[metal_alpha_index];
  }
  // Remembered by each thread while neither parameters nor wo change: a path asks for a direction and for densities
  // several times at one place, and what is sent back takes half a hundred directions to sum.
  void weigh_draws() {
    struct Last {
      decltype(Values::v) values{};
      Vec3 wo;  // none at first: it has no length
      std::array<double, 3> draws{};
    };
    thread_local Last last;
    if (last.wo == wo && last.values == glossy_values.v) {
      draws = last.draws;
      return;
    }
    draws[0] = glossy_share * std::max(0.05, mean(glossy().albedo(glossy_values, wo)));
    draws[1] = metal_share * (0.05 + 0.95 * mean(metal_values.rgb(0)));
    draws[2] = 0.5 * (sheen_share + forward_share);
    const double all = draws[0] + draws[1] + draws[2];
    for (double& d : draws) d /= all;
    last = {glossy_values.v, wo, draws};
  }
  double sheen(Vec3 wi) const {
    double sum = 0;
    if (sheen_share > 0) sum += sheen_share * velvet(wo, wi, width);
    if (forward_share > 0) sum += forward_share * forward_sheen(wo, wi);
    return sum;
  }
  Rgb base(Vec3 wi) const { return glossy().evaluate(glossy_values, wo, wi) * glossy_share; }
  Rgb bare(Vec3 wi) const { return metal_share > 0 ? metal().evaluate(metal_values, wo, wi) * metal_share : Rgb{}; }
  Rgb evaluate(Vec3 wi) const {
    const double s = sheen(wi);
    return base(wi) + bare(wi) + Rgb{s, s, s};
  }
  double pdf(Vec3 wi) const {
    double density = draws[0] * glossy().pdf(glossy_values, wo, wi) + draws[2] / (2 * pi);
    if (draws[1] > 0) density += draws[1] * metal().pdf(metal_values, wo, wi);
    return density;
  }
};

bool plain(const Values& v) {
  return v.scalar(metal_index) == 0 && v.scalar(sheen_index) == 0 && v.scalar(forward_index) == 0;
}

class Compound final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "compound",
        .sentence =
            "A matte base under a gloss, part of it bare metal of the base's colour, part of it fibres that shine "
            "at grazing angles.",
        .source = "Walter et al. 2007; Kulla & Conty 2017; Ashikhmin 2007; Burley 2012",
        .parameters = parameters(),
    };
    return info;
  }
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    return plain(values) ? glossy().evaluate(values, wo, wi) : Parts(values, wo).evaluate(wi);
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    if (plain(values)) return glossy().sample(values, wo, u, u_lobe);
    Parts parts(values, wo);
    parts.weigh_draws();
    const auto& d = parts.draws;
    Vec3 wi;
    if (u_lobe < d[0]) {
      wi = glossy().sample(values, wo, u, u_lobe / d[0]).wi;
    } else if (u_lobe < d[0] + d[1]) {
      wi = metal().sample(parts.metal_values, wo, u, (u_lobe - d[0]) / d[1]).wi;
    } else {
      const double s = std::sqrt(std::max(0.0, 1 - u.x * u.x));
      wi = {s * std::cos(2 * pi * u.y), s * std::sin(2 * pi * u.y), u.x};
    }
    const double density = wi.z > 0 ? parts.pdf(wi) : 0;
    if (!(density > 0)) return {};
    return {wi, parts.evaluate(wi) * (wi.z / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return 0;
    if (plain(values)) return glossy().pdf(values, wo, wi);
    Parts parts(values, wo);
    parts.weigh_draws();
    return parts.pdf(wi);
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    if (plain(values)) return glossy().albedo(values, wo);
    const Parts parts(values, wo);
    Rgb sum = glossy().albedo(values, wo) * parts.glossy_share;
    if (parts.metal_share > 0) sum += metal().albedo(parts.metal_values, wo) * parts.metal_share;
    double sheen = 0;
    if (parts.sheen_share > 0) sheen += parts.sheen_share * velvet_albedo(wo.z, parts.width);
    if (parts.forward_share > 0) sheen += parts.forward_share * forward_sheen_albedo(wo.z);
    return sum + Rgb{sheen, sheen, sheen};
  }
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (plain(values)) return glossy().mueller(values, wo, wi);
    const Parts parts(values, wo);
    const Rgb base = parts.base(wi), bare = parts.bare(wi), all = parts.evaluate(wi);
    const optics::MuellerRgb matte = glossy().mueller(values, wo, wi),
                             metallic = metal().mueller(parts.metal_values, wo, wi);
    optics::MuellerRgb result;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double shining = base[i] + bare[i];
      result[k] = mixed(mixed(metallic[k], matte[k], share_of(bare[i], shining)), optics::Mueller::depolarizer(),
                        share_of(shining, all[i]));
    }
    return result;
  }
  bool proportional_to_albedo(const Values& values) const override {
    return values.scalar(metal_index) == 0 && glossy().proportional_to_albedo(values);
  }

 private:
  static std::vector<manifest::ParameterInfo> parameters() {
    std::vector<manifest::ParameterInfo> all = glossy().info().parameters;
    const std::vector<manifest::ParameterInfo> own = {
        {.name = "metal",
         .unit = "1",
         .preset = 0,
         .lower = 0,
         .upper = 1,
         .meaning = "share that is bare metal, whose reflectance at normal incidence is the albedo"},
        {.name = "metal_alpha",
         .unit = "1",
         .preset = 0.3,
         .lower = least_metal_alpha,
         .upper = 1,
         .meaning = "GGX roughness of the metal"},
        {.name = "sheen",
         .unit = "1",
         .preset = 0,
         .lower = 0,
         .upper = 1,
         .meaning = "share of fibres that stand on the surface"},
        {.name = "sheen_width",
         .unit = "1",
         .preset = 0.5,
         .lower = least_sheen_width,
         .upper = largest_sheen_width,
         .meaning = "spread of the fibres' normals about the horizon, as a slope"},
        {.name = "sheen_forward",
         .unit = "1",
         .preset = 0,
         .lower = 0,
         .upper = 1,
         .meaning = "share of a sheen that is strongest where lamp and eye face each other across the surface"}};
    all.insert(all.end(), own.begin(), own.end());
    return all;
  }
};

}  // namespace

const Model& compound() {
  static const Compound model;
  return model;
}

}  // namespace gonio::surface
