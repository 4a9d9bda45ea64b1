// light-probe --scale, from GONIO_BIN: balls and a white tile by the path tracer, the tile's photograph at another
// exposure; and render, which shows the tile again as bright as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manifest/document.h"
#include "manifest/sections/environment.h"
#include "manifest/sections/light.h"
#include "probe_scene.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

constexpr double exposure = 0.37, reflectance = 0.9;

class ScaledTo : public testing::Test {
 protected:
  // Two views of a ball, a third one with 2.5 times the exposure, and a tile in its place with 0.37 times.
  void SetUp() override {
    world_.eyes = {{-0.3, 0, 0.05}, {0.17, 0.25, 0.1}, {0.13, -0.27, 0.06}};
    world_.balls = {{}};
    world_.pixels = 200, world_.focal_px = 550;
    write_surroundings(folder_ / "sky.exr", 256);
    write_metal(folder_ / "metal.yml");
    write_file(folder_ / "scene.json", scene_text(world_));
    render("scene.json", "r", "8");
    expose("r/v2.exr", 2.5);
    write_file(folder_ / "tile.json", manifest(false));
    render("tile.json", "t", "64");
    expose("t/tile.exr", exposure);
    write_file(folder_ / "in.json", manifest(true));
  }
  void render(const std::string& scene, const std::string& out, const std::string& spp) const {
    const Ended ended = run({"render", scene, "--spp", spp, "--aov", "off", "--out", out, "--force"}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
  }
  void expose(const std::string& name, double factor) const {
    const io::Image all = io::read_picture(folder_ / name);
    io::Image picture(all.width, all.height, {"R", "G", "B"});
    for (int y = 0; y < all.height; ++y)
      for (int x = 0; x < all.width; ++x)
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(factor * double{all.at(x, y, c)});
    io::write_picture(folder_ / name, picture);
  }
  // The tile alone as an object under the sky; with `recordings`, all photographs and no light.
  std::string manifest(bool recordings) const {
    std::string text = R"({"gonio": 1, "files": {"sky": {"path": "sky.exr"})";
    if (recordings)
      text += R"(, "v0": {"path": "r/v0.exr"}, "v1": {"path": "r/v1.exr"}, "v2": {"path": "r/v2.exr"},
  "tile": {"path": "t/tile.exr"})";
    text += R"(}, "cameras": {"t": {"model": "pinhole", "width_px": 60, "height_px": 60, "fx_px": 200, "fy_px": 200,
  "cx_px": 29.5, "cy_px": 29.5}, )" +
            scene_text(world_).substr(scene_text(world_).find("\"c\": {"));
    text = text.substr(0, text.find("\"meshes\""));
    text += R"("meshes": {"tile": {"plane": {"size_m": [0.12, 0.12]}}}, "surfaces": {"white": {"model": "diffuse",
  "albedo": )" +
            format("%g", reflectance) + R"(}}, "objects": [{"id": "tile", "mesh": "tile", "surface": "white",
  "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0]}}], "goniometer": {"white": {
  "world_from_sample": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0]}, "relative_sigma": 0.005,
  "polygon_m": [[-0.04, -0.04], [0.04, -0.04], [0.04, 0.04], [-0.04, 0.04]], "reflectance": [)" +
            format("%g", reflectance) + R"(]}}, "images": [)";
    if (recordings)
      for (std::size_t v = 0; v < 3; ++v)
        text += format(R"({"id": "v%zu", "camera": "c", "file": "v%zu", "world_from_camera": )", v, v) +
                pose(world_.eyes[v], {}) + "}, ";
    else
      text.insert(text.find("\"objects\""), R"("lights": {"sky": {"model": "lat-long", "file": "sky"}}, )");
    return text + R"({"id": "tile", "camera": "t", )" + (recordings ? R"("file": "tile", )" : "") +
           "\"world_from_camera\": " + pose({0.1, -0.15, 0.45}, {}) + "}]}";
  }
  Ended probe(std::vector<std::string> words) const {
    words.insert(words.begin(), {"light-probe", "--metal", "metal.yml", "--camera-radius", "0m", "--columns", "256",
                                 "--circle", "99.5,99.5,56", "--radius", "30mm", "--out", "p", "--force", "in.json"});
    return run(words, folder_.path());
  }
  ProbeWorld world_;
  ScratchFolder folder_;
};

TEST_F(ScaledTo, AWhiteTileOrTheSameBall) {
  for (const bool lights : {false, true}) {
    std::vector<std::string> words{"--image", "v0", "--image", "v1", "--scale", "tile", "--tile", "white"};
    if (lights) words.insert(words.end(), {"--lights"});
    const Ended ended = probe(words);
    ASSERT_EQ(ended.status, 0) << ended.err;
    const manifest::Document d = manifest::parse_document(ended.out, "out", folder_.path());
    const manifest::Environment& room = d.environments.at("probe");
    EXPECT_EQ(d.lights.at("probe").environment, "probe");
    const double scale = *room.scale, sigma = room.sigma.at("scale").at(0);
    std::printf("by the tile%s: %.4f +- %.4f (%.4f)\n", lights ? ", lamps apart" : "", scale, sigma, exposure);
    EXPECT_NEAR(scale, exposure, 3 * sigma);
    EXPECT_LT(sigma, 0.03 * exposure);
    EXPECT_THAT(ended.err, HasSubstr("probe: scale 0.3"));
    // The tile again, as bright as its photograph.
    write_file(folder_ / "found.json", ended.out);
    render("found.json", "again", "64");
    const io::Image before = io::read_picture(folder_ / "t/tile.exr"),
                    after = io::read_picture(folder_ / "again/tile.exr");
    double old_light = 0, new_light = 0;
    for (int y = 20; y < 40; ++y)
      for (int x = 20; x < 40; ++x) old_light += double{before.at(x, y, 1)}, new_light += double{after.at(x, y, 1)};
    EXPECT_NEAR(new_light / old_light, 1, 0.02);
  }
  const Ended by_ball = probe({"--image", "v0", "--image", "v1", "--scale", "v2"});
  ASSERT_EQ(by_ball.status, 0) << by_ball.err;
  const manifest::Document d = manifest::parse_document(by_ball.out, "out", folder_.path());
  const manifest::Environment& room = d.environments.at("probe");
  std::printf("by the ball: %.4f +- %.4f (2.5)\n", *room.scale, room.sigma.at("scale").at(0));
  EXPECT_NEAR(*room.scale, 2.5, 3 * room.sigma.at("scale").at(0));
  EXPECT_LT(room.sigma.at("scale").at(0), 0.1);
}

TEST_F(ScaledTo, WhatIsRefused) {
  const auto refused = [&](std::vector<std::string> words, int status, const std::string& part) {
    words.insert(words.begin(), {"--image", "v0"});
    const Ended ended = probe(words);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(part));
    EXPECT_TRUE(ended.out.empty());
  };
  refused({"--scale", "w"}, 64, "--scale: \"w\" is no image of");
  refused({"--tile", "white"}, 64, "--tile");
  refused({"--scale", "tile", "--tile", "black"}, 65, "in.json#/goniometer/black: missing");
}

}  // namespace
}  // namespace gonio::tests
