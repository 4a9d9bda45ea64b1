// The ridged model against rays through actual ridges: a saw's profile, extruded, whose facets carry Beckmann normals.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "cases.h"
#include "chi_square.h"
#include "surface/ridges.h"

namespace gonio::tests {
namespace {

// In the plane of v and n, period 1, crests at (k, 0): facets fall along (c, -s) for a length c, walls rise along (s,
// c) for a length s.
struct Saw {
  explicit Saw(double ridge_rad) : c(std::cos(ridge_rad)), s(std::sin(ridge_rad)) {}
  struct Hit {
    Vec2 at;
    bool facet;
  };
  // First meeting of the ray, starting at or below the crests; nothing: it leaves.
  std::optional<Hit> first(Vec2 from, Vec2 d) const {
    const double to_exit = d.y > 0 ? -from.y / d.y : 2 / std::max(1e-9, std::abs(d.y));
    const double end = from.x + d.x * to_exit;
    const int low = static_cast<int>(std::floor(std::max(std::min(from.x, end), from.x - 1000))) - 1;
    const int high = static_cast<int>(std::floor(std::min(std::max(from.x, end), from.x + 1000))) + 1;
    std::optional<Hit> best;
    double nearest = 1e300;
    for (int k = low; k <= high; ++k)
      for (const bool facet : {true, false}) {
        const Vec2 a = facet ? Vec2{static_cast<double>(k), 0} : Vec2{k + c * c, -c * s};
        const Vec2 e = facet ? Vec2{c * c, -c * s} : Vec2{s * s, c * s};
        const double det = d.x * e.y - d.y * e.x;
        if (std::abs(det) < 1e-15) continue;
        const Vec2 g = a - from;
        const double t = (g.x * e.y - g.y * e.x) / det, w = (g.x * d.y - g.y * d.x) / det;
        if (t > 1e-9 && t < nearest && w >= 0 && w <= 1) {
          nearest = t;
          best = Hit{from + d * t, facet};
        }
      }
    return best;
  }
  double c, s;
};

struct Surface {
  double ridge_rad, alpha_u, alpha_v;
};

// A facet's normal that `wo` sees, in the facet's frame: slopes drawn by Beckmann's law, kept by the area that they
// show.
Vec3 seen_normal(const Surface& surface, Vec3 wo, Random& random) {
  const double most = wo.z + 4 * std::hypot(surface.alpha_u * wo.x, surface.alpha_v * wo.y);
  while (true) {
    const double x = surface.alpha_u * random.normal() / std::sqrt(2),
                 y = surface.alpha_v * random.normal() / std::sqrt(2);
    if (wo.z - x * wo.x - y * wo.y > most * random.uniform()) return normalized(Vec3{-x, -y, 1});
  }
}

struct Tally {
  std::vector<double> once = std::vector<double>(96), squares = once;  // by direction: facets alone
  std::vector<double> twice = once, twice_squares = once;              // one or two meetings
  double facets = 0, walls = 0, several = 0;  // leaves after one meeting with a facet; with a wall; after more
  double total() const { return facets + walls + several; }
};

std::size_t bin_of(Vec3 w) {
  const auto row = std::min(7, static_cast<int>(w.z * 8));
  const auto column = std::min(11, static_cast<int>((std::atan2(w.y, w.x) / (2 * pi) + 0.5) * 12));
  return static_cast<std::size_t>(row * 12 + column);
}

// Fresnel's mean of both polarizations for a clear material of this index; 1 for index 0, a mirror.
double reflects(double index, double cosine) {
  if (index == 0) return 1;
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (index * index));
  const double s = (cosine - index * inside) / (cosine + index * inside),
               p = (index * cosine - inside) / (index * cosine + inside);
  return (s * s + p * p) / 2;
}

// Light goes backwards, from the eye. Facets and walls are equally rough; the rays know nothing of the model. `masked`:
// what leaves a flank is masked by its own roughness, too, as a flat rough surface has it.
Tally simulated(const Surface& surface, double index, Vec3 wo, int rays, std::uint64_t seed, bool masked = false) {
  const surface::Facets<surface::Slopes::beckmann> flank(
      surface::Roughness{surface.alpha_u, (1 - surface.alpha_v / surface.alpha_u) / 0.9, 0});
  const Saw saw(surface.ridge_rad);
  Tally tally;
  Random random(seed);
  for (int i = 0; i < rays; ++i) {
    Vec2 from{random.uniform(), 0};
    Vec3 out = wo;  // against the path
    double weight = 1;
    bool first_is_facet = false;
    for (int bounce = 0; bounce < 12; ++bounce) {
      const auto hit = saw.first(from, {-out.y, -out.z});
      if (!hit) {
        (bounce > 1 ? tally.several : first_is_facet ? tally.facets : tally.walls) += weight / rays;
        if (bounce == 1 || bounce == 2) {
          tally.twice[bin_of(-out)] += weight / rays;
          tally.twice_squares[bin_of(-out)] += weight * weight / rays;
        }
        if (bounce != 1 || !first_is_facet) break;
        tally.once[bin_of(-out)] += weight / rays;
        tally.squares[bin_of(-out)] += weight * weight / rays;
        break;
      }
      if (bounce == 0) first_is_facet = hit->facet;
      const Vec2 normal = hit->facet ? Vec2{saw.s, saw.c} : Vec2{-saw.c, saw.s};
      const Vec3 m{0, normal.x, normal.y}, along{0, normal.y, -normal.x};
      const Vec3 local{out.x, dot(out, along), dot(out, m)};
      if (local.z <= 0) break;
      const Vec3 h = seen_normal(surface, local, random), w = surface::mirrored(local, h);
      if (w.z <= 0) break;
      weight *= reflects(index, dot(local, h));
      if (masked) weight *= flank.reflection_weight(local, w, flank.area_seen(local));
      from = hit->at;
      out = -(Vec3{w.x, 0, 0} + along * w.y + m * w.z);
    }
  }
  return tally;
}

// Index 0 stands for a mirror: eta 0.01, k 30 reflects 0.9999 at all angles.
surface::Values values_of(const Surface& s, double index = 0) {
  surface::Values values;
  const std::vector<double> amounts = {s.ridge_rad,          s.alpha_u, s.alpha_v, index > 0 ? index : 0.01,
                                       index > 0 ? 0.0 : 30, 0,         0};
  for (std::size_t i = 0; i < amounts.size(); ++i) values.v[i] = {amounts[i], amounts[i], amounts[i]};
  return values;
}

// Equations 1 to 4 as they were published, for a perfect mirror.
double published(const Surface& s, Vec3 wo, Vec3 wi) {
  const surface::Ridges ridges(s.ridge_rad, s.alpha_u, s.alpha_v, 0);
  const auto g1 = [&](Vec3 w) {
    const Vec3 f = ridges.to_facet(w);
    return f.z > 0 ? 1 - std::min(1.0, std::abs(std::tan(s.ridge_rad) * f.y / f.z)) : 0;
  };
  const Vec3 h = ridges.to_facet(surface::half_vector(wo, wi));
  if (h.z <= 0) return 0;
  const double a = h.x / (h.z * s.alpha_u), b = h.y / (h.z * s.alpha_v);
  return g1(wo) * g1(wi) * std::exp(-a * a - b * b) / (pi * s.alpha_u * s.alpha_v * std::pow(h.z, 4) * 4 * wo.z * wi.z);
}

double published_total(const Surface& s, const surface::Values& values, Vec3 wo, int rays) {
  const surface::Model& model = *surface::find("ridged");
  Random random(7);
  double sum = 0;
  for (int i = 0; i < rays; ++i) {
    const auto sample = model.sample(values, wo, {random.uniform(), random.uniform()}, 0);
    if (!(sample.pdf > 0)) continue;
    const double fresnel =
        reflects(values.v[3].x < 1 ? 0 : values.v[3].x, dot(wo, surface::half_vector(wo, sample.wi)));
    sum += fresnel * published(s, wo, sample.wi) * sample.wi.z / sample.pdf / rays;
  }
  return sum;
}

Vec3 tilted(double degrees, double out_of_plane = 0) {  // towards v where positive
  const double t = degrees * pi / 180;
  return normalized(Vec3{out_of_plane, std::sin(t), std::cos(t)});
}

struct Sampled {
  std::vector<double> sum = std::vector<double>(96), squares = sum;
  double total = 0;
};

Sampled sampled(const surface::Values& values, Vec3 wo, int rays, std::uint64_t seed) {
  const surface::Model& model = *surface::find("ridged");
  Sampled all;
  Random random(seed);
  for (int i = 0; i < rays; ++i) {
    const Vec2 u{random.uniform(), random.uniform()};
    const auto sample = model.sample(values, wo, u, random.uniform());
    if (!(sample.pdf > 0)) continue;
    all.sum[bin_of(sample.wi)] += sample.weight.x / rays;
    all.squares[bin_of(sample.wi)] += sample.weight.x * sample.weight.x / rays;
    all.total += sample.weight.x / rays;
  }
  return all;
}

// Light that meets one facet alone, by direction: rays through ridges and the model's sampler agree within their noise
// (chi-square over 96 bins of direction, Sidak-corrected; false alarms of the family: 1e-3), and in all within 0.01,
// which is three standard deviations.
TEST(Ridged, AgreesWithActualRidges) {
  constexpr int rays = 40000;
  std::uint64_t seed = 500;
  std::vector<std::pair<std::string, double>> p;
  for (const double index : {0.0, 1.5})
    for (const Surface s : {Surface{0.17, 0.05, 0.05}, Surface{0.35, 0.1, 0.05}, Surface{0.6, 0.08, 0.12}})
      for (const Vec3 wo : {tilted(-50), tilted(-20, 0.4), tilted(0), tilted(30), tilted(60, 0.5)}) {
        const Tally actual = simulated(s, index, wo, rays, ++seed);
        const surface::Values values = values_of(s, index);
        const Sampled model = sampled(values, wo, rays, ++seed);
        double chi2 = 0, bins = 0;
        for (std::size_t b = 0; b < 96; ++b) {
          const double rms = std::sqrt(actual.squares[b]);
          if (!(actual.once[b] * actual.once[b] * rays > 10 * rms * rms)) continue;  // fewer than ten rays
          const double variance =
              (actual.squares[b] - actual.once[b] * actual.once[b] + model.squares[b] - model.sum[b] * model.sum[b]) /
              rays;
          chi2 += (actual.once[b] - model.sum[b]) * (actual.once[b] - model.sum[b]) / variance;
          ++bins;
        }
        const std::string name = "index " + std::to_string(index) + ", ridges of " + std::to_string(s.ridge_rad) +
                                 " seen from y = " + std::to_string(wo.y);
        p.emplace_back(name, chi_square_tail(chi2, bins));
        EXPECT_NEAR(model.total, actual.facets, 0.01) << name;
        EXPECT_NEAR(mean(surface::find("ridged")->albedo(values, wo)), model.total, 0.01) << name;
      }
  for (const auto& [name, value] : p) EXPECT_GT(value, 1 - std::pow(1 - 1e-3, 1.0 / p.size())) << name;
}

// With walls: light that meets one flank or two, by direction. What three standard deviations of a bin do not explain
// is less than 1.5 % of all light, over 96 bins; totals agree within four standard deviations and 1.5 %, 6 % where the
// eye is 75 degrees away from v.
TEST(Ridged, WallsAgreeWithActualRidges) {
  constexpr int rays = 16000;
  std::uint64_t seed = 2500;
  for (const double index : {0.0, 1.5})
    for (const Surface s :
         {Surface{0.1, 0.2, 0.2}, Surface{0.17, 0.1, 0.1}, Surface{0.35, 0.15, 0.1}, Surface{0.6, 0.08, 0.12}})
      for (const Vec3 wo : {tilted(-75), tilted(-50), tilted(-20, 0.4), tilted(0), tilted(60, 0.5)}) {
        const Tally actual = simulated(s, index, wo, rays, ++seed, true);
        surface::Values values = values_of(s, index);
        values.v[7] = {1, 1, 1};
        const Sampled model = sampled(values, wo, rays, ++seed);
        double beyond = 0, two = 0, squares = 0;
        for (std::size_t b = 0; b < 96; ++b) {
          const double variance = (actual.twice_squares[b] - actual.twice[b] * actual.twice[b] + model.squares[b] -
                                   model.sum[b] * model.sum[b]) /
                                  rays;
          beyond += std::max(0.0, std::abs(actual.twice[b] - model.sum[b]) - 3 * std::sqrt(variance));
          two += actual.twice[b];
          squares += actual.twice_squares[b] + model.squares[b];
        }
        const std::string name = "index " + std::to_string(index) + ", ridges of " + std::to_string(s.ridge_rad) +
                                 " seen from y = " + std::to_string(wo.y);
        std::printf("%s: all %.4f, one or two %.4f, facets alone %.4f, model %.4f, beyond noise %.4f\n", name.c_str(),
                    actual.total(), two, actual.facets, model.total, beyond);
        EXPECT_LT(beyond, 0.015 * actual.total()) << name;
        const double deviation = std::sqrt((squares - two * two - model.total * model.total) / rays);
        EXPECT_NEAR(model.total, two, (wo.y < -0.9 ? 0.06 : 0.015) * two + 4 * deviation) << name;
      }
}

// The figures are printed: light by one facet (rays, model, published equations), by one wall and by several
// reflections, which the model leaves out. It falls short of all light by these two alone: towards v nothing but what
// ridges' roughness hides, away from v the walls' share, which grows until no facet is seen at 90 degrees - theta_r.
TEST(Ridged, WhatIsLeftOutIsWhatWallsReflect) {
  constexpr int rays = 12000;
  double worst_published = 0;
  for (const double index : {0.0, 1.5})
    for (const double ridge : {10.0, 20.0, 35.0}) {
      const Surface s{ridge * pi / 180, 0.05, 0.05};
      const surface::Values values = values_of(s, index);
      std::printf("index %.1f, ridges of %.0f deg: facet once (rays, model, published), wall once, several\n", index,
                  ridge);
      for (const double degrees : {-75, -60, -40, -20, 0, 20, 40, 60, 75}) {
        const Vec3 wo = tilted(degrees);
        const Tally actual = simulated(s, index, wo, rays, 900);
        const double ours = sampled(values, wo, rays, 7).total;
        const double theirs = published_total(s, values, wo, rays);
        std::printf("%5.0f deg  %.4f %.4f %.4f  %.4f %.4f\n", degrees, actual.facets, ours, theirs, actual.walls,
                    actual.several);
        EXPECT_NEAR(ours, actual.facets, index == 0 ? 0.026 : 0.0026) << ridge << " " << degrees;  // four deviations
        EXPECT_LE(actual.total(), 1 + 1e-12);
        if (index == 0 && degrees >= 2 * ridge) {
          EXPECT_LT(actual.total() - ours, 0.02) << ridge << " " << degrees;
        }
        if (index == 0 && ours > 0.2) worst_published = std::max(worst_published, std::abs(theirs / ours - 1));
      }
    }
  EXPECT_GT(worst_published, 0.05);  // the published form is another one
}

// The subsurface term adds (1 - F)^2 rho_d / pi to F, and nothing else.
TEST(Ridged, LightFromBeneathFollowsItsFormula) {
  const surface::Model& model = *surface::find("ridged");
  const Surface s{0.3, 0.1, 0.2};
  surface::Values bare = values_of(s, 1.5), full = bare;
  full.v[5] = {0.8, 0.4, 0};
  Random random(13);
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 wo = at_zenith(85 * random.uniform(), 6 * random.uniform()),
               wi = at_zenith(85 * random.uniform(), 6 * random.uniform());
    const double f = reflects(1.5, dot(wo, surface::half_vector(wo, wi)));
    const Rgb without = model.evaluate(bare, wo, wi), with = model.evaluate(full, wo, wi);
    if (!(without.x > 1e-6)) continue;
    ASSERT_NEAR(with.x / without.x, 1 + (1 - f) * (1 - f) * 0.8 / (pi * f), 1e-9);
    ASSERT_NEAR(with.y / without.y, 1 + (1 - f) * (1 - f) * 0.4 / (pi * f), 1e-9);
    ASSERT_EQ(with.z, without.z);
    ++seen;
  }
  EXPECT_GT(seen, 200);
}

