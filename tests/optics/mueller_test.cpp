// Stokes vectors and Mueller matrices against fields: amplitudes are taken through the same frames by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "optics/mueller_algebra.h"
#include "physical_mueller.h"

namespace gonio::optics {
namespace {

Stokes stokes_of(Complex x, Complex y) {
  const Complex xy = x * std::conj(y);
  return {{std::norm(x) + std::norm(y), std::norm(x) - std::norm(y), 2 * xy.real(), 2 * xy.imag()}};
}
void expect_near(const Stokes& a, const Stokes& b, double tolerance) {
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a.s[i], b.s[i], tolerance) << "s" << i;
}
void expect_near(const Mueller& a, const Mueller& b, double tolerance) {
  for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(a.m[i], b.m[i], tolerance) << i / 4 << "," << i % 4;
}
Complex draw(Random& random) {
  return std::polar(random.uniform() + 0.1, 2 * pi * random.uniform());
}
Vec3 unit(Random& random) {
  const double z = 2 * random.uniform() - 1, phi = 2 * pi * random.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// s3 > 0: at a fixed point Re(E exp(-i omega t)) turns from y to x: clockwise for who looks against the light, with x
// to the right and y up.
TEST(Stokes, RightCircularTurnsClockwiseBeforeTheReceiver) {
  const Complex x{0, 1}, y{1, 0};
  expect_near(stokes_of(x, y), {{2, 0, 0, 2}}, 1e-15);
  const auto field = [&](double phase) {
    const Complex wave = std::polar(1.0, -phase);
    return Vec2{(x * wave).real(), (y * wave).real()};
  };
  EXPECT_NEAR(field(0).y, 1, 1e-15);
  EXPECT_NEAR(field(pi / 2).x, 1, 1e-15);
  for (double phase = 0; phase < 6; phase += 0.5) {
    const Vec2 now = field(phase), later = field(phase + 0.1);
    EXPECT_LT(now.x * later.y - now.y * later.x, 0);
  }
}

TEST(Mueller, FollowsTheField) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Complex x = draw(random), y = draw(random), a = draw(random), b = draw(random);
    expect_near(mueller_of(a, b) * stokes_of(x, y), stokes_of(a * x, b * y), 1e-13);
  }
}

TEST(Mueller, TurningAFrameIsTurningTheField) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Complex x = draw(random), y = draw(random);
    const double angle = 2 * pi * random.uniform(), c = std::cos(angle), s = std::sin(angle);
    const Stokes turned = stokes_of(x * c + y * s, -x * s + y * c);
    expect_near(frame_turned_by(angle) * stokes_of(x, y), turned, 1e-13);
    const Vec3 d = unit(random);
    const Basis basis(d);
    expect_near(frame_change(d, basis.t, basis.t * c + basis.b * s) * stokes_of(x, y), turned, 1e-13);
  }
}

TEST(Mueller, FrameChangesCompose) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Vec3 d = unit(random);
    const Basis basis(d);
    const auto axis = [&] {
      const double a = 2 * pi * random.uniform();
      return basis.t * std::cos(a) + basis.b * std::sin(a);
    };
    const Vec3 a = axis(), b = axis(), c = axis();
    expect_near(frame_change(d, b, c) * frame_change(d, a, b), frame_change(d, a, c), 1e-13);
    expect_near(frame_change(d, a, -b), frame_change(d, a, b), 1e-13);
  }
}

TEST(Mueller, PolarizersAndRetarders) {
  const Stokes natural{{1, 0, 0, 0}};
  expect_near(linear_polarizer(0) * natural, {{0.5, 0.5, 0, 0}}, 1e-15);
  expect_near(linear_polarizer(pi / 4) * natural, {{0.5, 0, 0.5, 0}}, 1e-15);
  // Malus.
  for (double angle = 0; angle < 3; angle += 0.3) {
    const Stokes after = linear_polarizer(angle) * (linear_polarizer(0) * natural);
    EXPECT_NEAR(after.s[0], 0.5 * std::cos(angle) * std::cos(angle), 1e-14);
    EXPECT_NEAR((linear_polarizer(angle) * Stokes{{1, 0.3, 0.4, 0.1}}).s[0],
                (1 + 0.3 * std::cos(2 * angle) + 0.4 * std::sin(2 * angle)) / 2, 1e-14);
  }
  // A quarter-wave plate at 45 degrees makes circular light of linear.
  const Stokes circular = linear_retarder(pi / 4, pi / 2) * Stokes{{1, 1, 0, 0}};
  EXPECT_NEAR(std::abs(circular.s[3]), 1, 1e-14);
  EXPECT_NEAR(degree_of_linear_polarization(circular), 0, 1e-7);
  EXPECT_NEAR(degree_of_polarization(circular), 1, 1e-14);
  EXPECT_NEAR(angle_of_linear_polarization({{1, 0, 0.5, 0}}), pi / 4, 1e-14);
}

TEST(FresnelMueller, DielectricAgainstReflectancesInSinesAndTangents) {
  for (const double eta : {1.5, 1.33, 2.4})
    for (double degrees = 1; degrees < 90; degrees += 4) {
      const double i = degrees * pi / 180, t = std::asin(std::sin(i) / eta);
      const double s = std::pow(std::sin(i - t) / std::sin(i + t), 2),
                   p = std::pow(std::tan(i - t) / std::tan(i + t), 2);
      const Mueller m = fresnel_reflection(std::cos(i), eta), through = fresnel_transmission(std::cos(i), eta);
      EXPECT_NEAR(m(0, 0), (s + p) / 2, 1e-12);
      EXPECT_NEAR(m(0, 1), (s - p) / 2, 1e-12);
      EXPECT_NEAR(through(0, 0), 1 - (s + p) / 2, 1e-12);  // energy
      EXPECT_NEAR(through(0, 1), -(s - p) / 2, 1e-12);
    }
}

