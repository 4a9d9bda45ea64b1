// lib/probe/projection.h and remap.h: directions come back, and the sphere's light is the same in every projection.
#include "probe/remap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "light/light.h"

namespace gonio::probe {
namespace {

std::vector<Projection> all_projections() {
  return {Projection::lat_long, Projection::angular, Projection::mirror_ball, Projection::cube_cross,
          Projection::cube_strip};
}
// A bright sun of a few pixels over a smooth sky.
double sky(Vec3 d, int channel) {
  const Vec3 sun = normalized({0.5, -0.6, 0.4});
  return 1 + 0.5 * d.z + 0.3 * d.y * (channel + 1) + 2e4 * std::exp(-(1 - dot(d, sun)) / 2e-4);
}
io::Image drawn(const SphereMap& map) {
  io::Image picture(map.width, map.height, {"R", "G", "B"});
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      for (int c = 0; c < 3; ++c)
        if (const auto d = direction_at(map, {x + 0.5, y + 0.5}))
          picture.at(x, y, c) = static_cast<float>(sky(d->unit, c));
  return picture;
}
double integral(const io::Image& picture, const std::vector<double>& sr, int channel, Vec3* centroid = nullptr,
                const SphereMap* map = nullptr) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const double v = double{picture.data[i * picture.channels.size() + static_cast<std::size_t>(channel)]} * sr[i];
    sum += v;
    const int x = static_cast<int>(i % static_cast<std::size_t>(picture.width)),
              y = static_cast<int>(i / static_cast<std::size_t>(picture.width));
    if (centroid != nullptr)
      if (const auto d = direction_at(*map, {x + 0.5, y + 0.5})) *centroid += d->unit * v;
  }
  return sum;
}

TEST(Projection, PlacesAndDirectionsAreInverse) {
  Random random(3);
  for (const Projection p : all_projections()) {
    const SphereMap map = sized(p, 96);
    for (int k = 0; k < 500; ++k) {
      const Vec3 d = normalized({random.normal(), random.normal(), random.normal()});
      const auto back = direction_at(map, place_of(map, d));
      ASSERT_TRUE(back);
      EXPECT_LT(norm(back->unit - d), 1e-6);
    }
  }
}

TEST(Projection, MiddlesAndEdgesLookWhereTheyShould) {
  const auto look = [](Projection p, double x, double y) {
    const SphereMap map = sized(p, 12);
    return direction_at(map, {x * map.width, y * map.height})->unit;
  };
  const auto near = [](Vec3 a, Vec3 b) { return norm(a - b) < 1e-9; };
  EXPECT_TRUE(near(look(Projection::lat_long, 0.5, 0.5), {1, 0, 0}));
  EXPECT_TRUE(near(look(Projection::lat_long, 0.25, 0.5), {0, 1, 0}));
  EXPECT_TRUE(near(look(Projection::angular, 0.5, 0.5), {1, 0, 0}));
  EXPECT_TRUE(near(look(Projection::angular, 0.75, 0.5), {0, -1, 0}));
  EXPECT_TRUE(near(look(Projection::angular, 0.5, 0.25), {0, 0, 1}));
  EXPECT_TRUE(near(look(Projection::mirror_ball, 0.5, 0.5), {-1, 0, 0}));
  const double s = std::sqrt(0.5) / 2;  // the normal leans by 45 degrees
  EXPECT_TRUE(near(look(Projection::mirror_ball, 0.5 + s, 0.5), {0, -1, 0}));
  EXPECT_TRUE(near(look(Projection::mirror_ball, 0.5, 0.5 - s), {0, 0, 1}));
  EXPECT_TRUE(near(look(Projection::cube_cross, 3.0 / 8, 0.5), {1, 0, 0}));
  EXPECT_TRUE(near(look(Projection::cube_cross, 5.0 / 8, 0.5), {0, -1, 0}));
  EXPECT_TRUE(near(look(Projection::cube_cross, 3.0 / 8, 1.0 / 6), {0, 0, 1}));
  EXPECT_TRUE(near(look(Projection::cube_strip, 1.0 / 12, 0.5), {0, -1, 0}));
}

// The axes are those of the light "lat-long" that render uses.
TEST(Projection, LatLongIsTheLights) {
  const SphereMap map = sized(Projection::lat_long, 8);
  auto picture = std::make_shared<io::Image>(map.width, map.height, std::vector<std::string>{"Y"});
  for (std::size_t i = 0; i < picture->data.size(); ++i) picture->data[i] = static_cast<float>(i);
  light::Attachment file;
  file.picture = picture;
  const auto emitter = light::find("lat-long")->prepare({}, file, "test");
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      EXPECT_EQ(emitter->hit({}, direction_at(map, {x + 0.5, y + 0.5})->unit).radiance.x, picture->at(x, y, 0));
}

TEST(Remap, SolidAnglesSumToTheSphereAndFollowTheDensity) {
  for (const Projection p : all_projections()) {
    const SphereMap map = sized(p, 60);
    const std::vector<double> sr = solid_angles(map);
    double sum = 0;
    for (const double s : sr) sum += s;
    EXPECT_NEAR(sum, 4 * pi, 1e-9);
    const auto i = static_cast<std::size_t>((map.height / 2 + 3) * map.width + map.width * 3 / 8 + 2);
    const auto d = direction_at(map, {map.width * 3 / 8 + 2.5, map.height / 2 + 3.5});
    EXPECT_NEAR(sr[i], d->sr_per_px, 3e-3 * d->sr_per_px);
  }
}

TEST(Remap, IntegralsAndCentroidsAreKept) {
  for (const Projection from : all_projections())
    for (const Projection to : all_projections()) {
      const SphereMap a = sized(from, 60), b = sized(to, 51);
      const io::Image source = drawn(a), result = remapped(source, a, b);
      const std::vector<double> sr_a = solid_angles(a), sr_b = solid_angles(b);
      for (int c = 0; c < 3; ++c) {
        Vec3 before, after;
        const double wanted = integral(source, sr_a, c, &before, &a), found = integral(result, sr_b, c, &after, &b);
        EXPECT_NEAR(found, wanted, 1e-5 * wanted);
        // The sun is smaller than a pixel: its place is a pixel's.
        EXPECT_LT(norm(normalized(before) - normalized(after)), 0.7 * pi / 51) << int(from) << " to " << int(to);
      }
    }
}

TEST(Remap, AConstantStaysConstant) {
  for (const Projection from : all_projections())
    for (const Projection to : all_projections()) {
      const SphereMap a = sized(from, 48), b = sized(to, 54);
      io::Image source(a.width, a.height, {"Y"});
      for (float& v : source.data) v = 3;
      const io::Image result = remapped(source, a, b);
      const std::vector<double> sr = solid_angles(b);
      double worst = 0;
      for (std::size_t i = 0; i < result.pixels(); ++i)
        if (sr[i] > 1e-5) worst = std::max(worst, std::abs(result.data[i] / 3.0 - 1));
      EXPECT_LT(worst, 1e-3) << int(from) << " to " << int(to);
    }
}

TEST(Remap, RefusesOtherShapes) {
  EXPECT_THROW(check_shape({Projection::lat_long, 100, 60}, "x"), Error);
  EXPECT_THROW(check_shape({Projection::angular, 100, 60}, "x"), Error);
  EXPECT_THROW(check_shape({Projection::cube_cross, 400, 400}, "x"), Error);
  EXPECT_NO_THROW(check_shape({Projection::cube_cross, 400, 300}, "x"));
}

}  // namespace
}  // namespace gonio::probe
