// Thresholds: what they are, how sure they are, what they do to a length, and what is refused.
#include "volume/threshold.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/random.h"
#include "volume/phantoms.h"

namespace gonio::volume {
namespace {

using testing::HasSubstr;

Mixture two(double air, double object, double sd = 1) {
  Mixture m;
  m.materials = {{air, sd, 0.5, 0.3}, {object, sd, 0.5, 0.4}};
  return m;
}
Histogram histogram_of(const std::vector<float>& values, double low, double high, std::size_t bins) {
  Histogram h{low, high, std::vector<std::uint64_t>(bins)};
  h.smallest = 1e30, h.largest = -1e30;
  for (const double v : values) {
    const double b = (v - low) / (high - low) * static_cast<double>(bins);
    ++h.counts[static_cast<std::size_t>(std::clamp(b, 0.0, static_cast<double>(bins - 1)))];
    h.smallest = std::min(h.smallest, v), h.largest = std::max(h.largest, v);
  }
  return h;
}

TEST(Threshold, HalfWayLiesBetweenTheMeansAndIsAsSureAsTheyAre) {
  const Threshold t = half_way(two(12, 96), 0, 1);
  EXPECT_DOUBLE_EQ(t.value, 54);
  EXPECT_NEAR(t.sigma, 0.25, 1e-12);
  EXPECT_EQ(t.how, "half-way between 12 and 96");
}

TEST(Threshold, MaterialsThatAreNotThereAreRefused) {
  for (const auto& [lower, upper] : {std::pair<std::size_t, std::size_t>{1, 0}, {0, 2}, {1, 1}}) try {
      half_way(two(12, 96), lower, upper);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      EXPECT_THAT(e.what(), HasSubstr("the histogram shows 2"));
    }
  EXPECT_THROW(half_way(two(12, 12), 0, 1), Error);
}

TEST(Threshold, ConstantVolumesAreRefusedInALine) {
  try {
    otsu(histogram_of(std::vector<float>(100, 17), 0, 255, 256));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), HasSubstr("17"));
    EXPECT_THAT(std::string(e.what()), testing::Not(HasSubstr("\n")));
  }
}

// Means drawn again and again: the stated sigma is their scatter.
TEST(Threshold, OtsusUncertaintyIsItsScatter) {
  double sum = 0, squares = 0, stated = 0;
  constexpr int repeats = 120;
  for (int r = 0; r < repeats; ++r) {
    Random random(static_cast<std::uint64_t>(r), 3);
    std::vector<float> v;
    for (int n = 0; n < 600; ++n) v.push_back(static_cast<float>((n % 3 == 0 ? 10 : 20) + 2 * random.normal()));
    const Threshold t = otsu(histogram_of(v, 0, 30, 600));
    sum += t.value, squares += t.value * t.value, stated += t.sigma / repeats;
  }
  const double scatter = std::sqrt(squares / repeats - sum * sum / repeats / repeats);
  std::printf("otsu %.3f scatter %.4f stated %.4f\n", sum / repeats, scatter, stated);
  EXPECT_NEAR(sum / repeats, 15, 0.5);
  // The delta method sees the means alone; which voxels lie about the threshold scatters too.
  EXPECT_GT(stated, 0.4 * scatter);
  EXPECT_LT(stated, 2.5 * scatter);
}

// Noise that neighbours share makes means less sure than their number of voxels says: the slices know.
TEST(Threshold, SlicesTellHowSureMeansAre) {
  double squares = 0, stated = 0;
  constexpr int repeats = 25;
  for (int r = 0; r < repeats; ++r) {
    const auto source = phantom::in_memory(phantom::sampled(
        {12, 12, 40}, [](Vec3 p) { return p.x < 6 ? 10.0 : 30.0; }, 2, 0.6, 400 + r));
    const Threshold t = half_way(*source, two(10, 30, 2), 0, 1);
    squares += (t.value - 20) * (t.value - 20) / repeats, stated += t.sigma * t.sigma / repeats;
  }
  std::printf("half-way by slices: rms error %.4f stated %.4f\n", std::sqrt(squares), std::sqrt(stated));
  EXPECT_NEAR(std::sqrt(stated / squares), 1, 0.45);  // 25 repeats of 10 blocks: 3 sigma
}

TEST(Threshold, VoxelsPerValueIsTheMeanInverseGradient) {
  constexpr double w = 0.9;
  const Vec3 centre{20, 20.3, 19.7};
  const auto data = phantom::sampled(
      {40, 40, 40}, [&](Vec3 p) { return 100 * phantom::ball(p, centre, 13, w); }, 2, 0, 3);
  const auto h = histogram_of(data.values, -20, 120, 4096);
  const double per_value = voxels_per_value(h, phantom::sphere_surface(centre, 13), 50);
  EXPECT_NEAR(per_value, -w * std::sqrt(2 * pi) / 100, 0.12 * w * std::sqrt(2 * pi) / 100);
  EXPECT_THROW(voxels_per_value(h, {}, 50), Error);
  Threshold t;
  t.value = 60, t.sigma = 2, t.voxels_per_value = -0.02;
  EXPECT_NEAR(t.sigma_wall_voxels(), 0.04, 1e-12);
  Threshold exact = t;
  exact.voxels_per_value = -0.0;  // which would be printed with its sign
  EXPECT_FALSE(std::signbit(exact.sigma_wall_voxels()));
  EXPECT_NEAR(length_bias(t, 50), -0.4, 1e-12);  // too high a threshold: both walls stand back
}

TEST(ReferenceLength, SpheresOfKnownRadiusSetTheThreshold) {
  const Vec3 one{14, 14.3, 13.8}, other{14.4, 14, 36};
  const auto source = phantom::in_memory(phantom::sampled(
      {28, 28, 50}, [&](Vec3 p) { return 10 + 80 * (phantom::ball(p, one, 8, 0.8) + phantom::ball(p, other, 8, 0.8)); },
      3, 0.3, 4));
  // Radii that lie at 50 %, but for the shift of curved walls, and radii smaller by a quarter of a voxel.
  const std::vector<ReferenceSphere> spheres{{one, 8, 0.01}, {other, 8, 0.01}},
      smaller{{one, 7.75, 0.01}, {other, 7.75, 0.01}};
  const Threshold t = reference_length(*source, spheres), higher = reference_length(*source, smaller);
  std::printf("reference length %.2f +- %.2f, %.4f voxels per value; smaller %.2f\n", t.value, t.sigma,
              t.voxels_per_value, higher.value);
  EXPECT_NEAR(t.value, 50 - 0.08 * 80 / (0.8 * 2.5066), 1.5);  // w^2 / R = 0.08 voxel
  EXPECT_NEAR((higher.value - t.value) * t.voxels_per_value, -0.25, 0.03);
  EXPECT_GT(t.sigma, 0);
  EXPECT_THAT(t.how, HasSubstr("2 spheres"));
}

TEST(ReferenceLength, RadiiThatNoThresholdGivesAreRefused) {
  const Vec3 centre{14, 14, 14};
  const auto source =
      phantom::in_memory(phantom::sampled({28, 28, 28}, [&](Vec3 p) { return phantom::ball(p, centre, 8, 0.8); }));
  EXPECT_THROW(reference_length(*source, std::vector<ReferenceSphere>{{centre, 11, 0}}), Error);
  EXPECT_THROW(reference_length(*source, {}), Error);
}

}  // namespace
}  // namespace gonio::volume
