// Passes: sums join exactly, however they were cut; their variance is honest; pictures stop when they should.
#include "render/passes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "made_up_integrator.h"
#include "render/film.h"
#include "render/stopping.h"
#include "stats/distributions.h"

namespace gonio::render {
namespace {

using tests::made_up_identity;
using tests::made_up_passes;
using tests::MadeUpIntegrator;

TEST(Passes, EverySplitOfARangeGivesTheSamePicture) {
  for (const bool splats : {false, true}) {
    MadeUpIntegrator integrator;
    integrator.splats = splats;
    constexpr std::uint32_t passes = 6;
    const io::Image whole = develop(made_up_passes(integrator, 0, passes), {});
    for (unsigned cuts = 0; cuts < 1u << (passes - 1); ++cuts) {
      PassSums joined(made_up_identity(integrator));
      for (std::uint32_t first = 0, next = 1; next <= passes; ++next)
        if (next == passes || ((cuts >> (next - 1)) & 1u) != 0) {
          joined.append(made_up_passes(integrator, first, next - first));
          first = next;
        }
      const io::Image picture = develop(joined, {});
      ASSERT_EQ(picture.channels, whole.channels);
      ASSERT_EQ(picture.data, whole.data) << "cuts " << cuts;
    }
  }
}

TEST(Passes, AreTheSameWhateverTheThreadsAndTheCalls) {
  MadeUpIntegrator integrator;
  integrator.splats = true;
  set_threads(1);
  const io::Image one = develop(made_up_passes(integrator, 0, 5), {});
  set_threads(3);
  PassSums sums(made_up_identity(integrator));
  for (int i = 0; i < 5; ++i) add_passes(integrator, sums, 1, nullptr);
  EXPECT_EQ(develop(sums, {}).data, one.data);
  set_threads(0);
}

TEST(Passes, ChannelsOfAllPlanes) {
  const MadeUpIntegrator integrator;
  io::Image geometry(24, 16, {"id", "depth.Z"});
  for (std::size_t i = 0; i < geometry.data.size(); ++i) geometry.data[i] = static_cast<float>(i);
  const io::Image image = develop(made_up_passes(integrator, 0, 4), geometry);
  EXPECT_THAT(image.channels,
              testing::ElementsAre("R", "G", "B", "variance.R", "variance.G", "variance.B", "light.lamp.R",
                                   "light.lamp.G", "light.lamp.B", "s1.R", "s1.G", "s1.B", "variance.s1.R",
                                   "variance.s1.G", "variance.s1.B", "id", "depth.Z", "visibility.lamp", "mask.A"));
  EXPECT_EQ(geometry_of(image).channels, geometry.channels);
  EXPECT_EQ(geometry_of(image).data, geometry.data);
  // In a lit pixel every sample meets something, and half of them, stratified, see the lamp; in a black one none does.
  EXPECT_EQ(image.at(20, 3, image.channel("visibility.lamp")), 0.5f);
  EXPECT_EQ(image.at(20, 3, image.channel("mask.A")), 1);
  EXPECT_EQ(image.at(2, 3, image.channel("mask.A")), 0);
  EXPECT_NEAR(image.at(20, 3, image.channel("light.lamp.G")), 0.25 * image.at(20, 3, 0), 1e-7);
  EXPECT_THAT(plane_channels("S0.400,0nm S0.450,0nm -"), testing::ElementsAre("S0.400,0nm", "S0.450,0nm"));
}

// Light-traced passes: the mean of what the fake lights throw is 0.5 in every pixel, the variance joins theirs.
TEST(Passes, SplatsEnterMeansAndVariances) {
  MadeUpIntegrator integrator;
  const io::Image without = develop(made_up_passes(integrator, 0, 64), {});
  integrator.splats = true;
  const io::Image with = develop(made_up_passes(integrator, 0, 64), {});
  double sum = 0, variance = 0, z_squares = 0;
  for (std::size_t i = 0; i < with.data.size(); i += with.channels.size()) {
    const double d = with.data[i] - without.data[i] - 0.5;
    const double own = with.data[i + 3] - without.data[i + 3];
    sum += d;
    variance += own;
    z_squares += d * d;
    EXPECT_GT(with.data[i + 3], 0);
  }
  EXPECT_LT(std::abs(sum), 4.5 * std::sqrt(variance));
  EXPECT_NEAR(z_squares / variance, 1, 0.35);  // 384 pixels: standard deviation 0.072
}

// z of pixel means against the known truth, with few passes, is Student's t with passes - 1 degrees of freedom. The
// share beyond the 95 % point, over 256 lit pixels times 16 seeds: 5 % with a standard deviation of 0.34 %; limits at
// 4.4 of them.
TEST(Passes, StatedErrorsAreStudentsWithFewPasses) {
  const MadeUpIntegrator integrator;
  for (const std::uint32_t passes : {2u, 3u, 4u, 16u}) {
    const double limit = stats::student_quantile(0.975, passes - 1);
    int beyond = 0, all = 0;
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
      PictureIdentity identity = made_up_identity(integrator, 16);
      identity.seed = seed;
      PassSums sums(identity);
      add_passes(integrator, sums, passes, nullptr);
      for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel) {
        const double x = static_cast<double>(pixel % 24), truth = MadeUpIntegrator::mean({x, 0});
        if (truth == 0) continue;
        ++all;
        if (std::abs(sums.mean(pixel, 0).x - truth) > limit * std::sqrt(sums.variance(pixel, 0).x)) ++beyond;
      }
    }
    EXPECT_NEAR(beyond / static_cast<double>(all), 0.05, 0.015) << passes << " passes";
  }
}

