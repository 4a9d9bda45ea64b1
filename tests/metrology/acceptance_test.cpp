// Figures of the guideline from simulated scanners: exact where there is no noise, and with uncertainties that hold
// over hundreds of clouds, for errors that are independent and for such that neighbours share.
#include "manifest/sections/acceptance.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/random.h"
#include "metrology/figures.h"
#include "stats/intervals.h"

namespace gonio::metrology {
namespace {

constexpr Vec3 centre{0.03, -0.05, 0.42};
constexpr double radius = 0.0125;

// The part of a sphere that a scanner at the origin sees: up to 60 degrees from the direction to it.
std::vector<Vec3> cap(std::size_t count, Random& random, const std::function<double(Vec3)>& error, Vec3 at = centre) {
  const Basis basis(-normalized(at));
  std::vector<Vec3> points;
  while (points.size() < count) {
    const double z = random.uniform(0.5, 1), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
    const Vec3 direction = basis.to_world({r * std::cos(phi), r * std::sin(phi), z});
    points.push_back(at + direction * (radius + error(direction)));
  }
  return points;
}

// Errors that neighbours share: a few waves of random direction and phase, about 1/15 of the sphere long.
std::function<double(Vec3)> waves(Random& random, double sigma) {
  struct Wave {
    Vec3 k;
    double phase;
  };
  std::vector<Wave> all;
  for (int i = 0; i < 60; ++i)
    all.push_back({Vec3{random.normal(), random.normal(), random.normal()} * 35.0, random.uniform(0, 2 * pi)});
  return [all, sigma](Vec3 d) {
    double sum = 0;
    for (const Wave& w : all) sum += std::cos(dot(w.k, d) + w.phase);
    return sigma * sum * std::sqrt(2.0 / 60);
  };
}

struct Spread {  // of estimates over clouds: what they scatter, and what they say that they scatter
  std::vector<double> values, sigmas;
  void add(double value, double sigma) {
    values.push_back(value);
    sigmas.push_back(sigma);
  }
  double ratio() const {
    double v = 0, s = 0;
    const double m = stats::mean(values);
    for (const double x : values) v += (x - m) * (x - m);
    for (const double x : sigmas) s += x * x;
    return std::sqrt(s / v);
  }
};

TEST(SphereFit, IsExactWithoutNoise) {
  Random random(1);
  const auto points = cap(500, random, [](Vec3) { return 0.0; });
  const SphereFit fit = fit_sphere(points, std::nullopt, "t");
  EXPECT_LT(norm(fit.centre_m - centre), 1e-14);
  EXPECT_NEAR(fit.radius_m, radius, 1e-14);
  EXPECT_LT(norm(fit_sphere(points, radius, "t").centre_m - centre), 1e-14);
}

TEST(SphereFit, SigmasAreHonestForIndependentAndForSharedErrors) {
  for (const bool shared : {false, true}) {
    Spread along, across, size, form;
    const Vec3 view = normalized(centre), side = Basis(view).t;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      Random random(seed, shared ? 2 : 1);
      const auto wave = waves(random, 20e-6);
      const auto points = cap(2500, random, [&](Vec3 d) { return shared ? wave(d) : 20e-6 * random.normal(); });
      const SphereFit fit = fit_sphere(points, std::nullopt, "t");
      const auto sigma_along = [&](Vec3 u) {
        double v = 0;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) v += u[i] * u[j] * fit.covariance[static_cast<std::size_t>(4 * i + j)];
        return std::sqrt(v);
      };
      along.add(dot(fit.centre_m - centre, view), sigma_along(view));
      across.add(dot(fit.centre_m - centre, side), sigma_along(side));
      const auto figure = probing_size(fit, radius);
      size.add(figure.value, *figure.uncertainty);
      if (!shared) form.add(range_of(fit.deviations, seed).value_m, range_of(fit.deviations, seed).uncertainty_m);
    }
    // 300 clouds: the scatter itself is known to 4 %.
    for (const Spread* s : {&along, &across, &size}) {
      EXPECT_GT(s->ratio(), 0.85) << shared;
      EXPECT_LT(s->ratio(), 1.2) << shared;
    }
    EXPECT_LT(std::abs(stats::mean(size.values)), 4 * stats::standard_error(size.values));
    if (shared) continue;
    EXPECT_GT(form.ratio(), 0.75);
    EXPECT_LT(form.ratio(), 1.4);
  }
}

