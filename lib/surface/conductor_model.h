// A metal of measured optical constants, smooth or rough: what `conductor` and `beckmann-conductor` share. Reflection
// by surface/metal_lobe.h with the exact Fresnel factor of the complex index eta + i k per band (surface/fresnel.h);
// F_mean is a five-point Gauss quadrature. The axes of alpha and of what lies across it are the tangent, turned by
// azimuth_rad, and its perpendicular.
#pragma once
#include <array>

#include "surface/fresnel.h"
#include "surface/metal_lobe.h"

namespace gonio::surface {

struct ConductorOptics {
  static Roughness roughness(const Values& values) {
    return {values.scalar(alpha_index), values.scalar(anisotropy_index), values.scalar(azimuth_index)};
  }
  static auto fresnel(const Values& values) {
    return [eta = values.rgb(eta_index), k = values.rgb(k_index)](double cosine) {
      return Rgb{fresnel_metal(cosine, eta.x, k.x), fresnel_metal(cosine, eta.y, k.y),
                 fresnel_metal(cosine, eta.z, k.z)};
    };
  }
  // Remembered by each thread for the last metal: it takes longer than the rest of the lobe.
  static Rgb fresnel_mean(const Values& values) {
    struct Remembered {
      Rgb eta, k, mean;
    };
    thread_local Remembered last;
    if (last.eta != values.rgb(eta_index) || last.k != values.rgb(k_index))
      last = {values.rgb(eta_index), values.rgb(k_index), fresnel_mean_by_quadrature(values)};
    return last.mean;
  }
  // 2 integral of F(c) c dc = integral of F(sqrt(t)) dt over [0, 1].
  static Rgb fresnel_mean_by_quadrature(const Values& values) {
    constexpr std::array<double, 5> node = {0.0469100770306680, 0.2307653449471585, 0.5, 0.7692346550528415,
                                            0.9530899229693320};
    constexpr std::array<double, 5> weight = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                              0.2393143352496832, 0.1184634425280945};
    const auto reflected = fresnel(values);
    Rgb sum;
    for (std::size_t i = 0; i < node.size(); ++i) sum += reflected(std::sqrt(node[i])) * weight[i];
    return sum;
  }
  static optics::Complex index(const Values& values, int band) {
    return {values.rgb(eta_index)[band], values.rgb(k_index)[band]};
  }
  static std::vector<manifest::ParameterInfo> parameters() {
    std::vector<manifest::ParameterInfo> all = {{.name = "eta",
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
                                                 .meaning = "extinction coefficient at red, green and blue"}};
    for (const auto& p : roughness_parameters(0.1)) all.push_back(p);
    return all;
  }

 private:
  enum : std::size_t { eta_index, k_index, alpha_index, anisotropy_index, azimuth_index };
};

}  // namespace gonio::surface
