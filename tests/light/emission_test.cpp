// Photons of every registered light against its own samples: nothing here names a model. Each |z| < 5: false alarm
// 6e-7; with up to 500 comparisons 3e-4 in all. Midpoint rules add what `rule_error` allows.
#include "emission.h"

#include <gtest/gtest.h>

#include <array>

#include "cases.h"

namespace gonio::tests {
namespace {

constexpr double z_limit = 5, rule_error = 0.01;
constexpr int draws = 60000;

light::Emission photon_of(const light::Emitter& emitter, Random& random) {
  const double a = random.uniform(), b = random.uniform(), c = random.uniform();
  return emitter.emit({a, b}, {c, random.uniform()});
}

// Where the light is, roughly: the mean of photons' origins.
Vec3 middle_of(const light::Emitter& emitter) {
  Random random(5);
  Vec3 sum;
  for (int k = 0; k < 1000; ++k) sum += photon_of(emitter, random).origin_m;
  return sum / 1000;
}

// Patches of the sphere about the mean direction of the photons. With z the cosine to that axis, rows are equal in
// s = sqrt((1 - z) / 2), dz = -4 s ds, so that narrow lobes are resolved; columns are equal in phi.
constexpr int rows = 8, columns = 8, patches = rows * columns;

Basis axis_of(const light::Emitter& emitter) {
  Random random(6);
  Vec3 sum{0, 0, 1e-6};
  for (int k = 0; k < 1000; ++k) sum += photon_of(emitter, random).direction;
  return Basis(normalized(sum));
}

std::array<PhotonBin, patches> photons_by_direction(const light::Emitter& emitter, Random& random, PhotonBin& all) {
  std::array<PhotonBin, patches> seen;
  const Basis frame = axis_of(emitter);
  for (int k = 0; k < draws; ++k) {
    const auto photon = photon_of(emitter, random);
    if (!photon.valid) continue;
    EXPECT_NEAR(norm(photon.direction), 1, 1e-9);
    const Vec3 local = frame.to_local(photon.direction);
    const int row = static_cast<int>(std::sqrt(std::max(0.0, (1 - local.z) / 2)) * rows);
    const int column = static_cast<int>((std::atan2(local.y, local.x) / (2 * pi) + 0.5) * columns);
    seen[static_cast<std::size_t>(std::min(row, rows - 1) * columns + std::min(column, columns - 1))].add(
        photon.flux.x);
    all.add(photon.flux.x);
  }
  return seen;
}

// Intensity seen from far away, integrated over the patches: midpoint rule.
std::array<double, patches> power_by_direction(const light::Emitter& emitter) {
  constexpr int parts = 12, grid = 16;
  constexpr double far_m = 1e3, ds = 1.0 / (rows * parts), dphi = 2 * pi / (columns * parts);
  const Vec3 middle = middle_of(emitter);
  const Basis frame = axis_of(emitter);
  std::array<double, patches> power{};
  Random random(8);
  for (int i = 0; i < rows * parts; ++i)
    for (int j = 0; j < columns * parts; ++j) {
      const double s = (i + 0.5) * ds, z = 1 - 2 * s * s, phi = (j + 0.5) * dphi - pi, r = std::sqrt(1 - z * z);
      const Vec3 away = frame.to_world({r * std::cos(phi), r * std::sin(phi), z});
      power[static_cast<std::size_t>(i / parts * columns + j / parts)] +=
          irradiance_at(emitter, middle + away * far_m, -away, grid, random) * far_m * far_m * 4 * s * ds * dphi;
    }
  return power;
}

TEST(EveryLight, PhotonsCarryTheIntensityThatItsSamplesShow) {
  for (const LightCase& c : light_cases(2, 301)) {
    if (c.emitter->infinite()) continue;
    Random random(41);
    if (!photon_of(*c.emitter, random).valid) {
      EXPECT_TRUE(std::isinf(c.emitter->sample({}, {0.5, 0.5}).distance_m)) << c.name << " is near and emits nothing";
      continue;
    }
    PhotonBin every;
    const auto seen = photons_by_direction(*c.emitter, random, every);
    const auto power = power_by_direction(*c.emitter);
    double all = 0;
    for (const double p : power) all += p;
    ASSERT_GT(all, 0) << c.name;
    for (std::size_t i = 0; i < patches; ++i) {
      EXPECT_NEAR(seen[i].mean(draws), power[i], z_limit * seen[i].sigma(draws) + rule_error * power[i] + 1e-3 * all)
          << c.name << " patch " << i;
    }
    EXPECT_NEAR(every.mean(draws), all, z_limit * every.sigma(draws) + rule_error * all) << c.name;
  }
}

// Near the lamp, where its size matters: power through a window of the photons' own, against samples.
TEST(EveryLight, PhotonsCrossANearWindowAsItsSamplesSay) {
  for (const LightCase& c : light_cases(2, 302)) {
    const light::Emitter& emitter = *c.emitter;
    Random random(42);
    if (!photon_of(emitter, random).valid) continue;
    const Vec3 middle = middle_of(emitter);
    const auto aimed = photon_of(emitter, random);  // a place that is lit
    const Vec3 away = normalized(aimed.origin_m + aimed.direction * 1.6 - middle);
    const Window window{middle + away * 1.5, Basis(-away), 0.4};
    PhotonBin seen;
    for (int k = 0; k < draws; ++k) {
      const auto photon = photon_of(emitter, random);
      if (photon.valid && window.meets(photon)) seen.add(photon.flux.x);
    }
    const double expected = window.power(emitter, 16, 12);
    EXPECT_NEAR(seen.mean(draws), expected, z_limit * seen.sigma(draws) + rule_error * expected) << c.name;
  }
}

// A ray back along a photon meets the lamp where the photon began.
TEST(EveryLight, PhotonsLeaveFromWhereRaysMeetTheLamp) {
  Random random(43);
  for (const LightCase& c : light_cases(5, 303))
    for (int k = 0; k < 200; ++k) {
      const auto photon = photon_of(*c.emitter, random);
      if (!photon.valid || max_component(photon.flux) <= 0) continue;
      const auto hit = c.emitter->hit(photon.origin_m + photon.direction * 2.0, -photon.direction);
      if (max_component(hit.radiance) <= 0) {
        ASSERT_TRUE(c.emitter->sample(photon.origin_m + photon.direction, {0.5, 0.5}).delta) << c.name;
        continue;
      }
      ASSERT_NEAR(hit.distance_m, 2, 1e-6) << c.name;
    }
}

}  // namespace
}  // namespace gonio::tests