TEST(SphereFit, HeldRadiusFindsTheCentreOfASmallCap) {
  Spread x;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed, 3);
    auto points = cap(4000, random, [&](Vec3) { return 20e-6 * random.normal(); });
    std::erase_if(points, [](Vec3 p) { return dot(normalized(p - centre), -normalized(centre)) < 0.9; });
    const SphereFit fit = fit_sphere(points, radius, "t");
    x.add(dot(fit.centre_m - centre, Basis(normalized(centre)).t),
          std::sqrt(fit.covariance[0]));  // direction t is near x
    EXPECT_EQ(fit.radius_m, radius);
    EXPECT_EQ(fit.radius_sigma_m(), 0);
  }
  EXPECT_GT(x.ratio(), 0.8);
  EXPECT_LT(x.ratio(), 1.25);
}

TEST(SphereFit, AtMostThreePerMilleAreLeftOut) {
  Random random(5);
  auto points = cap(10000, random, [&](Vec3) { return 20e-6 * random.normal(); });
  for (std::size_t i = 0; i < 20; ++i) points[i * 37] += Vec3{0, 0, -0.003};  // 0.2 %: flying points
  const SphereFit good = fit_sphere(points, std::nullopt, "t");
  EXPECT_LE(good.deviations.rejected_m.size(), 30u);
  EXPECT_LT(norm(good.centre_m - centre), 5e-6);
  EXPECT_LT(range_of(good.deviations, 0).value_m, 200e-6);
  for (std::size_t i = 0; i < 100; ++i) points[i * 37] += Vec3{0, 0, -0.003};  // 1 %: too many to be let go
  const SphereFit bad = fit_sphere(points, std::nullopt, "t");
  EXPECT_EQ(bad.deviations.rejected_m.size(), 30u);
  EXPECT_GT(bad.deviations.still_beyond, 0.005);
  EXPECT_GT(range_of(bad.deviations, 0).value_m, 0.0015);
}

TEST(SphereFit, RefusesWhatThePointsCannotSay) {
  Random random(6);
  const auto points = cap(20000, random, [&](Vec3) { return 20e-6 * random.normal(); });
  EXPECT_THROW(fit_sphere(std::span(points).first(9), std::nullopt, "t"), Error);
  std::vector<Vec3> flat, tiny;
  for (int i = 0; i < 400; ++i) flat.push_back({0.001 * (i % 20), 0.001 * (i / 20), 0.4});
  EXPECT_THROW(fit_sphere(flat, std::nullopt, "t"), Error);
  for (const Vec3& p : points)
    if (dot(normalized(p - centre), -normalized(centre)) > 0.998) tiny.push_back(p);
  try {
    fit_sphere(tiny, std::nullopt, "t");
    ADD_FAILURE() << "a cap of " << tiny.size() << " points was accepted";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("hold"));
  }
}

std::vector<Vec3> plane(std::size_t count, Random& random, const std::function<double(double, double)>& error) {
  const Basis basis(normalized(Vec3{0.2, -0.3, -1}));
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double u = random.uniform(-0.05, 0.05), v = random.uniform(-0.03, 0.03);
    points.push_back(Vec3{0.01, 0.02, 0.5} + basis.to_world({u, v, error(u, v)}));
  }
  return points;
}

