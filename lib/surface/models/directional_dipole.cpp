// Translucent medium by the directional dipole: Frisvad, Hachisuka & Kjeldsen 2014, "Directional Dipole Model for
// Subsurface Scattering", under a rough interface (thesis E, equations 8-9; surface/dipole_interface.h).
// A ray of light that enters an infinite medium at the origin along w has, in the diffusion approximation with D and
// sigma_tr of surface/dipole_medium.h, the fluence G - 3 D w.grad G, G = exp(-sigma_tr r) / (4 pi D r):
//   fluence = exp(-s r) / (4 pi D r) (1 + 3 D (1 + s r) x.w / r^2),   s = sigma_tr,   r = |x|
// With the exitance C_phi fluence - C_E D n_o.grad fluence through a plane of normal n_o and the normalisation
// 1 / (pi T_mean) of surface/subsurface.h:
//   S'(x, w, r) = exp(-s r) / (4 pi r^3) / (pi T_mean)
//     [ C_phi (r^2 / D + 3 (1 + s r) x.w)
//       - C_E (3 D (1 + s r) w.n_o - ((1 + s r) + 3 D (3 (1 + s r) + (s r)^2) x.w / r^2) x.n_o) ]
//   S_d = max(0, S'(x, w12, d_r) - S'(x - 2 A d_e n*, w_v, d_v))
// n* is the normal of the plane through both points that is nearest to n_i, w_v is w12 mirrored in it, d_v the distance
// to the mirrored source, A = (1 - C_E) / (2 C_phi), d_e = 2.131 D / sqrt(alpha') (Milne's problem). The distance to
// the real source is moved off its singularity (section 4.2 of the paper), mu = -n_o.w12:
//   mu > 0:  d_r^2 = r^2 + D mu (D mu + 2 d_e sqrt((r^2 - (x.w12)^2) / (r^2 + d_e^2)));  else r^2 + 1 / (3 sigma_t)^2
// The formula sends out more than it should: against photons in a half space (tests/surface/subsurface_test.cpp) 1.2 to
// 1.5 times for alpha' = 0.95 to 0.999, most of it nearer than a mean free path 1 / sigma_t'; farther away it is the
// better of the two dipoles. Where it would send out more than enters, bands are scaled down to one.
// The reduced intensity S_dE passes straight through, refracted, with sigma_a + (1 - g^2) sigma_s (delta-Eddington):
// render/subsurface_walk.h.
#include <algorithm>
#include <cmath>

#include "surface/dipole_model.h"

namespace gonio::surface {
namespace {

struct Band {
  double diffusion_m = 0, sigma_tr = 0, extrapolation_m = 0, mirror_m = 0, behind_m = 0;
  double scale = 1;  // below one where more than all light would leave
};

class DirectionalDipole final : public DipoleSubsurface {
 public:
  explicit DirectionalDipole(const Values& values) : DipoleSubsurface(values, true) {
    const double mismatch = (1 - interior().c_e) / (2 * interior().c_phi);
    scale_ = normaliser() / (4 * pi);
    for (int i = 0; i < 3; ++i) {
      const DipoleMedium& m = medium(i);
      if (!m.scatters()) continue;
      const double extrapolation = 2.131 * m.diffusion_m / std::sqrt(m.albedo_reduced);
      bands_[static_cast<std::size_t>(i)] = {
          m.diffusion_m, m.sigma_tr, extrapolation, 2 * mismatch * extrapolation, 1 / (3 * (m.sigma_a + m.sigma_s)), 1};
      set_distances(i, {{{m.diffusion_m, 0.5}, {1 / m.sigma_t_reduced + mismatch * extrapolation, 0.5}}});
    }
    finish_distances();
    Rgb whole{reflectance(0), reflectance(1), reflectance(2)};
    for (std::size_t i = 0; i < 3; ++i) bands_[i].scale = 1 / std::max(1.0, whole[static_cast<int>(i)]);
    set_reflectance({std::min(1.0, whole.x), std::min(1.0, whole.y), std::min(1.0, whole.z)});
    const auto weakened = [](double s, double g) { return s * (1 - g * g); };
    const Rgb a = values.rgb(dipole_sigma_a), s = values.rgb(dipole_sigma_s), g = values.rgb(dipole_g);
    straight_.medium.sigma_a_per_m = a + Rgb{weakened(s.x, g.x), weakened(s.y, g.y), weakened(s.z, g.z)};
    straight_.passes = true;
  }

  Rgb evaluate(const SubsurfaceEntry& entry, Vec3 exit_m, Vec3 exit_normal) const override {
    const Meeting here = meeting(entry, exit_m, exit_normal);
    return {one(bands_[0], here), one(bands_[1], here), one(bands_[2], here)};
  }
  const StraightLight* straight() const override { return &straight_; }

