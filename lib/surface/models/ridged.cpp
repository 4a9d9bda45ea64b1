// Parallel micro-ridges, as milled into moulds to make a surface change its brightness when it is turned.
//   f = (F(wi.h) + (1 - F(wi.h))^2 rho_d / pi) cos(theta_r) G Gs D_m(h) / (4 (wi.n) (wo.n))
// Luongo et al. 2017, "Modeling the anisotropic reflectance of a surface with microstructure engineered to obtain
// visible contrast after rotation", equations 2 to 6, with the masking G and the density of normals of
// surface/ridges.h, where it is said how and why they differ from the published ones. F is Fresnel's factor for the
// complex index eta + i k. The second term stands for light that entered and came back: as published, it leaves about
// the mirror direction, like the first, and carries at most rho_d / pi of what entered. h is the half vector.
// Reciprocal; reflects at most what arrives. albedo() is a sum over 512 visible normals.
#include "surface/facet_slopes.h"
#include "surface/interface_albedo.h"
#include "surface/ridge_facets.h"
#include "surface/ridges.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t { ridge_index, alpha_u_index, alpha_v_index, eta_index, k_index, rho_index, azimuth_index };

Ridges ridges_of(const Values& values) {
  return {values.scalar(ridge_index), values.scalar(alpha_u_index), values.scalar(alpha_v_index),
          values.scalar(azimuth_index)};
}

FacetMaterial material_of(const Values& values) {
  return {values.rgb(eta_index), values.rgb(k_index), values.rgb(rho_index)};
}

class Ridged final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "ridged",
        .sentence = "Parallel micro-ridges of a saw's profile with rough facets.",
        .source = "Luongo et al. 2017, equations 2-6; Heitz 2014",
        .parameters = with_facet_material(
            {{.name = "ridge_rad",
              .unit = "rad",
              .preset = {},
              .lower = 0,
              .upper = 1.2,
              .meaning = "ridge angle: tilt of the long facets, towards the tangent turned by 90 degrees"},
             {.name = "alpha_u",
              .unit = "1",
              .preset = 0.1,
              .lower = min_alpha,
              .upper = max_alpha,
              .meaning = "Beckmann roughness of the facets along the ridges"},
             {.name = "alpha_v",
              .unit = "1",
              .preset = 0.1,
              .lower = min_alpha,
              .upper = max_alpha,
              .meaning = "Beckmann roughness of the facets across the ridges"}},
            {{.name = "azimuth_rad",
              .unit = "rad",
              .preset = 0,
              .lower = -pi,
              .upper = pi,
              .meaning = "turns the ridges about the normal; at 0 they run along the tangent"}}),
    };
    return info;
  }

  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Ridges ridges = ridges_of(values);
    const Vec3 wof = ridges.to_facet(wo), wif = ridges.to_facet(wi);
    if (wof.z <= 0 || wif.z <= 0) return {};
    return material_of(values).reflects(dot(wof, half_vector(wof, wif))) * ridges.lobe(wo, wi, wof, wif);
  }

  // The facet's material by its three numbers per band, its geometry by the others.
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    std::fill_n(slopes.begin(), azimuth_index + 1, Rgb{});
    if (wo.z <= 0 || wi.z <= 0) return {};
    const Dual<4> lobe = lobe_with_slopes(values, wo, wi);
    const double cosine = half_cosine(wo, wi);
    Rgb value;
    const auto at = [](Vec3& v, int c) -> double& { return c == 0 ? v.x : c == 1 ? v.y : v.z; };
    for (int c = 0; c < 3; ++c) {
      using T = Dual<3>;
      const T mirrored =
                  fresnel_metal(cosine, T::unknown(values.rgb(eta_index)[c], 0), T::unknown(values.rgb(k_index)[c], 1)),
              f = mirrored + (1 - mirrored) * (1 - mirrored) * T::unknown(values.rgb(rho_index)[c], 2) / pi;
      at(value, c) = f.v * lobe.v;
      for (std::size_t i = 0; i < 3; ++i) at(slopes[eta_index + i], c) = f.d[i] * lobe.v;
      for (std::size_t i = 0; i < 3; ++i) at(slopes[ridge_index + i], c) = f.v * lobe.d[i];
      at(slopes[azimuth_index], c) = f.v * lobe.d[3];
    }
    return value;
  }

  Sample sample(const Values& values, Vec3 wo, Vec2 u, double /*u_lobe*/) const override {
    if (wo.z <= 0) return {};
    const Ridges ridges = ridges_of(values);
    const Vec3 wof = ridges.to_facet(wo);
    if (wof.z <= 0) return {};
    const Vec3 wi = ridges.from_facet(mirrored(wof, ridges.visible_normal(wof, u))), wif = ridges.to_facet(wi);
    if (wi.z <= 0 || wif.z <= 0) return {};
    const double density = ridges.pdf(wof, wif);
    if (!(density > 0)) return {};
    const Rgb f = material_of(values).reflects(dot(wof, half_vector(wof, wif))) * ridges.lobe(wo, wi, wof, wif);
    return {wi, f * (wi.z / density), density};
  }

  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return 0;
    const Ridges ridges = ridges_of(values);
    const Vec3 wof = ridges.to_facet(wo), wif = ridges.to_facet(wi);
    return wof.z > 0 && wif.z > 0 ? ridges.pdf(wof, wif) : 0;
  }

  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    return material_of(values).mueller(dot(wo, half_vector(wo, wi)));
  }

  Rgb albedo(const Values& values, Vec3 wo) const override {
    constexpr int count = 512;
    const auto part = [](double x) { return x - std::floor(x); };
    Rgb sum;
    for (int i = 0; i < count; ++i)  // Roberts 2018, two dimensions
      sum += sample(values, wo, {part(0.5 + i * 0.7548776662466927), part(0.5 + i * 0.5698402909980532)}, 0).weight;
    return sum / count;
  }

 private:
  // Ridges::lobe() by ridge_rad, alpha_u, alpha_v, azimuth_rad.
  static Dual<4> lobe_with_slopes(const Values& values, Vec3 wo, Vec3 wi) {
    using T = Dual<4>;
    const T ridge = T::unknown(values.scalar(ridge_index), 0), alpha_u = T::unknown(values.scalar(alpha_u_index), 1),
            alpha_v = T::unknown(values.scalar(alpha_v_index), 2),
            azimuth = T::unknown(values.scalar(azimuth_index), 3);
    const T tilt = cos(ridge), rise = sin(ridge), ux = cos(azimuth), uy = sin(azimuth);
    const auto to_facet = [&](Vec3 w) {
      const T along = ux * w.y - uy * w.x;
      return Vec3Of<T>{ux * w.x + uy * w.y, tilt * along - rise * w.z, rise * along + tilt * w.z};
    };
    const Vec3Of<T> o = to_facet(wo), i = to_facet(wi);
    if (o.z <= 0.0 || i.z <= 0.0) return T(0);
    const double length = norm(wo + wi);
    const Vec3Of<T> h{(o.x + i.x) / length, (o.y + i.y) / length, (o.z + i.z) / length};
    const T ao = o.z / wo.z, ai = i.z / wi.z;
    const FacetForm<Slopes::beckmann, 4> facets({sqrt(alpha_u * alpha_v), 0.5 * log(alpha_u / alpha_v), T(0)});
    return std::min({ao * ai * tilt, ao, ai}) * facets.reflection(o, i, h);
  }
};

}  // namespace

const Model& ridged() {
  static const Ridged model;
  return model;
}

}  // namespace gonio::surface
