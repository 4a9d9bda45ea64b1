// Rough metal of measured optical constants: GGX with the exact Fresnel factor of the complex index eta + i k per
// colour, and multiple scattering between facets (surface/metal_lobe.h). F_mean is a five-point Gauss quadrature.
// albedo() is a quadrature over visible normals (some ten microseconds), exact to 2e-3.
#include <array>

#include "surface/fresnel.h"
#include "surface/metal_lobe.h"

namespace gonio::surface {
namespace {

enum : std::size_t { eta_index, k_index, alpha_index };

Rgb fresnel_rgb(double cosine, Rgb eta, Rgb k) {
  return {fresnel_metal(cosine, eta.x, k.x), fresnel_metal(cosine, eta.y, k.y), fresnel_metal(cosine, eta.z, k.z)};
}

// 2 integral of F(c) c dc = integral of F(sqrt(t)) dt over [0, 1].
Rgb fresnel_mean(Rgb eta, Rgb k) {
  constexpr std::array<double, 5> node = {0.0469100770306680, 0.2307653449471585, 0.5, 0.7692346550528415,
                                          0.9530899229693320};
  constexpr std::array<double, 5> weight = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                            0.2393143352496832, 0.1184634425280945};
  Rgb sum;
  for (std::size_t i = 0; i < node.size(); ++i) sum += fresnel_rgb(std::sqrt(node[i]), eta, k) * weight[i];
  return sum;
}

struct Optics {
  static MetalLobe lobe(const Values& values, Vec3 wo) {
    return {values.scalar(alpha_index), fresnel_mean(values.rgb(eta_index), values.rgb(k_index)), wo};
  }
  static optics::Complex index(const Values& values, int band) {
    return {values.rgb(eta_index)[band], values.rgb(k_index)[band]};
  }
  static auto fresnel(const Values& values) {
    return
        [eta = values.rgb(eta_index), k = values.rgb(k_index)](double cosine) { return fresnel_rgb(cosine, eta, k); };
  }
};

class Conductor final : public MetalModel<Optics> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "conductor",
        .sentence = "A rough metal, by its measured complex index of refraction.",
        .source = "Walter et al. 2007; Born & Wolf 1999, section 14.2; Kulla & Conty 2017",
        .parameters = {{.name = "eta",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0.01,
                        .upper = 20,
                        .meaning = "real part of the index at red, green and blue"},
                       {.name = "k",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .upper = 30,
                        .meaning = "extinction coefficient at red, green and blue"},
                       {.name = "alpha",
                        .unit = "1",
                        .preset = 0.1,
                        .lower = min_alpha,
                        .upper = max_alpha,
                        .meaning = "GGX roughness"}},
    };
    return info;
  }
  Rgb albedo(const Values& values, Vec3 wo) const override {
    if (wo.z <= 0) return {};
    const MetalLobe once_and_more = Optics::lobe(values, wo);
    return once_and_more.albedo_once(Optics::fresnel(values)) + once_and_more.albedo_more();
  }
};

}  // namespace

const Model& conductor() {
  static const Conductor model;
  return model;
}

}  // namespace gonio::surface