// A clear facet at Brewster's angle lets nothing through that is polarized in the plane of incidence; light from
// beneath the facets is not polarized.
TEST(Ridged, FacetsPolarize) {
  const surface::Model& model = *surface::find("ridged");
  surface::Values values = values_of({0.2, 0.1, 0.1}, 1.5);
  const double brewster = std::atan(1.5);
  const Vec3 wo{std::sin(brewster), 0, std::cos(brewster)}, wi{-wo.x, 0, wo.z};
  const auto clear = model.mueller(values, wo, wi)[0];
  EXPECT_NEAR(clear(1, 0), 1, 1e-9);
  values.v[5] = {1, 1, 1};
  const double f = reflects(1.5, wo.z);
  EXPECT_NEAR(model.mueller(values, wo, wi)[0](1, 0), f / (f + (1 - f) * (1 - f) / pi), 1e-9);
}

TEST(Ridged, WithoutRidgesIsAFlatRoughSurface) {
  const surface::Model& model = *surface::find("ridged");
  const surface::Values values = values_of({0, 0.2, 0.2});
  const surface::Facets<surface::Slopes::beckmann> flat(surface::Roughness{0.2, 0, 0});
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 wo = at_zenith(85 * random.uniform()), wi = at_zenith(85 * random.uniform(), 6 * random.uniform());
    const Vec3 h = surface::half_vector(wo, wi);
    const double expected = flat.reflection(wo, wi, h, flat.area_seen(wo));
    ASSERT_NEAR(model.evaluate(values, wo, wi).x, expected, 1e-3 * expected);
  }
}

// Turning the surface is turning the directions.
TEST(Ridged, AzimuthTurnsTheRidges) {
  const surface::Model& model = *surface::find("ridged");
  surface::Values values = values_of({0.3, 0.1, 0.2}), turned = values;
  turned.v[6] = {0.8, 0.8, 0.8};
  Random random(12);
  for (int i = 0; i < 500; ++i) {
    const double a = 80 * random.uniform(), b = 80 * random.uniform(), p = 6 * random.uniform(),
                 q = 6 * random.uniform();
    const Rgb plain = model.evaluate(values, at_zenith(a, p), at_zenith(b, q));
    const Rgb other = model.evaluate(turned, at_zenith(a, p + 0.8), at_zenith(b, q + 0.8));
    ASSERT_NEAR(plain.x, other.x, 1e-9 * (1 + plain.x));
  }
}

}  // namespace
}  // namespace gonio::tests
