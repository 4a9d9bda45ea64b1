// What a facet of an engineered relief sends about its mirror direction: Fresnel's reflection of the index eta + i k,
// and light that entered and came back, as Luongo et al. 2017 have it (equations 5 and 6),
//   F + (1 - F)^2 rho_d / pi,
// at the cosine of either direction to the facet's normal. The first part polarizes as Fresnel's amplitudes do, the
// second has lost its polarization.
#pragma once
#include <vector>

#include "surface/fresnel.h"
#include "surface/polarization.h"
#include "surface/surface.h"

namespace gonio::surface {

struct FacetMaterial {
  Rgb eta, k, rho_d;

  Rgb reflects(double cosine) const { return {band(0, cosine), band(1, cosine), band(2, cosine)}; }
  optics::MuellerRgb mueller(double cosine) const {
    optics::MuellerRgb result;
    for (int i = 0; i < 3; ++i) {
      const double mirrored = fresnel_metal(cosine, eta[i], k[i]);
      result[static_cast<std::size_t>(i)] = mixed(reflected_by(cosine, {eta[i], k[i]}), optics::Mueller::depolarizer(),
                                                  share_of(mirrored, band(i, cosine)));
    }
    return result;
  }

 private:
  double band(int i, double cosine) const {
    const double f = fresnel_metal(cosine, eta[i], k[i]), enters = 1 - f;
    return f + enters * enters * rho_d[i] / pi;
  }
};

// Their declaration, in the order of the members, between a model's own parameters.
inline std::vector<manifest::ParameterInfo> with_facet_material(std::vector<manifest::ParameterInfo> before,
                                                                const std::vector<manifest::ParameterInfo>& after) {
  const auto rgb = [](const char* name, double preset, double lower, double upper, const char* meaning) {
    return manifest::ParameterInfo{.name = name,
                                   .unit = "1",
                                   .components = 3,
                                   .rgb = true,
                                   .preset = preset,
                                   .lower = lower,
                                   .upper = upper,
                                   .meaning = meaning};
  };
  before.push_back(rgb("eta", 1.5, 0.01, 20, "real part of the index at red, green and blue"));
  before.push_back(rgb("k", 0, 0, 30, "extinction coefficient at red, green and blue"));
  before.push_back(rgb("rho_d", 0, 0, 1, "diffuse reflectance of the material beneath the facets"));
  before.insert(before.end(), after.begin(), after.end());
  return before;
}

}  // namespace gonio::surface