TEST(FresnelMueller, BrewstersAngleReflectsOnlyS) {
  const double eta = 1.5, cosine = std::cos(std::atan(eta));
  const Stokes s = fresnel_reflection(cosine, eta) * Stokes{{1, 0, 0, 0}};
  EXPECT_NEAR(degree_of_polarization(s), 1, 1e-12);
  EXPECT_NEAR(s.s[1], s.s[0], 1e-15);
}

// At normal incidence the field in space is multiplied by one number whatever its direction.
TEST(FresnelMueller, NormalIncidenceIsAMirror) {
  Mueller expected;
  expected(0, 0) = expected(1, 1) = 0.04;
  expected(2, 2) = expected(3, 3) = -0.04;
  expect_near(fresnel_reflection(1, 1.5), expected, 1e-15);
  Mueller through;
  for (int i = 0; i < 4; ++i) through(i, i) = 0.96;
  expect_near(fresnel_transmission(1, 1.5), through, 1e-15);
}

// Born & Wolf 1999, equation 1.5.60: tan(delta / 2) = cos i sqrt(sin^2 i - n^2) / sin^2 i, delta = phase of s - of p.
TEST(FresnelMueller, TotalReflectionRetards) {
  const double n = 1 / 1.51;
  for (double degrees = 43; degrees < 90; degrees += 3) {
    const double i = degrees * pi / 180, s = std::sin(i);
    const Amplitudes r = reflected_amplitudes(std::cos(i), n);
    EXPECT_NEAR(std::abs(r.s), 1, 1e-14);
    EXPECT_NEAR(std::abs(r.p), 1, 1e-14);
    EXPECT_NEAR(std::tan((std::arg(r.s / r.p) - 0) / 2), std::cos(i) * std::sqrt(s * s - n * n) / (s * s), 1e-12);
    const Mueller m = fresnel_reflection(std::cos(i), n), through = fresnel_transmission(std::cos(i), n);
    EXPECT_NEAR(m(0, 0), 1, 1e-14);
    EXPECT_EQ(through(0, 0), 0);
  }
}

// Fresnel's rhomb: two reflections at 54.6 degrees in glass of 1.51 delay by a quarter wave.
TEST(FresnelMueller, RhombMakesCircularLight) {
  const Mueller once = fresnel_reflection(std::cos(54.62 * pi / 180), 1 / 1.51);
  const Stokes out = once * (once * Stokes{{1, 0, 1, 0}});
  EXPECT_NEAR(std::abs(out.s[3]), 1, 1e-4);
}

TEST(FresnelMueller, MetalAgainstItsReflectances) {
  // Born & Wolf 1999, section 14.2: reflectance at normal incidence; gold at 582 nm.
  const Complex gold{0.29, 2.863};
  const double f0 = (std::pow(0.29 - 1, 2) + 2.863 * 2.863) / (std::pow(0.29 + 1, 2) + 2.863 * 2.863);
  EXPECT_NEAR(fresnel_reflection(1, gold)(0, 0), f0, 1e-14);
  // At grazing incidence a mirror without phase between s and p; at the principal angle a quarter wave.
  const Mueller grazing = fresnel_reflection(1e-9, gold);
  EXPECT_NEAR(grazing(2, 2), 1, 1e-6);
  double smallest = 1;
  for (double cosine = 0.01; cosine < 1; cosine += 0.001)
    smallest = std::min(smallest, std::abs(fresnel_reflection(cosine, gold)(2, 2)));
  EXPECT_LT(smallest, 2e-3);
  // The sign of the phase: elliptic light from +45 degrees, k against -k of the other convention.
  const Mueller slanted = fresnel_reflection(0.5, gold);
  const Amplitudes r = reflected_amplitudes(0.5, gold);
  EXPECT_NEAR(slanted(3, 2), std::imag(r.s * std::conj(r.p)), 1e-14);
}

TEST(FresnelMueller, AreWhatLightCanDo) {
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const double cosine = random.uniform();
    const Complex eta{0.2 + 2.5 * random.uniform(), random.uniform() < 0.5 ? 0.0 : 6 * random.uniform()};
    const Mueller reflection = fresnel_reflection(cosine, eta), through = fresnel_transmission(cosine, eta);
    EXPECT_TRUE(tests::is_passive(reflection)) << cosine << " " << eta;
    EXPECT_TRUE(tests::is_passive(through)) << cosine << " " << eta;
    // Both together: what is reflected and carried on is not more than what came, for each of s and p.
    EXPECT_LE(reflection(0, 0) + std::abs(reflection(0, 1) + through(0, 1)) + through(0, 0), 1 + 1e-9);
  }
  EXPECT_TRUE(tests::is_passive(linear_polarizer(0.3)));
  EXPECT_TRUE(tests::is_passive(linear_retarder(0.3, 1.2)));
  EXPECT_TRUE(tests::is_passive(Mueller::depolarizer()));
  Mueller impossible = identity_mueller();
  impossible(3, 3) = -1;  // flips handedness alone
  EXPECT_FALSE(tests::is_passive(impossible));
}

}  // namespace
}  // namespace gonio::optics
