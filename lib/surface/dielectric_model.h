// A clear interface to the medium inside an object: what `dielectric` and `beckmann-dielectric` share; equations in
// surface/dielectric_lobe.h. Smooth below alpha = 1e-4: then both lobes are deltas. The relative index is that of
// Values::eta, which the media on both sides make; the parameters say what is inside.
#pragma once
#include "surface/dielectric_lobe.h"
#include "surface/polarization.h"

namespace gonio::surface {

template <Slopes kind>
class DielectricModel : public Model {
 public:
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || roughness(values).smooth()) return {};
    return lobe(values, wo).evaluate(wi);
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    if (roughness(values).smooth()) return SmoothInterface(values.eta, values.hero, wo).sample(u_lobe);
    return lobe(values, wo).sample(u, u_lobe);
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    return wo.z <= 0 || roughness(values).smooth() ? 0 : lobe(values, wo).pdf(wi);
  }
  // Light that met several facets is unpolarized.
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    const Rgb once = roughness(values).smooth() ? Rgb{1, 1, 1} : lobe(values, wo).share_of_one_facet(wi);
    optics::MuellerRgb result;
    for (int i = 0; i < 3; ++i)
      result[static_cast<std::size_t>(i)] =
          mixed(dielectric_facet(values.eta[i], wo, wi), optics::Mueller::depolarizer(), once[i]);
    return result;
  }
  Rgb albedo(const Values&, Vec3 wo) const override { return wo.z > 0 ? Rgb{1, 1, 1} : Rgb{}; }
  bool transmits() const override { return true; }
  std::optional<Medium> interior(const Values& values) const override {
    return Medium{.eta = values.rgb(eta_index),
                  .sigma_a_per_m = values.rgb(absorption_index),
                  .sigma_s_per_m = values.rgb(scattering_index),
                  .g = values.rgb(g_index)};
  }

 protected:
  enum : std::size_t {
    eta_index,
    alpha_index,
    anisotropy_index,
    azimuth_index,
    absorption_index,
    scattering_index,
    g_index
  };
  static Roughness roughness(const Values& values) {
    return {values.scalar(alpha_index), values.scalar(anisotropy_index), values.scalar(azimuth_index)};
  }
  static DielectricLobe<kind> lobe(const Values& values, Vec3 wo) {
    return {roughness(values), values.inside, values.eta, values.hero, wo};
  }
  static std::vector<manifest::ParameterInfo> parameters() {
    const auto rgb = [](const char* name, const char* unit, std::optional<double> preset, double lower, double upper,
                        const char* meaning) {
      return manifest::ParameterInfo{.name = name,
                                     .unit = unit,
                                     .components = 3,
                                     .rgb = true,
                                     .preset = preset,
                                     .lower = lower,
                                     .upper = upper,
                                     .meaning = meaning};
    };
    std::vector<manifest::ParameterInfo> all = {
        rgb("eta", "1", std::nullopt, 1, 4, "index of refraction of what is inside, at red, green and blue")};
    for (const auto& p : roughness_parameters(0)) all.push_back(p);
    all.push_back(rgb("sigma_a_per_m", "1/m", 0, 0, 1e6, "absorption coefficient inside"));
    all.push_back(rgb("sigma_s_per_m", "1/m", 0, 0, 1e7, "scattering coefficient inside"));
    all.push_back(rgb("g", "1", 0, -0.99, 0.99, "mean cosine of scattering inside: 0 all around, 0.9 forwards"));
    return all;
  }
};

}  // namespace gonio::surface