TEST(RelativeError, LeavesOutWhatIsBlackAndIsTheRootMeanSquareOfTheRest) {
  const MadeUpIntegrator integrator;
  const PassSums sums = made_up_passes(integrator, 0, 2000, 1);
  // Channels R and G have half the mean as their sigma, B is v * 2u: 5/4 * 4/3 - 1 = 2/3 of the squared mean.
  EXPECT_NEAR(relative_error(sums), std::sqrt((0.25 + 0.25 + 2.0 / 3) / 3 / 2000), 0.01 * 0.014);
  EXPECT_TRUE(std::isnan(relative_error(made_up_passes(integrator, 0, 1))));
}

// The true relative error is what --noise stated: over 40 seeds the mean of (true / stated)^2 is 1 within 4 standard
// errors, found from the seeds themselves, and half a percent for looking after every pass.
TEST(Stopping, TheErrorReachedIsTheErrorStated) {
  const MadeUpIntegrator integrator;
  std::vector<double> ratios;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    PictureIdentity identity = made_up_identity(integrator);
    identity.seed = seed;
    PassSums sums(identity);
    const Goal goal{.end_pass = 4000, .time_s = {}, .relative_error = 0.02};
    ASSERT_EQ(render_until(integrator, sums, goal), Reached::noise);
    EXPECT_LE(relative_error(sums), 0.02);
    double square = 0;
    int count = 0;
    for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel) {
      const double truth = MadeUpIntegrator::mean({static_cast<double>(pixel % 24), 0});
      if (truth == 0) continue;
      const Rgb mean = sums.mean(pixel, 0), wanted{truth, 0.5 * truth, truth};
      for (const double e : {mean.x / wanted.x - 1, mean.y / wanted.y - 1, mean.z / wanted.z - 1}) square += e * e;
      count += 3;
    }
    ratios.push_back(square / count / (0.02 * 0.02));
  }
  double mean = 0, variance = 0;
  for (const double r : ratios) mean += r / 40;
  for (const double r : ratios) variance += (r - mean) * (r - mean) / 39 / 40;
  RecordProperty("true_over_stated_variance", std::to_string(mean));
  EXPECT_NEAR(mean, 1, 4 * std::sqrt(variance) + 0.005);
  EXPECT_LT(std::sqrt(variance), 0.05);
}

TEST(Stopping, NoiseIsBoundedBySamples) {
  const MadeUpIntegrator integrator;
  PassSums sums(made_up_identity(integrator));
  EXPECT_EQ(render_until(integrator, sums, {.end_pass = 10, .time_s = {}, .relative_error = 1e-6}), Reached::samples);
  EXPECT_EQ(sums.passes(), 10u);
}

// A clock of the test's own: three seconds every time it is read.
TEST(Stopping, TimeEndsAfterThePassDuringWhichItRunsOut) {
  const MadeUpIntegrator integrator;
  const auto passes_in = [&](double time_s, double spent_s) {
    PassSums sums(made_up_identity(integrator));
    double now_s = 100;
    std::vector<std::pair<std::uint32_t, double>> rounds;
    Watch watch{.clock = [&] { return now_s += 3; },
                .spent_s = spent_s,
                .on_round = [&](const PassSums& s, double t) { rounds.emplace_back(s.passes(), t); }};
    EXPECT_EQ(render_until(integrator, sums, {.end_pass = 1000, .time_s = time_s, .relative_error = {}}, watch),
              Reached::time);
    EXPECT_EQ(rounds.back().first, sums.passes());
    EXPECT_GE(rounds.back().second, time_s);
    if (rounds.size() > 2) {
      EXPECT_LT(rounds[rounds.size() - 2].second, time_s);
    }
    return sums.passes();
  };
  EXPECT_EQ(passes_in(30, 0), 10u);
  EXPECT_EQ(passes_in(31, 0), 11u);
  EXPECT_EQ(passes_in(30, 12), 6u);    // a call that goes on after 12 s
  EXPECT_EQ(passes_in(0.001, 0), 2u);  // the least that has a variance
}

}  // namespace
}  // namespace gonio::render
