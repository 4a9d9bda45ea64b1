// Parallel micro-ridges, as milled into moulds to make a surface change its brightness when it is turned.
//   f = (F(wi.h) + (1 - F(wi.h))^2 rho_d / pi) cos(theta_r) G Gs D_m(h) / (4 (wi.n) (wo.n))
// Luongo et al. 2017, "Modeling the anisotropic reflectance of a surface with microstructure engineered to obtain
// visible contrast after rotation", equations 2 to 6, with the masking G and the density of normals of
// surface/ridges.h, where it is said how and why they differ from the published ones. F is Fresnel's factor for the
// complex index eta + i k. The second term stands for light that entered and came back: as published, it leaves about
// the mirror direction, like the first, and carries at most rho_d / pi of what entered. h is the half vector.
// To it comes the share `walls` of what walls, as rough and of the same material, reflect by themselves and with a
// facet (surface/ridge_walls.h); at 0, as published, they swallow what they meet. Residue may cover a share of all
// (surface/residue.h). Reciprocal; reflects at most what arrives. albedo() is a sum over 512 samples. mueller() is that
// of one reflection.
#include <optional>

#include "surface/facet_slopes.h"
#include "surface/interface_albedo.h"
#include "surface/residue.h"
#include "surface/ridge_facets.h"
#include "surface/ridge_walls.h"
#include "surface/ridges.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

enum : std::size_t {
  ridge_index,
  alpha_u_index,
  alpha_v_index,
  eta_index,
  k_index,
  rho_index,
  azimuth_index,
  walls_index,
  residue_index,
  residue_alpha_index,
  parameter_count
};

Ridges ridges_of(const Values& values) {
  return {values.scalar(ridge_index), values.scalar(alpha_u_index), values.scalar(alpha_v_index),
          values.scalar(azimuth_index)};
}

