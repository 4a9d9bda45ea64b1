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
  static constexpr std::array<double, 5> gauss_node = {0.0469100770306680, 0.2307653449471585, 0.5, 0.7692346550528415,
                                                       0.9530899229693320};
  static constexpr std::array<double, 5> gauss_weight = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                                         0.2393143352496832, 0.1184634425280945};
  static Roughness roughness(const Values& values) {
    return {values.scalar(alpha_index), values.scalar(anisotropy_index), values.scalar(azimuth_index)};
  }
  static auto fresnel(const Values& values) {
    return [eta = values.rgb(eta_index), k = values.rgb(k_index)](double cosine) {
      return Rgb{fresnel_metal(cosine, eta.x, k.x), fresnel_metal(cosine, eta.y, k.y),
                 fresnel_metal(cosine, eta.z, k.z)};
    };
  }
  static constexpr std::size_t colours = 2;
  template <class T>
  struct Fresnel {
    T eta, k;
    Fresnel(const Values& values, int band)
        : eta(T::unknown(values.rgb(eta_index)[band], 0)), k(T::unknown(values.rgb(k_index)[band], 1)) {}
    T operator()(double cosine) const {
      const Dual<2> f = of(cosine);
      T r(f.v);
      r.d[0] = f.d[0], r.d[1] = f.d[1];
      return r;
    }
    // Remembered by each thread, as below.
    T mean() const {
      struct Remembered {
        double eta = -1, k = -1;
        Dual<2> mean;
      };
      thread_local std::array<Remembered, 4> last;
      thread_local std::size_t next = 0;
      const Remembered* found = nullptr;
      for (const Remembered& r : last)
        if (r.eta == eta.v && r.k == k.v) found = &r;
      if (found == nullptr) {
        Dual<2> sum;
        for (std::size_t i = 0; i < gauss_node.size(); ++i) sum += of(std::sqrt(gauss_node[i])) * gauss_weight[i];
        last[next] = {eta.v, k.v, sum};
        found = &last[next];
        next = (next + 1) % last.size();
      }
      T r(found->mean.v);
      r.d[0] = found->mean.d[0], r.d[1] = found->mean.d[1];
      return r;
    }

   private:
    Dual<2> of(double cosine) const {
      return fresnel_metal(cosine, Dual<2>::unknown(eta.v, 0), Dual<2>::unknown(k.v, 1));
    }
  };
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
    const auto reflected = fresnel(values);
    Rgb sum;
    for (std::size_t i = 0; i < gauss_node.size(); ++i) sum += reflected(std::sqrt(gauss_node[i])) * gauss_weight[i];
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
