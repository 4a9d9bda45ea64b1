// The sinusoidal model: its density of normals and its masking against their definitions, and the whole against rays
// through the actual pattern.
#include <gtest/gtest.h>

#include <cstdio>

#include "cases.h"
#include "surface/microfacet.h"
#include "surface/sinusoid.h"

namespace gonio::tests {
namespace {

using surface::Sinusoid;

// The density of slopes integrates to one over the projected area and has the moments of sines and roughness.
TEST(Sinusoid, DensityOfNormalsHasItsMoments) {
  for (const auto& [a, b, alpha] :
       {std::tuple{0.5, 0.5, 0.1}, std::tuple{1.5, 0.3, 0.2}, std::tuple{0.001, 0.8, 0.1}, std::tuple{3.0, 3.0, 0.1}}) {
    const Sinusoid pattern(a, b, alpha, 0);
    const double pu = (a + 3 * alpha), qu = (b + 3 * alpha);
    constexpr int n = 160;
    double sum = 0, p2 = 0, q2 = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double p = pu * (2 * (i + 0.5) / n - 1), q = qu * (2 * (j + 0.5) / n - 1);
        const Vec3 h = normalized(Vec3{-p, -q, 1});
        const double density = pattern.density_of_normals(h) * std::pow(h.z, 4) * 4 * pu * qu / (n * n);
        sum += density;
        p2 += density * p * p;
        q2 += density * q * q;
      }
    EXPECT_NEAR(sum, 1, 2e-3) << a << " " << b;
    EXPECT_NEAR(p2, a * a / 4 + alpha * alpha / 2, 3e-3 * (a * a / 4 + alpha * alpha / 2)) << a << " " << b;
    EXPECT_NEAR(q2, b * b / 4 + alpha * alpha / 2, 3e-3 * (b * b / 4 + alpha * alpha / 2)) << a << " " << b;
  }
}

// Rays along one period of A cos(k x), each followed to see whether it is free.
TEST(Sinusoid, PublishedMaskingIsThatOfACosine) {
  for (const double slope : {0.5, 2.0})
    for (const double degrees : {30.0, 60.0, 75.0, 85.0}) {
      const double t = degrees * pi / 180, m = 1 / std::tan(t) / slope;
      int free = 0;
      constexpr int count = 2000;
      for (int i = 0; i < count; ++i) {
        const double x = 2 * pi * (i + 0.5) / count;
        bool hidden = -std::sin(x) > m;  // turned away
        for (double step = 1e-3; !hidden && step < 2 / m && step < 200; step += 5e-3)
          hidden = std::cos(x) + m * step < std::cos(x + step) - 1e-9;
        free += hidden ? 0 : 1;
      }
      const Sinusoid pattern(slope, 1e-4, 0.1, 0);
      EXPECT_NEAR(pattern.published_masking({std::sin(t), 0, std::cos(t)}), static_cast<double>(free) / count, 0.003)
          << slope << " " << degrees;
    }
}

TEST(Sinusoid, AreaSeenIsItsIntegral) {
  Random random(3);
  for (const auto& [a, b, alpha] : {std::tuple{0.5, 0.8, 0.1}, std::tuple{2.0, 1.0, 0.3}})
    for (const double degrees : {20.0, 60.0, 85.0}) {
      const Sinusoid pattern(a, b, alpha, 0.4);
      const Vec3 w = at_zenith(degrees);
      double sum = 0, squares = 0;
      constexpr int count = 40000;
      for (int i = 0; i < count; ++i) {
        const Vec3 h = pattern.normal(random.uniform(), random.uniform(), {random.uniform(), random.uniform()});
        const double x = std::max(0.0, dot(w, h)) / h.z;
        sum += x / count;
        squares += x * x / count;
      }
      EXPECT_NEAR(pattern.area_seen(w), sum, 5 * std::sqrt((squares - sum * sum) / count) + 2e-3);
      EXPECT_GE(pattern.area_seen(w), w.z * (1 - 1e-6));
    }
}

struct Pattern {
  double a, b, alpha;  // slopes along both axes, in periods of 2 pi
  double height(Vec2 x) const { return std::sin(x.x * a) * std::sin(x.y * b); }  // amplitude 1, wave numbers a and b
  Vec2 slopes(Vec2 x) const {
    return {a * std::cos(x.x * a) * std::sin(x.y * b), b * std::sin(x.x * a) * std::cos(x.y * b)};
  }
  // First meeting of a ray with the pattern; nothing: it leaves.
  std::optional<Vec3> first(Vec3 from, Vec3 d) const {
    const double step = 0.06 / (std::max(a, b) * std::hypot(d.x, d.y) + 1 * std::abs(d.z));
    double gap = from.z - height({from.x, from.y});
    for (double t = step; t < 400; t += step) {
      const Vec3 at = from + d * t;
      if (at.z > 1) return {};
      const double next = at.z - height({at.x, at.y});
      if (next < 0) return from + d * (t - step + step * gap / (gap - next));
      gap = next;
    }
    return {};
  }
};

struct Shares {
  double once = 0, others = 0;
};

// Light that leaves after one reflection, and what was blocked on its way.
Shares simulated(const Pattern& pattern, Vec3 wo, int rays, std::uint64_t seed) {
  Random random(seed);
  Shares shares;
  for (int i = 0; i < rays; ++i) {
    const Vec3 start{2 * pi / pattern.a * random.uniform(), 2 * pi / pattern.b * random.uniform(), 1 + 1e-9};
    const auto hit = pattern.first(start, -wo);
    if (!hit) continue;
    const Vec2 mean = pattern.slopes({hit->x, hit->y});
    const double most = 1 + 4 * pattern.alpha + std::hypot(mean.x, mean.y);
    Vec3 n;
    double shown = 0;
    int tries = 0;
    do {  // the facets that are seen, by the area that they show
      n = {-mean.x - pattern.alpha * random.normal() / std::sqrt(2),
           -mean.y - pattern.alpha * random.normal() / std::sqrt(2), 1};
      shown = dot(n, wo);
    } while (shown < most * random.uniform() && ++tries < 10000);
    const Vec3 wi = surface::mirrored(wo, normalized(n)), lifted = *hit + Vec3{0, 0, 1e-3};
    if (wi.z > 0 && !pattern.first(lifted, wi))
      shares.once += 1.0 / rays;
    else
      shares.others += 1.0 / rays;
  }
  return shares;
}

double reflected_by(const Pattern& pattern, Vec3 wo, double projections) {
  const surface::Model& model = *surface::find("sinusoidal");
  const std::vector<double> amounts = {
      1e-5, 2 * pi * 1e-5 / pattern.a, 2 * pi * 1e-5 / pattern.b, pattern.alpha, 0.01, 30, 0, 0, projections};
  surface::Values values;
  for (std::size_t i = 0; i < amounts.size(); ++i) values.v[i] = {amounts[i], amounts[i], amounts[i]};
  return model.albedo(values, wo).x;
}

// Both maskings are approximations: how far they go is printed, and held where they are meant to be good.
TEST(Sinusoidal, AgainstRaysThroughThePattern) {
  std::printf("slopes, zenith: a mirror's light that leaves after one reflection: rays, model, published masking\n");
  double squares = 0, published = 0, count = 0;
  for (const auto& [a, b] : {std::pair{0.3, 0.3}, std::pair{0.3, 0.9}, std::pair{1.0, 1.0}})
    for (const double degrees : {0.0, 30.0, 50.0, 65.0, 80.0}) {
      const Vec3 wo = at_zenith(degrees, 0.3);
      const Pattern pattern{a, b, 0.1};
      const double actual = simulated(pattern, wo, 6000, 40).once;
      const double ours = reflected_by(pattern, wo, 0), theirs = reflected_by(pattern, wo, 1);
      std::printf("%.1f %.1f %3.0f deg  %.3f  %.3f  %.3f\n", a, b, degrees, actual, ours, theirs);
      squares += (ours - actual) * (ours - actual);
      published += (theirs - actual) * (theirs - actual);
      ++count;
    }
  std::printf("rms %.3f, published %.3f\n", std::sqrt(squares / count), std::sqrt(published / count));
  EXPECT_LT(std::sqrt(squares / count), 0.05);
  EXPECT_LT(squares, published);
}

TEST(Sinusoidal, FlatIsBeckmannsSurface) {
  const Sinusoid flat(0, 0, 0.3, 0);
  for (const double degrees : {0.0, 10.0, 20.0}) {
    const Vec3 h = at_zenith(degrees);
    const double t = std::tan(degrees * pi / 180) / 0.3;
    const double expected = std::exp(-t * t) / (pi * 0.09 * std::pow(h.z, 4));
    EXPECT_NEAR(flat.density_of_normals(h), expected, 1e-4 * expected);
  }
}

}  // namespace
}  // namespace gonio::tests
