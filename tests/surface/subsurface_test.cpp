// Diffusion models of light beneath surfaces: against their own closed forms, and against photons.
#include <gtest/gtest.h>

#include <algorithm>

#include "cases.h"
#include "subsurface_half_space.h"

namespace gonio::tests {
namespace {

using surface::InteriorFresnel;

// The fits of d'Eon & Irving 2011 to the moments of Fresnel's equations within the medium, 2 C_1 and 3 C_2.
TEST(Subsurface, FresnelMomentsAreThoseOfThePublishedFits) {
  for (const double eta : {1.1, 1.3, 1.5, 1.8, 2.0}) {
    const InteriorFresnel moments(eta);
    const double e2 = eta * eta, e3 = e2 * eta, e4 = e3 * eta, e5 = e4 * eta;
    const double first = -9.23372 + 22.2272 * eta - 20.9292 * e2 + 10.2291 * e3 - 2.54396 * e4 + 0.254913 * e5;
    const double second = -1641.1 + 135.926 / e3 - 656.175 / e2 + 1376.53 / eta + 1213.67 * eta - 568.556 * e2 +
                          164.798 * e3 - 27.0181 * e4 + 1.91826 * e5;
    EXPECT_NEAR(1 - 4 * moments.c_phi, first, 5e-3) << eta;
    EXPECT_NEAR(1 - 2 * moments.c_e, second, 5e-3) << eta;
  }
}

// By a midpoint rule over the interior itself, total reflection included.
TEST(Subsurface, FresnelMomentsByDirectQuadrature) {
  for (const double eta : {1.0, 1.33, 1.5, 2.6}) {
    double first = 0, second = 0;
    constexpr int n = 400000;
    for (int i = 0; i < n; ++i) {
      const double c = (i + 0.5) / n, sine2 = eta * eta * (1 - c * c);
      const double passes = sine2 < 1 ? 1 - surface::fresnel_dielectric(std::sqrt(1 - sine2), eta) : 0;
      first += passes * c / n;
      second += passes * c * c / n;
    }
    EXPECT_NEAR(InteriorFresnel(eta).c_phi, first / 2, 1e-6);
    EXPECT_NEAR(InteriorFresnel(eta).c_e, 1.5 * second, 1e-6);
    EXPECT_NEAR(InteriorFresnel(eta).transmits_in, 4 * eta * eta * InteriorFresnel(eta).c_phi, 1e-12);
  }
}

// What leaves in all directions through the interface is Jensen's R_d(r), digit by digit.
TEST(Dipole, RadialProfileIsItsFormula) {
  for (const HalfSpace m : {HalfSpace{30, 1000, 0, 1.5}, HalfSpace{0, 500, 0.7, 1.3}, HalfSpace{400, 300, -0.3, 1.0}}) {
    const Built dipole("dipole", m);
    const double scattered = m.sigma_s * (1 - m.g), total = scattered + m.sigma_a, d = 1 / (3 * total);
    const double s = std::sqrt(3 * m.sigma_a * total), inside = 1 - 4 * InteriorFresnel(m.eta).c_phi;
    const double zr = 1 / total, zv = zr + 4 * d * (1 + inside) / (1 - inside);
    double leaves = 0;  // integral of T cos over the hemisphere
    for (const auto& [c, weight] : surface::gauss_legendre(60))
      leaves += 2 * pi * weight * c * (1 - surface::fresnel_dielectric(c, m.eta));
    for (const double r : {0.0, 1e-4, 1e-3, 5e-3, 2e-2}) {
      const double dr = std::hypot(r, zr), dv = std::hypot(r, zv);
      const double expected = scattered / total / (4 * pi) *
                              (zr * (1 + s * dr) * std::exp(-s * dr) / (dr * dr * dr) +
                               zv * (1 + s * dv) * std::exp(-s * dv) / (dv * dv * dv));
      const Rgb found = dipole.beneath().evaluate({{r, 0, 0}, {0, 0, 1}, {0, 0, -1}}, {}, {0, 0, 1}) * leaves;
      EXPECT_NEAR(found.x / expected, 1, 1e-8) << r;
      EXPECT_EQ(found.x, found.z);
    }
  }
}

TEST(Dipole, WholeReflectanceInClosedForm) {
  for (const HalfSpace m : {HalfSpace{30, 1000, 0, 1.5}, HalfSpace{1, 500, 0.7, 1.3}}) {
    const Built dipole("dipole", m);
    double sum = 0;  // in growing rings
    double inner = 0;
    for (double outer = 1e-4; outer < 10; outer *= 1.3) {
      sum += dipole.ring({0, 0, -1}, inner, outer);
      inner = outer;
    }
    EXPECT_NEAR(sum / dipole.beneath().diffuse_reflectance().x, 1, 1e-4);
  }
}

// -D grad fluence and the boundary's combination of both, by differences of the fluence of a ray.
TEST(DirectionalDipole, IsTheExitanceOfARayAndItsMirrorImage) {
  const HalfSpace m{30, 1000, 0.3, 1.4};
  const Built built("directional-dipole", m);
  const InteriorFresnel moments(m.eta);
  const double total = m.sigma_a + m.sigma_s * (1 - m.g), d = 1 / (3 * total), s = std::sqrt(m.sigma_a / d);
  const double de = 2.131 * d / std::sqrt(1 - m.sigma_a / total), a = (1 - moments.c_e) / (2 * moments.c_phi);
  const Vec3 n{0, 0, 1};
  for (const double cosine : {1.0, 0.7, 0.2})
    for (const Vec3 x : {Vec3{3e-3, 1e-3, 0}, Vec3{-2e-3, 2e-3, 0}, Vec3{8e-3, 0, 0}}) {
      const Vec3 w = inwards(cosine, m.eta);
      // The real source's distance is longer than |x|; its direction and projections are not: x and r apart.
      const auto exitance = [&](Vec3 x0, Vec3 w0, double extra) {
        const auto fluence = [&](Vec3 y) {
          const double r = std::sqrt(dot(y, y) + extra);
          return std::exp(-s * r) / (4 * pi * d * r) * (1 + 3 * d * (1 + s * r) / (r * r) * dot(y, w0));
        };
        const double h = 1e-7;
        return moments.c_phi * fluence(x0) - moments.c_e * d * (fluence(x0 + n * h) - fluence(x0 - n * h)) / (2 * h);
      };
      const double mu = -w.z, square = dot(x, x), along = dot(x, w);
      const double extra = d * mu * (d * mu + 2 * de * std::sqrt((square - along * along) / (square + de * de)));
      const Vec3 mirrored{w.x, w.y, -w.z};
      const double expected = exitance(x, w, extra) - exitance(x - n * (2 * a * de), mirrored, 0);
      EXPECT_NEAR(built.exitance(w, x) / expected, 1, 1e-5) << cosine << " " << x.x;
    }
}

TEST(DirectionalDipole, NeverSendsOutMoreThanEnters) {
  for (const double eta : {1.0, 1.3, 2.0})
    for (const double absorbs : {0.0, 1.0, 100.0}) {
      const Built built("directional-dipole", {absorbs, 1000, 0.2, eta}, 0.2);
      EXPECT_LE(built.beneath().diffuse_reflectance().x, 1);
      EXPECT_LE(built.model->albedo(built.values, at_zenith(60)).x, 1 + 1e-12);
    }
}

// Kolmogorov & Smirnov's distance of drawn distances from the integral of the density: below 1.95 / sqrt(n) but for
// 1e-3 of all seeds; here with a fixed seed.
TEST(Subsurface, DistancesAreDrawnFromTheirDensity) {
  for (const char* id : {"dipole", "directional-dipole"})
    for (const double absorbs : {0.0, 50.0, 5000.0}) {
      const Built built(id, {absorbs, 1000, 0, 1.4});
      const surface::Subsurface& beneath = built.beneath();
      Random random(17);
      std::vector<double> drawn(20000);
      for (double& r : drawn) r = beneath.sample_distance(1, random.uniform());
      std::sort(drawn.begin(), drawn.end());
      double mass = 0, last = 0, worst = 0;
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        const auto f = [&](double r) { return 2 * pi * r * beneath.distance_density(1, r); };
        const double r = drawn[i], h = r - last;
        mass += h / 6 * (f(last) + 4 * f(last + h / 2) + f(r));
        last = r;
        worst = std::max(worst, std::abs(mass - (i + 0.5) / drawn.size()));
      }
      EXPECT_LT(worst, 1.95 / std::sqrt(20000.0)) << id << " " << absorbs;
      EXPECT_LE(drawn.back(), beneath.reach_m());
      EXPECT_EQ(beneath.distance_density(1, beneath.reach_m() * 1.001), 0);
    }
}

// Facets pass, on average, what the tables of reflectance leave over: 2e-3 is their error.
TEST(Subsurface, RoughInterfacesPassWhatTheyDoNotReflect) {
  for (const double alpha : {0.0, 0.05, 0.4, 1.0})
    for (const double zenith : {0.0, 50.0, 80.0}) {
      const surface::DipoleInterface interface(1.5, alpha);
      const Vec3 wi = at_zenith(zenith);
      double sum = 0;
      constexpr int n = 200;
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
          const double v = (i + 0.5) / n;  // fine towards the far slopes
          const auto in = interface.enter(wi, {1 - v * v * v, (k + 0.5) / n});
          sum += in.share * 3 * v * v / (n * n);
          ASSERT_LT(in.onwards.z, 0.5);
          ASSERT_NEAR(norm(in.onwards), 1, 1e-12);
        }
      EXPECT_NEAR(sum, 1 - interface.reflects(wi.z), 2e-3) << alpha << " " << zenith;
    }
}