 private:
  struct Meeting {
    Vec3 x, w, normal, plane, mirrored;
    double square, along, mu;
  };

  static Meeting meeting(const SubsurfaceEntry& entry, Vec3 exit_m, Vec3 exit_normal) {
    const Vec3 x = exit_m - entry.position_m, w = entry.inward;
    const double square = dot(x, x);
    const Vec3 side = cross(entry.normal, x);
    const double across = norm(side);
    const Vec3 plane = across > 1e-9 * std::sqrt(square) ? cross(x, side) / (std::sqrt(square) * across) : entry.normal;
    const Vec3 mirrored = w - plane * (2 * dot(w, plane));
    return {x, w, exit_normal, plane, mirrored, square, dot(x, w), -dot(exit_normal, w)};
  }

  // Without `scale_`.
  double ray(const Band& b, double r2, double x_w, double w_n, double x_n) const {
    const double r = std::sqrt(r2), t = b.sigma_tr * r, t1 = 1 + t, three_d = 3 * b.diffusion_m;
    const double fluence = r2 / b.diffusion_m + 3 * t1 * x_w;
    const double gradient = three_d * t1 * w_n - (t1 + three_d * (3 * t1 + t * t) / r2 * x_w) * x_n;
    return std::exp(-t) / (r2 * r) * (interior().c_phi * fluence - interior().c_e * gradient);
  }

  double one(const Band& b, const Meeting& m) const {
    if (!(b.diffusion_m > 0)) return 0;
    const double in_front = b.diffusion_m * m.mu, e2 = b.extrapolation_m * b.extrapolation_m;
    const double sine = std::sqrt(std::max(0.0, m.square - m.along * m.along) / (m.square + e2));
    const double real2 =
        m.square + (m.mu > 0 ? in_front * (in_front + 2 * b.extrapolation_m * sine) : b.behind_m * b.behind_m);
    const Vec3 y = m.x - m.plane * b.mirror_m;
    const double real = ray(b, real2, m.along, -m.mu, dot(m.x, m.normal));
    const double virtual_one = ray(b, dot(y, y), dot(y, m.mirrored), dot(m.mirrored, m.normal), dot(y, m.normal));
    return std::max(0.0, scale_ * b.scale * (real - virtual_one));
  }

  // pi T_mean times the integral of S_d over a plane, the mean over diffuse light through a smooth interface: Gauss
  // points of the cosine outside, midpoints of azimuth and of v, v^2 (3 - 2 v) the distances' distribution. Against
  // finer rules: 1e-3.
  double reflectance(int i) const {
    if (!medium(i).scatters()) return 0;
    constexpr int radii = 48, angles = 8;
    static const auto rule = gauss_legendre(8);
    std::array<double, radii> distance{}, weight{};
    for (std::size_t k = 0; k < radii; ++k) {
      const double v = (static_cast<double>(k) + 0.5) / radii;
      distance[k] = sample_distance(i, v * v * (3 - 2 * v));
      weight[k] = 6 * v * (1 - v) / (radii * angles * distance_density(i, distance[k]));
    }
    double sum = 0, passed = 0;
    for (const auto& [c, share] : rule) {
      const double passes = share * c * (1 - fresnel_dielectric(c, eta()));
      const SubsurfaceEntry entry{{}, {0, 0, 1}, refracted_inwards({std::sqrt(1 - c * c), 0, c}, {0, 0, 1}, eta())};
      passed += passes;
      for (int a = 0; a < angles; ++a) {
        const double phi = pi * (a + 0.5) / angles;
        const Vec3 along{std::cos(phi), std::sin(phi), 0};
        for (std::size_t k = 0; k < radii; ++k)
          sum += passes * weight[k] *
                 one(bands_[static_cast<std::size_t>(i)], meeting(entry, along * distance[k], {0, 0, 1}));
      }
    }
    return sum / (passed * normaliser());
  }

  std::array<Band, 3> bands_;
  double scale_ = 0;
  StraightLight straight_;
};

class DirectionalDipoleModel final : public DipoleModel {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "directional-dipole",
        .sentence = "A translucent solid beneath a rough interface, in which light spreads on from where it is going.",
        .source = "Frisvad, Hachisuka & Kjeldsen 2014; Walter et al. 2007; d'Eon & Irving 2011, section 4",
        .parameters = dipole_parameters(),
    };
    return info;
  }

 protected:
  std::shared_ptr<const DipoleSubsurface> build(const Values& values) const override {
    return std::make_shared<const DirectionalDipole>(values);
  }
};

}  // namespace

const Model& directional_dipole() {
  static const DirectionalDipoleModel model;
  return model;
}

}  // namespace gonio::surface