TEST(PlaneFit, SigmasAreHonest) {
  Spread offset, tilt;
  const Basis basis(normalized(Vec3{0.2, -0.3, -1}));
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed, 4);
    const auto points = plane(1000, random, [&](double, double) { return 50e-6 * random.normal(); });
    const PlaneFit fit = fit_plane(points, "t");
    EXPECT_GT(dot(fit.normal, basis.n), 0.999);
    offset.add(dot(fit.centroid_m - Vec3{0.01, 0.02, 0.5}, basis.n), fit.offset_sigma_m);
    // The longer axis is t; a slope along it is a turn about b.
    tilt.add(dot(fit.normal, basis.t), fit.tilt_sigma_rad[0]);
    EXPECT_NEAR(*flatness(fit, seed).sigma, 50e-6, 8e-6);
  }
  for (const Spread* s : {&offset, &tilt}) {
    EXPECT_GT(s->ratio(), 0.85);
    EXPECT_LT(s->ratio(), 1.2);
  }
}

// The worst case is an extreme: its spread, over clouds of few points (none may go) and of many.
TEST(Figures, RangesHaveHonestUncertainties) {
  for (const std::size_t count : {60u, 250u, 500u, 2000u, 20000u}) {
    Spread range;
    for (std::uint64_t seed = 0; seed < 250; ++seed) {
      Random random(seed, count);
      const auto points = plane(count, random, [&](double, double) { return 50e-6 * random.normal(); });
      const auto figure = flatness(fit_plane(points, "t"), seed);
      range.add(figure.value, *figure.uncertainty);
    }
    EXPECT_GT(range.ratio(), 0.75) << count;
    EXPECT_LT(range.ratio(), 1.5) << count;
  }
}

TEST(PlaneFit, FindsASagAndRefusesALine) {
  Random random(8);
  const auto sagging = plane(4000, random, [](double u, double) { return 400e-6 * (u / 0.05) * (u / 0.05); });
  EXPECT_NEAR(flatness(fit_plane(sagging, "t"), 0).value, 400e-6, 10e-6);
  std::vector<Vec3> line;
  for (int i = 0; i < 50; ++i) line.push_back({0.001 * i, 0.002 * i, 0.4});
  EXPECT_THROW(fit_plane(line, "t"), Error);
}

TEST(Figures, DistanceOfTwoSpheresWithItsUncertainty) {
  Spread distance;
  const Vec3 other = centre + Vec3{0.08, 0.05, 0.03};
  const double calibrated = norm(other - centre);
  for (std::uint64_t seed = 0; seed < 250; ++seed) {
    Random random(seed, 6);
    const auto noise = [&](Vec3) { return 20e-6 * random.normal(); };
    const SphereFit a = fit_sphere(cap(800, random, noise), std::nullopt, "t");
    const SphereFit b = fit_sphere(cap(800, random, noise, other), std::nullopt, "t");
    const auto figure = sphere_distance(a, b, calibrated);
    distance.add(figure.value, *figure.uncertainty);
  }
  EXPECT_LT(std::abs(stats::mean(distance.values)), 4 * stats::standard_error(distance.values));
  EXPECT_GT(distance.ratio(), 0.85);
  EXPECT_LT(distance.ratio(), 1.2);
}

TEST(Figures, SummariesHoldTheWorstAndTheSpread) {
  std::vector<manifest::AcceptanceResult> results;
  for (const double v : {1e-4, -5e-4, 2e-4}) {
    manifest::AcceptanceResult r;
    r.quantity = "sphere-distance";
    r.value = v;
    results.push_back(r);
  }
  const auto found = summaries(results);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].value, -5e-4);
  EXPECT_NEAR(*found[0].bias, -2e-4 / 3, 1e-12);
  EXPECT_NEAR(*found[0].sigma, 3.785938897e-4, 1e-10);
  EXPECT_EQ(*found[0].count, 3);
}

}  // namespace
}  // namespace gonio::metrology
