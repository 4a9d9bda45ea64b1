// Rough metal whose colour is stated as its reflectance at normal incidence.
// GGX with Schlick's Fresnel factor, F = f0 + (1 - f0) (1 - wi.h)^5, and multiple scattering between facets
// (surface/metal_lobe.h). F_mean = f0 + (1 - f0) / 21 exactly. albedo() is exact up to the tables' error.
// Polarization is that of the index 1 + i k, k = 2 sqrt(f0 / (1 - f0)): a colour does not state one.
// For measured indices, and the dip before grazing incidence that Schlick's formula lacks, see `conductor`.
#include "surface/fresnel.h"
#include "surface/metal_lobe.h"

namespace gonio::surface {
namespace {

enum : std::size_t { f0_index, alpha_index };

struct Optics {
  static MetalLobe lobe(const Values& values, Vec3 wo) {
    const Rgb f0 = values.rgb(f0_index);
    return {values.scalar(alpha_index), f0 + (Rgb{1, 1, 1} - f0) / 21, wo};
  }
  // Of the indices with this f0 the one whose real part is 1, as those of bright metals roughly are.
  static optics::Complex index(const Values& values, int band) {
    const double f0 = std::clamp(values.rgb(f0_index)[band], 1e-6, 0.9999);
    return {1, 2 * std::sqrt(f0 / (1 - f0))};
  }
  static auto fresnel(const Values& values) {
    return [f0 = values.rgb(f0_index)](double cosine) { return fresnel_schlick(cosine, f0); };
  }
};

class Metal final : public MetalModel<Optics> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "metal",
        .sentence = "A rough metal, by its colour at normal incidence.",
        .source = "Walter et al. 2007; Schlick 1994, equation 15; Kulla & Conty 2017",
        .parameters = {{.name = "f0",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .upper = 1,
                        .meaning = "reflectance at normal incidence, of linear red, green and blue"},
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
    const double alpha = values.scalar(alpha_index), all = mirror_albedo(wo.z, alpha), rise = rise_albedo(wo.z, alpha);
    return values.rgb(f0_index) * (all - rise) + Rgb{rise, rise, rise} + Optics::lobe(values, wo).albedo_more();
  }
};

}  // namespace

const Model& metal() {
  static const Metal model;
  return model;
}

}  // namespace gonio::surface
