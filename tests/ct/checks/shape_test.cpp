// Shapes: what a ray has of them and the distance to them must agree on where inside is; lengths against formulas;
// meshes against the bodies that they approximate; coefficients and spectra against published figures.
#include "ct/shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "ct/phantom.h"

namespace gonio::ct {
namespace {

Vec3 random_direction(Random& random) {
  return normalized({random.normal(), random.normal(), random.normal()});
}

// Inside by the spans: `t` lies in one of them.
bool within(const Spans& spans, double t) {
  for (int k = 0; k < spans.count(); ++k)
    if (t > spans.enter(k) && t < spans.leave(k)) return true;
  return false;
}

void expect_spans_and_distance_agree(const Shape& shape, double size, int rays, std::uint64_t seed) {
  Random random(seed);
  int inside = 0;
  for (int k = 0; k < rays; ++k) {
    const Vec3 through = Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * (size / 2);
    Vec3 d = random_direction(random);
    if (k % 3 == 0) d = normalized({d.x, d.y, 0});  // as most rays of a parallel beam
    const Ray ray{through - d * (3 * size), d};
    Spans spans;
    shape.cut(ray, spans);
    for (int m = 0; m < 8; ++m) {
      const double t = random.uniform(2 * size, 4 * size), distance = shape.distance(ray.at(t));
      if (std::abs(distance) < 1e-7 * size) continue;  // on the surface either answer is right
      ASSERT_EQ(within(spans, t), distance < 0) << "ray " << k << " at " << t << ", distance " << distance;
      inside += distance < 0;
    }
  }
  EXPECT_GT(inside, rays / 100);
}

TEST(CtShapes, SpansAndDistancesAgreeInEveryReadyPhantom) {
  const Place place{64, 1e-3};
  std::uint64_t seed = 1;
  for (const Phantom& p : {glass_block(place), glass_tube(place), hollow_sphere(place), bowl_with_lid(place),
                           teapot(place), step_block(place)})
    for (const Part& part : p.parts) {
      SCOPED_TRACE(p.name + ", " + part.name);
      expect_spans_and_distance_agree(*part.shape, place.extent(), 1500, seed++);
    }
}

TEST(CtShapes, SpansAndDistancesAgreeInSingleShapes) {
  const std::vector<ShapePtr> shapes{
      ball({0.1, 0, 0}, 0.4),
      ellipsoid({0, 0.1, 0}, {0.4, 0.2, 0.3}),
      cylinder({-0.3, 0, 0.1}, {0.2, 0.2, 0.3}, 0.2),
      box({0, 0, 0.1}, {0.1, 0.3, 0.2}),
      half_space({0, 0.1, 0}, {1, 1, 0.2}),
      lathe({0, 0, 0}, {{0, -0.3}, {0.3, -0.3}, {0.3, 0.1}, {0.15, 0.1}, {0.2, 0.3}, {0, 0.2}}),
      shared(ball({}, 0.4), half_space({}, {0, 0, 1}))};
  std::uint64_t seed = 40;
  for (const ShapePtr& shape : shapes) expect_spans_and_distance_agree(*shape, 1, 1500, seed++);
}

TEST(CtShapes, IntervalsCombineAsSets) {
  Random random(7);
  for (int k = 0; k < 500; ++k) {
    Spans a, b;
    double at = 0, bt = 0;
    for (int m = 0; m < 4; ++m) {
      const double a0 = at + random.uniform(), b0 = bt + random.uniform();
      a.add(a0, at = a0 + random.uniform()), b.add(b0, bt = b0 + random.uniform());
    }
    const Spans either = combined(a, b, Combine::unite), both = combined(a, b, Combine::intersect);
    EXPECT_NEAR(either.length() + both.length(), a.length() + b.length(), 1e-12);
    EXPECT_NEAR(combined(a, b, Combine::subtract).length(), a.length() - both.length(), 1e-12);
    for (int m = 1; m < either.count(); ++m) EXPECT_LT(either.leave(m - 1), either.enter(m));
  }
}

TEST(CtShapes, DistancesOfABallAreExactAndThoseOfAnEllipsoidNearIt) {
  EXPECT_DOUBLE_EQ(ball({1, 0, 0}, 2)->distance({1, 5, 0}), 3);
  EXPECT_DOUBLE_EQ(box({}, {1, 1, 1})->distance({4, 5, 0}), 5);
  const ShapePtr e = ellipsoid({}, {3, 2, 1});
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Vec3 u = random_direction(random), at{3 * u.x, 2 * u.y, u.z};
    const Vec3 n = normalized({at.x / 9, at.y / 4, at.z});
    EXPECT_NEAR(e->distance(at + n * 0.01), 0.01, 3e-4);
    EXPECT_NEAR(e->distance(at - n * 0.01), -0.01, 3e-4);
  }
}

// A ball of triangles with corners on the ball: chords are too short by less than the facets' sagitta allows.
TEST(CtShapes, AMeshOfABallHasTheBallsChords) {
  constexpr std::uint32_t rings = 60, sectors = 120;
  std::vector<Vec3> p{{0, 0, 1}};
  std::vector<std::array<std::uint32_t, 3>> t;
  for (std::uint32_t r = 1; r < rings; ++r)
    for (std::uint32_t s = 0; s < sectors; ++s) {
      const double a = pi * r / rings, b = 2 * pi * s / sectors;
      p.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  p.push_back({0, 0, -1});
  const auto at = [](std::uint32_t r, std::uint32_t s) { return 1 + (r - 1) * sectors + s % sectors; };
  const auto south = static_cast<std::uint32_t>(p.size() - 1);
  for (std::uint32_t s = 0; s < sectors; ++s) {
    t.push_back({0, at(1, s), at(1, s + 1)});
    t.push_back({south, at(rings - 1, s + 1), at(rings - 1, s)});
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      t.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      t.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  const ShapePtr mesh = of_mesh(p, t), sphere = ball({}, 1);
  expect_spans_and_distance_agree(*mesh, 2, 500, 11);
  Random random(5);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 d = random_direction(random), off = Basis(d).t * random.uniform(-0.95, 0.95);
    Spans a, b;
    mesh->cut({off - d * 3, d}, a), sphere->cut({off - d * 3, d}, b);
    EXPECT_NEAR(a.length(), b.length(), 0.012);
    EXPECT_LE(a.length(), b.length() + 1e-12);
  }
  // Rays straight at a corner and along edges count as well.
  Spans poles;
  mesh->cut({{0, 0, 3}, {0, 0, -1}}, poles);
  EXPECT_NEAR(poles.length(), 2, 1e-6);
  EXPECT_NEAR(mesh->distance({0.3, 0.2, 0.1}), std::sqrt(0.14) - 1, 2e-3);
}

TEST(CtShapes, WhereTwoPartsOverlapTheFirstIs) {
  const Phantom p{"two", {{"a", ball({}, 1), glass()}, {"b", ball({1, 0, 0}, 1), iron()}}, {}};
  std::array<double, 2> lengths{};
  p.lengths({{-5, 0, 0}, {1, 0, 0}}, lengths);
  EXPECT_NEAR(lengths[0], 2, 1e-12);
  EXPECT_NEAR(lengths[1], 1, 1e-12);
  EXPECT_EQ(p.part_at({0.5, 0, 0}), 0u);
  EXPECT_EQ(p.part_at({1.5, 0, 0}), 1u);
  EXPECT_EQ(p.part_at({0, 3, 0}), 2u);
}

// NIST's table of PMMA is a compound's of C, H and O and that of Pyrex one of six elements; what is here a mixture,
// SiO2 of silicon and oxygen, must come out near the glass that is four fifths SiO2.
TEST(CtMatter, AttenuatesAsTabulated) {
  EXPECT_DOUBLE_EQ(mass_attenuation_cm2_per_g(Substance::iron, 60), 1.205);
  EXPECT_NEAR(glass().attenuation_per_m(60), 53.9, 0.05);
  for (const double e : {30.0, 60.0, 100.0})
    EXPECT_NEAR(quartz().attenuation_per_m(e) / 2.20 / (glass().attenuation_per_m(e) / 2.23), 1.05, 0.05) << e;
  EXPECT_NEAR(mass_attenuation_cm2_per_g(Substance::aluminium, 55), 0.3176, 0.003);  // XCOM
  EXPECT_THROW(mass_attenuation_cm2_per_g(Substance::iron, 5), std::invalid_argument);
}

// Half-value layers in aluminium of the standard qualities RQR (IEC 61267): 2.58 mm at 70 kV, 3.97 at 100, 5.00 at 120
// behind 2.8, 3.2 and 3.5 mm, of air kerma. A law without the anode's own absorption is right to a fifth.
TEST(CtMatter, TubesAreAsHardAsTheStandardsSay) {
  for (const auto& [kv, filter, layer] : {std::tuple{70.0, 2.8, 2.58}, {100.0, 3.2, 3.97}, {120.0, 3.5, 5.0}}) {
    const Spectrum s = tube(kv, filter);
    const auto kerma = [&](double mm) {  // E times the energy absorption of air: 0.1537 cm^2/g at 30 keV, 0.0233 at 100
      double sum = 0;
      for (std::size_t e = 0; e < s.kev.size(); ++e)
        sum += s.share[e] * s.kev[e] * (0.0233 + 0.1304 * std::pow(30 / s.kev[e], 3)) *
               std::exp(-1e-3 * mm * aluminium().attenuation_per_m(s.kev[e]));
      return sum;
    };
    double mm = 0;
    while (kerma(mm) > kerma(0) / 2) mm += 0.01;
    EXPECT_NEAR(mm, layer, 0.2 * layer) << kv;
  }
}

}  // namespace
}  // namespace gonio::ct
