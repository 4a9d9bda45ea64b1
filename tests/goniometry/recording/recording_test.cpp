// A known surface as a goniometer sees it, beside a white tile that is not Lambertian, through a lens that distorts:
// the samples are the surface's within their uncertainties; what cannot count is dropped with its reason.
// One process: RecordingTest.*
#include "goniometry/sample/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "chi_square.h"
#include "data.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "recordings.h"

namespace gonio::goniometry {
namespace {

using tests::direction;

constexpr double radius_m = 0.005, beside_m = 0.0135, camera_m = 0.45, light_m = 0.5;
const Rigid<frame::World, frame::Object> world_from_sample{quaternion_of_rotation_vector({0.3, -0.2, 0.5}),
                                                           {0.1, 0.2, 0.3}};

void add_plate(manifest::Document& d, const std::string& name, Vec3 at_m) {
  manifest::Object object{.id = name, .mesh = "plate", .surface = name};
  auto& pose = object.world_from_object.emplace();
  pose.rotation = world_from_sample.rotation;
  pose.translation_m = world_from_sample * at_m;
  d.objects.push_back(object);
  d.goniometer[name].world_from_sample = pose;
  d.goniometer[name].radius_m = radius_m;
}

// The middle of the picture lies far from the lens' axis, where the distortion is strong.
void add_camera(manifest::Document& d) {
  manifest::Camera& camera = d.cameras["camera"];
  camera.model = "radial-tangential";
  camera.width_px = camera.height_px = 64;
  camera.fx_px = 900, camera.fy_px = 890;
  camera.cx_px = -330, camera.cy_px = 210;
  camera.distortion = {{"k1", -0.3}, {"k2", 0.12}, {"p1", 0.003}, {"p2", -0.002}};
}

void add_view(manifest::Document& d, const std::string& id, const tests::Lighted& view) {
  add_image(d, id, view, camera_m, {0, beside_m / 2, 0});
  auto& pose = *d.images.back().world_from_camera;
  const Vec3 seen = camera::CameraModel(d.cameras["camera"], "camera").ray({31.5, 31.5}).direction;
  const Vec3 axis = cross(seen, {0, 0, 1});
  const Quaternion aim = quaternion_of_rotation_vector(normalized(axis) * std::asin(norm(axis)));
  pose.rotation = normalized(world_from_sample.rotation * pose.rotation * aim);
  pose.translation_m = world_from_sample * pose.translation_m;
  d.images.back().noise = manifest::Noise{.gain = 2000, .read = 0.001};
}

manifest::Document scene() {
  manifest::Document d;
  d.meshes["plate"].plane_size_m = {0.013, 0.013};
  d.surfaces["sample"].model = d.surfaces["tile"].model = "coated-diffuse";
  d.surfaces["sample"].parameters = {{"albedo", std::vector<double>{0.5, 0.25, 0.1}}, {"f0", 0.05}, {"alpha", 0.25}};
  d.surfaces["tile"].parameters = {{"albedo", 0.95}, {"sigma_rad", 0.5}, {"f0", 0.03}, {"alpha", 0.4}};
  add_plate(d, "sample", {});
  add_plate(d, "tile", {0, beside_m, 0});
  d.goniometer["sample"].tile = "tile";
  d.goniometer["tile"].surface = "tile";
  add_camera(d);
  for (const int theta : {20, 45, 65}) {
    const std::string lamp = "lamp-" + std::to_string(theta);
    const Vec3 at = world_from_sample * (direction(theta * degree, 0) * light_m);
    d.lights[lamp].parameters = {{"position_m", std::vector<double>{at.x, at.y, at.z}},
                                 {"watt_per_sr", std::vector<double>{0.8, 1, 1.2}}};
    for (const int out : {10, 35, 60})
      for (const int phi : {30, 100, 180})
        add_view(d, lamp + "_" + std::to_string(out) + "_" + std::to_string(phi), {lamp, out * degree, phi * degree});
  }
  return d;
}

class RecordingTest : public testing::Test {
 protected:
  static const tests::Rendered& rendered() {
    static const tests::Rendered pictures = tests::render_all(scene(), 8);
    return pictures;
  }
  manifest::Document recorded(std::uint64_t seed, const tests::Spoil& spoil = {}, manifest::Document d = scene()) {
    tests::record(d, rendered(), folder_.path(), seed, spoil);
    return d;
  }
  static Rgb truth(const Samples& s, std::size_t row) {
    static const manifest::Document d = scene();
    const surface::Model& model = *surface::find("coated-diffuse");
    return model.evaluate(surface::values_of(model, d.surfaces.at("sample").parameters, ""), s.wo[row], s.wi[row]);
  }
  static std::vector<double> deviations(const Reduced& reduced) {
    std::vector<double> z;
    const Samples& s = reduced.samples;
    for (std::size_t r = 0; r < s.rows(); ++r)
      for (std::size_t b = 0; b < s.bands(); ++b)
        z.push_back((s.f[r * 3 + b] - truth(s, r)[static_cast<int>(b)]) / s.sigma[r * 3 + b]);
    return z;
  }
  // Both tails together wrong in 1 of 1000.
  static void expect_chi_square(const Reduced& reduced) {
    double sum = 0;
    const auto z = deviations(reduced);
    for (const double v : z) sum += v * v;
    const double p = tests::chi_square_tail(sum, z.size());
    EXPECT_GT(p, 5e-4) << sum << " of " << z.size();
    EXPECT_LT(p, 1 - 5e-4) << sum << " of " << z.size();
  }
  tests::ScratchFolder folder_;
};

TEST_F(RecordingTest, SamplesAreTheSurfaceWithinTheirUncertainty) {
  const Reduced reduced = reduce(recorded(1));
  EXPECT_EQ(reduced.samples.rows(), 27u);
  EXPECT_TRUE(reduced.dropped.empty()) << reduced.dropped.front().reason;
  expect_chi_square(reduced);
  EXPECT_EQ(*std::ranges::max_element(reduced.samples.series), 2u);
  EXPECT_EQ(reduced.readings[5].tile_image, reduced.readings[5].light + "_35_180");
  for (const Reading& reading : reduced.readings) {
    EXPECT_NEAR(reading.spread_i_rad, radius_m / 2 / light_m, 0.6 * radius_m / 2 / light_m);
    EXPECT_GT(reading.pixels, 16u);
  }
}

TEST_F(RecordingTest, DirectionsAreThoseOfThePlan) {
  const Reduced reduced = reduce(recorded(1));
  for (std::size_t r = 0; r < reduced.samples.rows(); ++r) {
    const double theta = std::acos(reduced.samples.wi[r].z), out = std::acos(reduced.samples.wo[r].z);
    const double plan[] = {20, 45, 65}, views[] = {10, 35, 60};
    EXPECT_NEAR(theta, plan[r / 9] * degree, 5e-4) << r;
    EXPECT_NEAR(out, views[r % 9 / 3] * degree, 0.02) << r;  // aimed between sample and tile
    EXPECT_NEAR(reduced.samples.wi[r].y, 0, 5e-4);
  }
}

// 10 recordings, 810 intervals of 95 %: 3.3 standard deviations of the count are 2.5 %, wrong in 1 of 1000.
TEST_F(RecordingTest, IntervalsCover) {
  int inside = 0, all = 0;
  for (std::uint64_t seed = 10; seed < 20; ++seed)
    for (const double z : deviations(reduce(recorded(seed)))) inside += std::abs(z) < 1.96, ++all;
  EXPECT_EQ(all, 810);
  EXPECT_NEAR(1.0 * inside / all, 0.95, 0.025);
}

// Some ten degrees of freedom each, 81 of them: a standard deviation of 3 % of the mean ratio of variances.
TEST_F(RecordingTest, WithoutStatedNoiseTheScatterStandsForIt) {
  manifest::Document d = recorded(1);
  const Reduced stated = reduce(d);
  for (auto& image : d.images) image.noise.reset();
  const Reduced reduced = reduce(d);
  ASSERT_EQ(reduced.samples.rows(), 27u);
  double ratio = 0;
  for (std::size_t i = 0; i < 81; ++i) ratio += std::pow(reduced.samples.sigma[i] / stated.samples.sigma[i], 2) / 81;
  EXPECT_NEAR(ratio, 1, 0.15);
  EXPECT_TRUE(std::isnan(reduced.readings[0].scatter));
  EXPECT_NE(reduced.notes.back().find("Noise is not stated"), std::string::npos);
}

TEST_F(RecordingTest, ATileTakenForLambertianBendsTheSamples) {
  manifest::Document d = recorded(1);
  d.goniometer["tile"].surface.clear();
  d.goniometer["tile"].reflectance = {0.95};
  double worst = 0;
  for (const double z : deviations(reduce(d))) worst = std::max(worst, std::abs(z));
  EXPECT_GT(worst, 10);
}

TEST_F(RecordingTest, TheTilesOwnUncertaintyIsCommonToAll) {
  manifest::Document d = recorded(1);
  const Reduced without = reduce(d);
  d.goniometer["tile"].relative_sigma = 0.02;
  const Reduced with = reduce(d);
  EXPECT_EQ(with.scale_sigma, std::vector<double>(3, 0.02));
  for (std::size_t i = 0; i < with.samples.f.size(); ++i)
    EXPECT_NEAR(with.samples.sigma[i], std::hypot(without.samples.sigma[i], 0.02 * with.samples.f[i]), 1e-12);
}

TEST_F(RecordingTest, OnePictureOfTheTilePerLightIsEnough) {
  manifest::Document d = recorded(1);
  for (const int theta : {20, 45, 65})
    d.goniometer["tile"].images.push_back("lamp-" + std::to_string(theta) + "_10_30");
  const Reduced reduced = reduce(d);
  EXPECT_EQ(reduced.samples.rows(), 27u);
  EXPECT_EQ(reduced.readings[5].tile_image, "lamp-20_10_30");
  double worst = 0;
  for (const double z : deviations(reduced)) worst = std::max(worst, std::abs(z));
  EXPECT_LT(worst, 4.5);  // 81 of them
}

TEST_F(RecordingTest, ACalibratedLightNeedsNoTile) {
  manifest::Document d = recorded(1);
  d.goniometer["sample"].tile.clear();
  const Reduced reduced = reduce(d);
  expect_chi_square(reduced);
  d.lights["lamp-20"].sigma["watt_per_sr"] = {0.008, 0.01, 0.012};
  EXPECT_NEAR(reduce(d).scale_sigma[0], 0.01, 1e-12);
}

// As explain has it: readings over a Lambertian tile's are 1 + incidence (1 - cos theta_i)^2 times too large.
TEST_F(RecordingTest, TheTilesMechanismIsUndone) {
  manifest::Document d = recorded(1);
  d.goniometer["tile"].surface.clear();
  d.goniometer["tile"].reflectance = {0.95, 0.94, 0.93};
  const Reduced plain = reduce(d);
  d.mechanisms["reference.tile"].parameters = {{"incidence", 0.3}, {"exitance", -0.2}};
  const Reduced bent = reduce(d);
  for (std::size_t r = 0; r < plain.samples.rows(); ++r) {
    const double in = 1 - plain.samples.wi[r].z, out = 1 - plain.samples.wo[r].z;
    const double expected = 1 / (1 + 0.3 * in * in - 0.2 * out * out);
    EXPECT_NEAR(bent.samples.f[3 * r] / plain.samples.f[3 * r] / expected, 1, 0.005);
  }
}

TEST_F(RecordingTest, MasksAndWeightsLeaveOut) {
  manifest::Document d = recorded(1);
  const Reduced plain = reduce(d);
  io::Image mask(64, 64, {"Y"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) mask.at(x, y, 0) = (x + y) % 2;
  io::write_picture(folder_ / "mask.exr", mask);
  d.images[0].mask = manifest::add_file(d, folder_ / "mask.exr", "mask");
  io::write_picture(folder_ / "dark.exr", io::Image(64, 64, {"Y"}));
  d.images[1].mask = manifest::add_file(d, folder_ / "dark.exr", "dark");
  d.images[2].weight = 0;
  const Reduced reduced = reduce(d);
  EXPECT_NEAR(1.0 * reduced.readings[0].pixels / plain.readings[0].pixels, 0.5, 0.1);
  EXPECT_NEAR(reduced.samples.f[0] / plain.samples.f[0], 1, 0.01);
  EXPECT_EQ(reduced.samples.rows(), 25u);
  EXPECT_EQ(reduced.dropped[0].reason.substr(0, 17), "too few pixels: 0");
  EXPECT_EQ(reduced.dropped[1].reason, "its weight is 0");
}

TEST_F(RecordingTest, ExposuresVignettingAndOffsetsAreUndone) {
  manifest::Document d = recorded(1);
  const Reduced plain = reduce(d);
  const auto spoil = [&](std::size_t i, io::Image& picture) {
    const double exposure_s = 0.1 * (1 + i % 3);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        for (int c = 0; c < 3; ++c)
          picture.at(x, y, c) =
              picture.at(x, y, c) * scene::vignetting(0.3, 64, 64, {1.0 * x, 1.0 * y}) * exposure_s + 0.01;
  };
  d = recorded(1, spoil);
  for (std::size_t i = 0; i < d.images.size(); ++i) d.images[i].exposure_s = 0.1 * (1 + i % 3);
  d.goniometer["sample"].values = d.goniometer["tile"].values = "exposure";
  d.goniometer["tile"].images = {"lamp-20_10_30", "lamp-45_10_30", "lamp-65_10_30"};
  d.mechanisms["optics.vignetting"].parameters["falloff"] = 0.3;
  d.mechanisms["sensor.black-offset"].parameters["offset"] = 0.01;
  const Reduced reduced = reduce(d);
  for (std::size_t i = 0; i < plain.samples.f.size(); ++i)
    EXPECT_NEAR(reduced.samples.f[i] / plain.samples.f[i], 1, 0.03) << i;
}

// The lamp warms up: its output falls by 20 % over the recording, and the tile is seen at both ends and in the middle.
TEST_F(RecordingTest, ALampThatDriftsIsFollowedByPicturesOfTheTile) {
  const auto output = [](std::size_t i) { return 1 - 0.2 * (i % 9) / 8.0; };
  manifest::Document d = recorded(1, [&](std::size_t i, io::Image& picture) {
    for (float& v : picture.data) v *= output(i);
  });
  for (std::size_t i = 0; i < d.images.size(); ++i) {
    d.images[i].time_s = 60.0 * i;
    if (i % 9 == 0 || i % 9 == 4 || i % 9 == 8) d.goniometer["tile"].images.push_back(d.images[i].id);
  }
  const Reduced reduced = reduce(d);
  double worst = 0;
  for (const double z : deviations(reduced)) worst = std::max(worst, std::abs(z));
  EXPECT_LT(worst, 4.5);
  EXPECT_TRUE(std::ranges::any_of(reduced.notes, [](const std::string& n) { return n.find("wandered") != n.npos; }));
}

std::map<std::string, std::string> reasons(const Reduced& reduced) {
  std::map<std::string, std::string> result;
  for (const Dropped& dropped : reduced.dropped) result[dropped.place] = dropped.reason;
  return result;
}

TEST_F(RecordingTest, WhatCannotCountIsDroppedWithItsReason) {
  // In the picture's middle lies the edge between sample and tile; the left part of the sample is darkened.
  const auto spoil = [&](std::size_t i, io::Image& picture) {
    const auto all = [&](auto change) {
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
          for (int c = 0; c < 3; ++c) change(x, y, picture.at(x, y, c));
    };
    if (i == 3) all([](int x, int, float& v) { v *= x < 28 ? 0.3f : 1.0f; });
    if (i == 4) all([](int, int, float& v) { v += 50; });
    if (i == 5) picture.at(20, 30, 1) = std::nanf(""), picture.at(44, 30, 1) = std::nanf("");
  };
  manifest::Document d = recorded(1, spoil);
  d.mechanisms["sensor.saturation"].parameters["full_scale"] = 50;
  auto& below = *d.images[7].world_from_camera;
  const Vec3 normal = world_from_sample.rotate({0, 0, 1});
  below.translation_m =
      below.translation_m - normal * (2 * dot(below.translation_m - world_from_sample.translation_m, normal));
  auto& away = *d.images[8].world_from_camera;
  away.rotation = normalized(away.rotation * quaternion_of_rotation_vector({0, 0.08, 0}));
  d.images[9].light = {"lamp-20", "lamp-45"};
  const Reduced reduced = reduce(d, {.max_theta_rad = 62 * degree});
  auto why = reasons(reduced);
  EXPECT_EQ(why["images/3"].substr(0, 28), "something is in front of the") << why["images/3"];
  EXPECT_NE(why["images/4"].find("saturated"), std::string::npos) << why["images/4"];
  EXPECT_NE(why["images/5"].find("no numbers"), std::string::npos) << why["images/5"];
  EXPECT_NE(why["images/7"].find("camera stands below"), std::string::npos) << why["images/7"];
  EXPECT_NE(why["images/8"].find("outside the picture"), std::string::npos) << why["images/8"];
  EXPECT_NE(why["images/9"].find("2 lights at once"), std::string::npos) << why["images/9"];
  for (int i = 18; i < 27; ++i)
    EXPECT_NE(why["images/" + std::to_string(i)].find("grazing: the light stands 65 degrees"), std::string::npos);
  EXPECT_EQ(why.size(), 15u);
  EXPECT_EQ(reduced.samples.rows(), 12u);
}

}  // namespace
}  // namespace gonio::goniometry