TEST(Subsurface, LeavingUndoesEntering) {
  const surface::DipoleInterface interface(1.4, 0);
  for (const double zenith : {0.0, 30.0, 85.0}) {
    const Vec3 wi = at_zenith(zenith);
    const auto in = interface.enter(wi, {0.5, 0.5}), out = interface.leave(-in.onwards, {0.5, 0.5});
    EXPECT_NEAR(norm(out.onwards - wi), 0, 1e-12);
    EXPECT_NEAR(out.share, in.share, 1e-12);
  }
  EXPECT_EQ(interface.leave(at_zenith(60), {0.5, 0.5}).share, 0);  // total reflection
}

// Interface and medium together are a furnace where nothing is absorbed: T goes below, E is reflected.
TEST(Subsurface, SamplesShareTheLightBetweenInterfaceAndMedium) {
  for (const char* id : {"dipole", "directional-dipole"})
    for (const double alpha : {0.0, 0.3}) {
      const Built built(id, {0, 1000, 0, 1.5}, alpha);
      for (const double zenith : {0.0, 70.0}) {
        double reflected = 0, below = 0;
        constexpr int n = 40000;
        for (int i = 0; i < n; ++i) {
          const auto part = [](double x) { return x - std::floor(x); };
          const Vec2 u{part(0.3 + i * 0.8191725133961645), part(0.1 + i * 0.6710436067037893)};
          const auto s = built.model->sample(built.values, at_zenith(zenith), u, part(i * 0.5497004779019703));
          (s.below ? below : reflected) += s.weight.x / n;
          if (s.below) {
            ASSERT_LT(s.wi.z, 0.6);
          }
        }
        const double e = surface::DipoleInterface(1.5, alpha).reflects(at_zenith(zenith).z);
        EXPECT_NEAR(reflected, e, 4e-3) << id << " " << alpha << " " << zenith;
        EXPECT_NEAR(below, 1 - e, 4e-3) << id << " " << alpha << " " << zenith;
      }
    }
}

