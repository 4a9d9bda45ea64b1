// Edges of shadows and sizes of lamps: against profiles in closed form and penumbrae filled by another raster.
#include "alignment/lamp_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "alignment/edge_spread.h"
#include "alignment_world.h"

namespace gonio::alignment {
namespace {

// Light beside a straight edge through the middle of the picture, turned by `turn`, under a lamp that moves it by up to
// w: strips of the disc, summed, and a lens' Gaussian.
Luminance edge(double w, double blur, double turn, double noise) {
  constexpr int size = 160;
  std::mt19937_64 random(5);
  std::normal_distribution<double> grain(0, noise);
  std::vector<float> value(size * size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double t = (x - 79.3) * std::cos(turn) + (y - 80.1) * std::sin(turn);
      double sum = 0, weights = 0;
      for (int k = 0; k < 400; ++k) {
        const double u = (k + 0.5) / 200 - 1, weight = std::sqrt(1 - u * u);
        sum += weight * 0.5 * std::erfc(-(t - w * u) / (std::sqrt(2.0) * blur)), weights += weight;
      }
      value[static_cast<std::size_t>(y * size + x)] = static_cast<float>(0.2 + 0.7 * sum / weights + grain(random));
    }
  return {size, size, std::move(value)};
}

double measured(const Luminance& picture, double turn) {
  RimPoint point;
  point.outward = {std::cos(turn), std::sin(turn)}, point.pixel = Vec2{79.3, 80.1} + point.outward * 0.4;
  return edge_spreads(picture, std::vector{point}, [](Vec2) { return false; })[0];
}

TEST(EdgeSpread, IsTheDiscsAndTheLensTogether) {
  for (const double w : {2.0, 6.0, 16.0, 24.0})
    for (const double turn : {0.0, 0.4, 2.2})
      EXPECT_NEAR(measured(edge(w, 0.6, turn, 0), turn), std::hypot(0.5 * w, 0.6), 0.08 + 0.02 * w) << w << " " << turn;
  EXPECT_NEAR(measured(edge(1e-6, 1.5, 0.4, 0), 0.4), 1.5, 0.4);  // its tails are lost in the slope
}

TEST(EdgeSpread, IsNotToldWhereNoEdgeIsOrTheShadowIsBright) {
  EXPECT_TRUE(std::isnan(measured(edge(6, 0.6, 0, 0), pi)));      // brighter inside
  EXPECT_TRUE(std::isnan(measured(edge(6, 0.6, 0, 0), pi / 2)));  // along the edge
  EXPECT_TRUE(std::isnan(measured(edge(6, 0.6, 0, 0.3), 0.0)));   // noise
  EXPECT_TRUE(std::isnan(measured(edge(120, 0.6, 0, 0), 0.0)));   // wider than the window can be
}

// The world's pictures under lamps of `radius_m`: what is left of the light, from random places of each lamp's disc.
void measure_edges(testing::World& world, double radius_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr int draws = 96, factor = 3;
  for (std::size_t k = 0; k < world.input.rims.size(); ++k) {
    const RimSubject& subject = world.input.question.sightings[k].subject;
    if (!subject.lamp) continue;
    const int width = world.input.models[0].width_px(), height = world.input.models[0].height_px();
    std::vector<float> light(static_cast<std::size_t>(width * height), 1);
    const Vec3 lamp = world.truth.lamps_m[*subject.lamp];
    const Basis across(normalized(lamp - world.truth.bodies[0].centre_m()));
    for (int draw = 0; draw < draws; ++draw) {
      Setting here = world.truth;
      const double r = radius_m * std::sqrt((draw + uniform(random)) / draws), turn = 2 * pi * uniform(random);
      here.lamps_m[*subject.lamp] = lamp + across.t * (r * std::cos(turn)) + across.b * (r * std::sin(turn));
      const auto fine = testing::filled(here, subject, width, height, factor);
      for (int y = 0; y < height * factor; ++y)
        for (int x = 0; x < width * factor; ++x)
          if (fine[static_cast<std::size_t>(y * width * factor + x)] != 0)
            light[static_cast<std::size_t>(y / factor * width + x / factor)] -= 0.8F / (draws * factor * factor);
    }
    world.input.rims[k].spread_px =
        edge_spreads(Luminance(width, height, std::move(light)), world.input.rims[k].in_picture, [&](Vec2 pixel) {
          return world.input.question.sightings[k].unseen && world.input.question.sightings[k].unseen(pixel);
        });
  }
}

TEST(LampSize, IsFoundByTheWidthOfPenumbrae) {
  for (const std::size_t solid : {0, 2, 5}) {
    testing::World world = testing::world_of(
        {.solid = solid, .views = 2, .lamps = 1, .seed = 7 + solid, .error_px = 0, .outliers = 0, .size_px = 320});
    measure_edges(world, 0.02, solid);
    const LampSize size = lamp_sizes(world.input, world.truth)[0];
    EXPECT_TRUE(size.told()) << solid;
    EXPECT_NEAR(size.radius_m, 0.02, 0.0015) << solid << " +- " << size.sigma_m << ", edges " << size.edges;
  }
}

TEST(LampSize, OfAPointIsNothing) {
  testing::World world =
      testing::world_of({.solid = 2, .views = 2, .lamps = 1, .seed = 3, .error_px = 0, .outliers = 0, .size_px = 320});
  measure_edges(world, 1e-9, 1);
  const LampSize size = lamp_sizes(world.input, world.truth)[0];
  EXPECT_GT(size.edges, 20U);
  EXPECT_LT(size.radius_m, 0.003);
}

}  // namespace
}  // namespace gonio::alignment
