// light-probe --lights and --each, from GONIO_BIN: lamps of a photometric stereo set, near lamps of simulated scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "probe_scene.h"

namespace gonio::tests {
namespace {

// Its directions lie by 3.0 degrees in the mean, and 8.3 at most, from those that the set supplies, which are known to
// be inexact; the README's circle and the supplied silhouette differ by a quarter of a pixel.
TEST(PhotometricStereo, ChromeBallSaysWhereTheLampsWere) {
  GONIO_NEEDS_DATA("photometric/uw-psm");
  const ScratchFolder folder;
  const auto set = data("photometric/uw-psm");
  std::vector<std::string> words{
      "light-probe", "--orthographic", "--each",  "--silhouette", (set / "chrome/chrome.mask.png").string(),
      "--response",  "linear",         "--metal", "none",         "--out",
      "u",           "--log-level",    "error"};
  for (int k = 0; k < 12; ++k) words.push_back((set / "chrome" / format("chrome.%d.png", k)).string());
  const Ended ended = run(words, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Document d = manifest::parse_document(ended.out, "out", folder.path(), {true});
  std::istringstream supplied(read_file(set / "lights.txt"));
  int count = 0;
  supplied >> count;
  ASSERT_EQ(count, 12);
  double sum = 0, most = 0;
  for (int k = 0; k < count; ++k) {
    Vec3 there;  // x right, y up, z to the camera; the world's x goes into the picture, y to its left, z up
    supplied >> there.x >> there.y >> there.z;
    const manifest::Light& light = d.lights.at(format("probe-chrome.%d-1", k));
    ASSERT_EQ(light.model, "directional");
    const Vec3 found = light.parameters.at("towards").vector();
    const double off = angle_between(found, {-there.z, -there.x, there.y}) * 180 / pi;
    sum += off / count, most = std::max(most, off);
    const std::vector<double>& sigma = light.sigma.at("towards");
    const double degrees = std::sqrt(sigma[0] * sigma[0] + sigma[1] * sigma[1] + sigma[2] * sigma[2]) * 180 / pi;
    EXPECT_GT(degrees, 0.05);
    EXPECT_LT(degrees, 1);
    ASSERT_FALSE(d.images[static_cast<std::size_t>(k)].light.empty());
    EXPECT_EQ(d.images[static_cast<std::size_t>(k)].light.front(), format("probe-chrome.%d-1", k));
  }
  std::printf("uw-psm: mean %.2f, largest %.2f degrees\n", sum, most);
  EXPECT_NEAR(sum, 3.0, 0.3);
  EXPECT_NEAR(most, 8.3, 0.6);
}

class NearLamp : public testing::Test {
 protected:
  // Silhouettes as a mask that was measured would be: the share of each pixel that the ball covers.
  void photograph(ProbeWorld world, const char* spp) {
    world.lights = format(
        R"({"sky": {"model": "lat-long", "file": "sky"}, "lamp": {"model": "sphere", "position_m": [%g, %g, %g],
  "watt_per_sr": 0.06, "radius_m": 0.012}})",
        lamp_.x, lamp_.y, lamp_.z);
    io::Image grey(8, 4, {"R", "G", "B"});
    for (float& v : grey.data) v = 0.3f;
    io::write_picture(folder_ / "sky.exr", grey);
    write_metal(folder_ / "metal.yml");
    write_file(folder_ / "scene.json", scene_text(world));
    const Ended ended = run({"render", "scene.json", "--spp", spp, "--out", "r"}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
    write_file(folder_ / "in.json", recorded(scene_text(world), world.eyes.size()));
    for (std::size_t v = 0; v < world.eyes.size(); ++v) {
      const io::Image picture = io::read_picture(folder_ / format("r/v%zu.exr", v));
      io::Image mask(picture.width, picture.height, {"Y"});
      for (std::size_t i = 0; i < mask.pixels(); ++i)
        mask.data[i] = picture.data[i * picture.channels.size() + static_cast<std::size_t>(picture.channel("mask.A"))];
      io::write_picture(folder_ / format("s%zu.exr", v), mask);
    }
  }
  // Distance error over the lamp's distance from the origin, and the position in its standard deviations.
  void expect_found(const Ended& ended) {
    ASSERT_EQ(ended.status, 0) << ended.err;
    const manifest::Document d = manifest::parse_document(ended.out, "out", folder_.path());
    ASSERT_TRUE(d.lights.contains("probe-1"));
    const manifest::Light& light = d.lights.at("probe-1");
    ASSERT_EQ(light.model, "point") << ended.err;
    const Vec3 off = light.parameters.at("position_m").vector() - lamp_;
    const std::vector<double>& sigma = light.sigma.at("position_m");
    std::printf("near lamp: off by %.2f mm of %.0f (%.2f %%), sigma %.2f %.2f %.2f mm, %.4f W/sr, radius %.1f mm\n",
                1e3 * norm(off), 1e3 * norm(lamp_), 100 * norm(off) / norm(lamp_), 1e3 * sigma[0], 1e3 * sigma[1],
                1e3 * sigma[2], light.parameters.at("watt_per_sr").rgb().y,
                1e3 * light.parameters.at("radius_m").scalar());
    EXPECT_LT(norm(off), 0.01 * norm(lamp_));
    for (int c = 0; c < 3; ++c) EXPECT_LT(std::abs(off[c]), 4 * sigma[static_cast<std::size_t>(c)]);
    EXPECT_NEAR(light.parameters.at("watt_per_sr").rgb().y, 0.06, 0.06 * 0.04);
    EXPECT_NEAR(light.parameters.at("radius_m").scalar(), 0.012, 0.002);
  }
  const Vec3 lamp_ = normalized(Vec3{-0.5, 0.35, 0.6}) * 0.5;
  ScratchFolder folder_;
};

TEST_F(NearLamp, TwoBallsInOnePhotographSayWhereItIs) {
  ProbeWorld world;
  world.eyes = {{-0.6, 0, 0.05}};
  world.balls = {{0, 0.1, 0}, {0, -0.1, 0}};
  world.pixels = 1000, world.rows = 250, world.focal_px = 2000;
  photograph(world, "64");
  expect_found(run({"light-probe", "--metal", "metal.yml", "--radius", "30mm", "--balls", "2", "--silhouette", "s0.exr",
                    "--lights", "--columns", "64", "--out", "p", "in.json"},
                   folder_.path()));
}

TEST_F(NearLamp, TwoViewsOfOneBallSayWhereItIs) {
  ProbeWorld world;
  world.eyes = {{-0.46, -0.16, 0.08}, {-0.08, 0.42, 0.27}};
  world.balls = {{}};
  world.radius_m = 0.05;
  world.pixels = 520, world.focal_px = 2000;
  photograph(world, "20");
  expect_found(run({"light-probe", "--metal", "metal.yml", "--radius", "50mm", "--silhouette", "s0.exr", "--silhouette",
                    "s1.exr", "--lights", "--columns", "64", "--out", "p", "in.json"},
                   folder_.path()));
}

}  // namespace
}  // namespace gonio::tests
