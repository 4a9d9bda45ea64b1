// Translucent medium by the standard dipole: Jensen, Marschner, Levoy & Hanrahan 2001, "A Practical Model for
// Subsurface Light Transport", under a rough interface (surface/dipole_interface.h).
//   R_d(r) = alpha' / (4 pi) sum over k of  z_k (1 + sigma_tr d_k) exp(-sigma_tr d_k) / d_k^3,   d_k^2 = r^2 + z_k^2
//   z_r = 1 / sigma_t',   z_v = z_r + 4 A D,   A = (1 + 2 C_1) / (1 - 2 C_1)
// r is the straight distance between the two points. 2 C_1, the interior's diffuse Fresnel reflectance, is the exact
// integral and not the paper's polynomial (surface/dipole_medium.h). S_d = R_d / (pi T_mean): the paper divides by pi
// alone, by which less leaves than R_d says. The whole reflectance beneath the interface is
//   R = alpha' / 2 (exp(-sigma_tr z_r) + exp(-sigma_tr z_v)),
// one without absorption: the dipole already accounts for all light, and single scattering (S^(1), the paper's section
// 2.3; parameter `single_scattering`) comes on top. It is traced: render/subsurface_walk.h.
#include <algorithm>
#include <cmath>

#include "surface/dipole_model.h"

namespace gonio::surface {
namespace {

constexpr std::size_t single_index = 5;

struct Band {
  double strength = 0, sigma_tr = 0;  // alpha' / (4 pi) times the normalisation
  std::array<double, 2> depth_m{1, 1};
};

class StandardDipole final : public DipoleSubsurface {
 public:
  explicit StandardDipole(const Values& values) : DipoleSubsurface(values, false) {
    double whole[3] = {};
    for (int i = 0; i < 3; ++i) {
      const DipoleMedium& m = medium(i);
      if (!m.scatters()) continue;
      const auto [z, v] = standard_depths(m, interior());
      const double real = std::exp(-m.sigma_tr * z), mirrored = std::exp(-m.sigma_tr * v);
      bands_[static_cast<std::size_t>(i)] = {m.albedo_reduced / (4 * pi) * normaliser(), m.sigma_tr, {z, v}};
      whole[i] = standard_reflectance(m, interior());
      set_distances(i, {{{z, real / (real + mirrored)}, {v, mirrored / (real + mirrored)}}});
    }
    finish_distances();
    set_reflectance({whole[0], whole[1], whole[2]});
    set_straight(values);
  }

  Rgb evaluate(const SubsurfaceEntry& entry, Vec3 exit_m, Vec3) const override {
    const Vec3 arm = exit_m - entry.position_m;
    const double square = dot(arm, arm);
    return {profile(bands_[0], square), profile(bands_[1], square), profile(bands_[2], square)};
  }
  const StraightLight* straight() const override { return straight_.single > 0 ? &straight_ : nullptr; }

 private:
  static double profile(const Band& band, double square) {
    double sum = 0;
    for (const double z : band.depth_m) {
      const double d2 = square + z * z, d = std::sqrt(d2);
      sum += z * (1 + band.sigma_tr * d) * std::exp(-band.sigma_tr * d) / (d2 * d);
    }
    return band.strength * sum;
  }
  void set_straight(const Values& values) {
    const Rgb a = values.rgb(dipole_sigma_a), s = values.rgb(dipole_sigma_s);
    straight_.medium = {{eta(), eta(), eta()}, a, s, values.rgb(dipole_g)};
    straight_.single = values.scalar(single_index);
    if (!(straight_.single > 0)) return;
    // By power: about alpha / 8 is what a half space of isotropic scatterers sends back at once.
    double albedo = 0;
    for (int i = 0; i < 3; ++i) albedo = std::max(albedo, s[i] > 0 ? s[i] / (a[i] + s[i]) : 0);
    const double once = straight_.single * albedo / 8, more = mean(diffuse_reflectance());
    straight_.single_share = std::clamp(once / (once + more), 0.05, 0.5);
  }

  std::array<Band, 3> bands_;
  StraightLight straight_;
};

class Dipole final : public DipoleModel {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "dipole",
        .sentence = "A translucent solid in which light spreads evenly beneath a rough interface.",
        .source = "Jensen et al. 2001; Walter et al. 2007; d'Eon & Irving 2011, section 4",
        .parameters = parameters(),
    };
    return info;
  }

 protected:
  std::shared_ptr<const DipoleSubsurface> build(const Values& values) const override {
    return std::make_shared<const StandardDipole>(values);
  }

 private:
  static std::vector<manifest::ParameterInfo> parameters() {
    std::vector<manifest::ParameterInfo> all = dipole_parameters();
    all.push_back({.name = "single_scattering",
                   .unit = "1",
                   .preset = 0,
                   .lower = 0,
                   .upper = 1,
                   .meaning = "share of traced single scattering that is added: 1 as published, 0 for what conserves "
                              "energy"});
    return all;
  }
};

}  // namespace

const Model& dipole() {
  static const Dipole model;
  return model;
}

}  // namespace gonio::surface