// The whole reflectance of a half space: the dipole's closed form within 4 % of photons where it scatters well.
TEST(Photons, WholeReflectanceOfTheDipole) {
  for (const double eta : {1.3, 1.5})
    for (const double absorbs : {0.01, 0.001}) {
      const HalfSpace m{absorbs, 1 - absorbs, 0, eta};
      const Photographed photons = photographed(m, 1, {0, 1}, 8000);
      const double dipole = Built("dipole", m).beneath().diffuse_reflectance().x;
      EXPECT_NEAR(dipole / photons.whole, 1, 0.04 + 4 * photons.sigma / photons.whole) << eta << " " << absorbs;
    }
}

// Photons without a boundary that reflects, isotropic, and no absorption but a little: van de Hulst 1980's similarity
// relation R = (1 - s)(1 - 0.139 s) / (1 + 1.17 s), s = sqrt(1 - alpha), for diffuse light; this one is the check of
// the photons themselves.
TEST(Photons, AgreeWithVanDeHulst) {
  const double albedo = 0.9, s = std::sqrt(1 - albedo);
  Photons photons({0.1, 0.9, 0, 1.0}, 5);
  Random random(6);
  double sum = 0, squares = 0;
  constexpr int count = 60000;
  for (int i = 0; i < count; ++i) {  // cosine-weighted light
    const double c = std::sqrt(random.uniform());
    const double weight = photons.trace({std::sqrt(1 - c * c), 0, -c}).weight;
    sum += weight / count;
    squares += weight * weight / count;
  }
  const double expected = (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
  EXPECT_NEAR(sum, expected, 0.003 + 4.5 * std::sqrt((squares - sum * sum) / count));
}

// The directional dipole's known bias. alpha' = 0.99, index 1.4, in units of the mean free path 1 / sigma_t': rings
// near the entry are too bright, those beyond three mean free paths right within a quarter, at normal and oblique
// incidence.
TEST(Photons, BiasOfTheDirectionalDipole) {
  const std::vector<double> edges{0.3, 1, 3, 6, 12};
  for (const double g : {0.0, 0.8})
    for (const double cosine : {1.0, 0.5}) {
      const HalfSpace m{0.01, 0.99 / (1 - g), g, 1.4};
      const Built directional("directional-dipole", m), standard("dipole", m);
      const Photographed photons = photographed(m, cosine, edges, 12000);
      std::string table;
      for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
        const Vec3 w = inwards(cosine, m.eta);
        const double ratio = directional.ring(w, edges[b], edges[b + 1]) / photons.rings[b];
        const double other = standard.ring(w, edges[b], edges[b + 1]) / photons.rings[b];
        table += " " + std::to_string(edges[b]) + ": " + std::to_string(ratio) + " (" + std::to_string(other) + ")";
        EXPECT_GT(ratio, edges[b] < 1 ? 1.2 : 0.95) << edges[b];
        EXPECT_LT(ratio, edges[b] < 1 ? 2.2 : edges[b] < 3 ? 1.6 : 1.35) << edges[b];
        if (edges[b] >= 3) {
          EXPECT_NEAR(other, 0.88, 0.17) << edges[b];
        }
      }
      RecordProperty("g" + std::to_string(g).substr(0, 3) + "c" + std::to_string(cosine).substr(0, 3), table);
    }
}

}  // namespace
}  // namespace gonio::tests