// The same flanks, seen as a saw of walls.
Ridges walls_of(const Values& values) {
  return {pi / 2 - values.scalar(ridge_index), values.scalar(alpha_u_index), values.scalar(alpha_v_index),
          values.scalar(azimuth_index) + pi};
}
// Wide enough for two reflections, each of which spreads light.
Ridges wide_ridges_of(const Values& values) {
  return {values.scalar(ridge_index), std::sqrt(2) * values.scalar(alpha_u_index),
          std::sqrt(2) * values.scalar(alpha_v_index), values.scalar(azimuth_index)};
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
        .parameters = with_residue(with_facet_material(
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
              .meaning = "turns the ridges about the normal; at 0 they run along the tangent"},
             {.name = "walls",
              .unit = "1",
              .preset = 0,
              .lower = 0,
              .upper = 1,
              .meaning = "what the walls reflect, as a share of what facets would: 0 leaves them out"}})),
    };
    return info;
  }

  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return {};
    return Residue(values, residue_index).over(relief(values, wo, wi), material_of(values), wo, wi);
  }

  // Ridges alone.
  static Rgb relief(const Values& values, Vec3 wo, Vec3 wi) {
    const FacetMaterial material = material_of(values);
    double once = lobe(ridges_of(values), wo, wi);
    const double share = values.scalar(walls_index);
    if (!(share > 0)) return once > 0 ? material.reflects(half_cosine(wo, wi)) * once : Rgb{};
    once += share * lobe(walls_of(values), wo, wi);
    Rgb f = material.reflects(half_cosine(wo, wi)) * once;
    const Ridges ridges = ridges_of(values);
    const SawFlanks<double> saw{std::cos(values.scalar(ridge_index)), std::sin(values.scalar(ridge_index)),
                                values.scalar(alpha_u_index), values.scalar(alpha_v_index)};
    const Vec3 o = ridges.to_facet(wo), i = ridges.to_facet(wi);
    for (const bool back : {false, true}) {
      const auto two = facet_then_wall(saw, of(back ? o : i), of(back ? i : o));
      if (two.amount > 0)
        f += material.reflects(two.facet_cosine) * material.reflects(two.wall_cosine) *
             (share * two.amount / (wo.z * wi.z));
    }
    return f;
  }

  // The facet's material by its three numbers per band, its geometry by the others.
  Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const override {
    std::fill_n(slopes.begin(), parameter_count, Rgb{});
    if (wo.z <= 0 || wi.z <= 0) return {};
    const double share = values.scalar(walls_index), cosine = half_cosine(wo, wi);
    const Shape facet = shape_of(values, 0), wall = shape_of(values, 1);
    Rgb value;
    add({1, 0}, lobe_with_slopes(facet, wo, wi), Geometry(cosine), {}, values, value, slopes);
    add({share, 1}, lobe_with_slopes(wall, wo, wi), Geometry(cosine), {}, values, value, slopes);
    const SawFlanks<Geometry> saw{facet.tilt, facet.rise, facet.alpha_u, facet.alpha_v};
    const Vec3Of<Geometry> o = facet.to_facet(wo), i = facet.to_facet(wi);
    for (const bool back : {false, true}) {
      const auto two = facet_then_wall(saw, back ? o : i, back ? i : o);
      if (two.amount.v > 0)
        add({share, 1}, two.amount / (wo.z * wi.z), two.facet_cosine, two.wall_cosine, values, value, slopes);
    }
    cover(values, wo, wi, value, slopes);
    return value;
  }

  // Without walls by visible normals alone; else normals of facets, of walls, of facets twice as rough (by
  // variance) whose mirrored light a smooth wall turns over, and the cosine for what these miss.
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const Vec3 wi = Residue(values, residue_index).direction(wo, u, u_lobe, [&](double which) {
      return drawn_by_relief(values, wo, u, which);
    });
    if (wi.z <= 0) return {};
    const double density = pdf(values, wo, wi);
    if (!(density > 0)) return {};
    return {wi, evaluate(values, wo, wi) * (wi.z / density), density};
  }

  static Vec3 drawn_by_relief(const Values& values, Vec3 wo, Vec2 u, double u_lobe) {
    const Chances chance = chances(values, wo);
    const auto drawn = [&](const Ridges& saw, double turn) {
      const Vec3 o = saw.to_facet(wo), w = mirrored(o, saw.visible_normal(o, u));
      return w.z > 0 ? saw.from_facet({w.x, turn * w.y, w.z}) : Vec3{0, 0, 0};
    };
    Vec3 wi{0, 0, 0};
    if (u_lobe < chance.facet) {
      wi = drawn(ridges_of(values), 1);
    } else if (u_lobe < chance.facet + chance.wall) {
      wi = drawn(walls_of(values), 1);
    } else if (u_lobe < chance.facet + chance.wall + chance.both) {
      wi = drawn(wide_ridges_of(values), -1);
    } else if (chance.any > 0) {
      const double r = std::sqrt(u.x), phi = 2 * pi * u.y;
      wi = {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0, 1 - u.x))};
    }
    return wi;
  }

  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override {
    if (wo.z <= 0 || wi.z <= 0) return 0;
    const Chances chance = chances(values, wo);
    const auto density = [&](const Ridges& saw, double turn) {
      const Vec3 o = saw.to_facet(wo), i = saw.to_facet(wi);
      return o.z > 0 && i.z > 0 ? saw.pdf(o, {i.x, turn * i.y, i.z}) : 0;
    };
    double sum = chance.any * wi.z / pi;
    if (chance.facet > 0) sum += chance.facet * density(ridges_of(values), 1);
    if (chance.wall > 0) sum += chance.wall * density(walls_of(values), 1);
    if (chance.both > 0) sum += chance.both * density(wide_ridges_of(values), -1);
    return Residue(values, residue_index).pdf(sum, wo, wi);
  }

  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override {
    return material_of(values).mueller(dot(wo, half_vector(wo, wi)));
  }

  Rgb albedo(const Values& values, Vec3 wo) const override {
    constexpr int count = 512;
    const auto part = [](double x) { return x - std::floor(x); };
    Rgb sum;
    for (int i = 0; i < count; ++i)  // Roberts 2018, two dimensions
      sum += sample(values, wo, {part(0.5 + i * 0.7548776662466927), part(0.5 + i * 0.5698402909980532)},
                    part(0.5 + i * 0.6180339887498949))
                 .weight;
    sum = sum / count;
    return {std::min(1.0, sum.x), std::min(1.0, sum.y), std::min(1.0, sum.z)};
  }

 private:
  using Geometry = Dual<4>;  // by ridge_rad, alpha_u, alpha_v, azimuth_rad

  static Vec3Of<double> of(Vec3 w) { return {w.x, w.y, w.z}; }
  static double lobe(const Ridges& saw, Vec3 wo, Vec3 wi) {
    const Vec3 o = saw.to_facet(wo), i = saw.to_facet(wi);
    return o.z > 0 && i.z > 0 ? saw.lobe(wo, wi, o, i) : 0;
  }

  struct Chances {
    double facet = 0, wall = 0, both = 0, any = 0;
  };
  static Chances chances(const Values& values, Vec3 wo) {
    const bool facet = ridges_of(values).to_facet(wo).z > 0, wall = walls_of(values).to_facet(wo).z > 0;
    if (!(values.scalar(walls_index) > 0)) return {facet ? 1.0 : 0.0, 0, 0, 0};
    if (!facet) return {0, 0.6, 0, 0.4};
    // Of what is seen, the share that walls are.
    const double walls = wall ? std::sin(values.scalar(ridge_index)) * walls_of(values).to_facet(wo).z / wo.z : 0;
    return {0.9 - 0.7 * walls, 0.2 * walls, 0.05 + 0.45 * walls, 0.05 + 0.05 * walls};
  }

  struct Shape {
    Geometry tilt, rise, ux, uy, alpha_u, alpha_v;
    Vec3Of<Geometry> to_facet(Vec3 w) const {
      const Geometry along = ux * w.y - uy * w.x;
      return {ux * w.x + uy * w.y, tilt * along - rise * w.z, rise * along + tilt * w.z};
    }
  };
  // 0: facets; 1: walls.
  static Shape shape_of(const Values& values, int flank) {
    const Geometry ridge = Geometry::unknown(values.scalar(ridge_index), 0),
                   azimuth = Geometry::unknown(values.scalar(azimuth_index), 3),
                   lean = flank == 0 ? ridge : pi / 2 - ridge, turn = flank == 0 ? azimuth : azimuth + pi;
    return {cos(lean),
            sin(lean),
            cos(turn),
            sin(turn),
            Geometry::unknown(values.scalar(alpha_u_index), 1),
            Geometry::unknown(values.scalar(alpha_v_index), 2)};
  }

  // Ridges::lobe().
  static Geometry lobe_with_slopes(const Shape& shape, Vec3 wo, Vec3 wi) {
    using T = Geometry;
    const Vec3Of<T> o = shape.to_facet(wo), i = shape.to_facet(wi);
    if (o.z <= 0.0 || i.z <= 0.0) return T(0);
    const double length = norm(wo + wi);
    const Vec3Of<T> h{(o.x + i.x) / length, (o.y + i.y) / length, (o.z + i.z) / length};
    const T ao = o.z / wo.z, ai = i.z / wi.z;
    const FacetForm<Slopes::beckmann, 4> facets(
        {sqrt(shape.alpha_u * shape.alpha_v), 0.5 * log(shape.alpha_u / shape.alpha_v), T(0)});
    return std::min({ao * ai * shape.tilt, ao, ai}) * facets.reflection(o, i, h);
  }

  // FacetMaterial::reflects() by eta, k, rho_d, and its slope by the cosine.
  struct Reflects {
    Dual<3> of;
    double by_cosine = 0;
  };
  static Reflects reflects(const Values& values, int c, double cosine, bool moves) {
    using T = Dual<3>;
    const auto at = [&](double x) {
      const T mirrored =
          fresnel_metal(x, T::unknown(values.rgb(eta_index)[c], 0), T::unknown(values.rgb(k_index)[c], 1));
      return mirrored + (1 - mirrored) * (1 - mirrored) * T::unknown(values.rgb(rho_index)[c], 2) / pi;
    };
    constexpr double step = 1e-5;
    return {at(cosine), moves ? (at(std::min(1.0, cosine + step)).v - at(cosine - step).v) /
                                    (std::min(1.0, cosine + step) - cosine + step)
                              : 0};
  }

  struct Share {
    double of = 1, slope = 0;  // by `walls`
  };
  // Adds share * amount F(first) F(second).
  static void add(const Share& share, const Geometry& amount, const Geometry& first,
                  const std::optional<Geometry>& second, const Values& values, Rgb& value, std::span<Rgb> slopes) {
    if (!(amount.v > 0)) return;
    const auto at = [](Vec3& v, int c) -> double& { return c == 0 ? v.x : c == 1 ? v.y : v.z; };
    for (int c = 0; c < 3; ++c) {
      const Reflects a = reflects(values, c, first.v, second.has_value()),
                     b = second ? reflects(values, c, second->v, true) : Reflects{Dual<3>(1), 0};
      const Dual<3> f = a.of * b.of;
      at(value, c) += share.of * f.v * amount.v;
      for (std::size_t i = 0; i < 3; ++i) at(slopes[eta_index + i], c) += share.of * f.d[i] * amount.v;
      for (std::size_t i = 0; i < 4; ++i) {
        double slope = f.v * amount.d[i];
        if (second) slope += amount.v * (a.by_cosine * b.of.v * first.d[i] + a.of.v * b.by_cosine * second->d[i]);
        at(slopes[i < 3 ? ridge_index + i : azimuth_index], c) += share.of * slope;
      }
      at(slopes[walls_index], c) += share.slope * f.v * amount.v;
    }
  }

  // Residue::over().
  static void cover(const Values& values, Vec3 wo, Vec3 wi, Rgb& value, std::span<Rgb> slopes) {
    const double share = values.scalar(residue_index);
    const Dual<1> lumps =
        GgxOf<Dual<1>>(Dual<1>::unknown(values.scalar(residue_alpha_index), 0)).lobe(wo, wi, half_vector(wo, wi));
    for (std::size_t i = 0; i < residue_index; ++i) slopes[i] = slopes[i] * (1 - share);
    for (int c = 0; c < 3; ++c) {
      const Dual<3> f = reflects(values, c, half_cosine(wo, wi), false).of;
      const auto at = [c](Rgb& v) -> double& { return c == 0 ? v.x : c == 1 ? v.y : v.z; };
      for (std::size_t i = 0; i < 3; ++i) at(slopes[eta_index + i]) += share * f.d[i] * lumps.v;
      at(slopes[residue_index]) = f.v * lumps.v - at(value);
      at(slopes[residue_alpha_index]) = share * f.v * lumps.d[0];
      at(value) += share * at(slopes[residue_index]);
    }
  }
};

}  // namespace

const Model& ridged() {
  static const Ridged model;
  return model;
}

}  // namespace gonio::surface
