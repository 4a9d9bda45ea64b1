// Metal whose colour is stated as its reflectance at normal incidence, smooth or rough.
// GGX with Schlick's Fresnel factor, F = f0 + (1 - f0) (1 - wi.h)^5, and multiple scattering between facets
// (surface/metal_lobe.h). F_mean = f0 + (1 - f0) / 21 exactly. albedo() is exact where it is smooth, else a quadrature
// (some ten microseconds), exact to 4e-3 where it is isotropic and to 1e-2 where it is not.
// Polarization is that of the index 1 + i k, k = 2 sqrt(f0 / (1 - f0)): a colour does not state one.
// For measured indices, and the dip before grazing incidence that Schlick's formula lacks, see `conductor`.
#include "surface/fresnel.h"
#include "surface/metal_lobe.h"

namespace gonio::surface {
namespace {

enum : std::size_t { f0_index, alpha_index, anisotropy_index, azimuth_index };

struct Optics {
  static Roughness roughness(const Values& values) {
    return {values.scalar(alpha_index), values.scalar(anisotropy_index), values.scalar(azimuth_index)};
  }
  static auto fresnel(const Values& values) {
    return [f0 = values.rgb(f0_index)](double cosine) { return fresnel_schlick(cosine, f0); };
  }
  static constexpr std::size_t colours = 1;
  template <class T>
  struct Fresnel {
    T f0;
    Fresnel(const Values& values, int band) : f0(T::unknown(values.rgb(f0_index)[band], 0)) {}
    T operator()(double cosine) const { return f0 + (1 - f0) * schlick_rise(cosine); }
    T mean() const { return f0 + (1 - f0) / 21; }
  };
  static Rgb fresnel_mean(const Values& values) {
    const Rgb f0 = values.rgb(f0_index);
    return f0 + (Rgb{1, 1, 1} - f0) / 21;
  }
  // Of the indices with this f0 the one whose real part is 1, as those of bright metals roughly are.
  static optics::Complex index(const Values& values, int band) {
    const double f0 = std::clamp(values.rgb(f0_index)[band], 1e-6, 0.9999);
    return {1, 2 * std::sqrt(f0 / (1 - f0))};
  }
};

class Metal final : public MetalModel<Slopes::ggx, Optics> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "metal",
        .sentence = "A metal, smooth or rough, by its colour at normal incidence.",
        .source = "Walter et al. 2007; Heitz 2014, 2018; Schlick 1994, equation 15; Kulla & Conty 2017",
        .parameters = parameters(),
    };
    return info;
  }

 private:
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
    return all;
  }
};

}  // namespace

const Model& metal() {
  static const Metal model;
  return model;
}

}  // namespace gonio::surface
