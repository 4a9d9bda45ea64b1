// light-probe | explain, from GONIO_BIN: highlights of lamps in pictures by the path tracer, with the lamps far and
// near, without and with the scene that was photographed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/table.h"
#include "probe_scene.h"

namespace gonio::tests {
namespace {

class Explained : public testing::Test {
 protected:
  // Four views of one ball under eight small lamps at this distance, photographed and read: light-probe's manifest, in
  // which every lamp is a direction. `scene`: the manifest has the ball as an object and the lamps as lights, too.
  manifest::Document probed(double distance_m, bool scene) {
    ProbeWorld world;
    world.eyes = {{-0.5, 0, 0.1}, {0.25, -0.45, 0.2}, {0.25, 0.45, 0.15}, {-0.1, 0.3, 0.4}};
    world.balls = {{}};
    world.radius_m = 0.04, world.pixels = 240, world.focal_px = 1050;
    world.lights = R"({"sky": {"model": "lat-long", "file": "sky"})";
    for (std::size_t l = 0; l < lamps_.size(); ++l) {
      const Vec3 at = lamps_[l] * distance_m;
      world.lights += format(R"(, "l%zu": {"model": "sphere", "position_m": [%.17g, %.17g, %.17g], "watt_per_sr": %g,
  "radius_m": %g})",
                             l, at.x, at.y, at.z, 0.25 * distance_m * distance_m, 0.024 * distance_m);
    }
    world.lights += "}";
    io::Image grey(8, 4, {"R", "G", "B"});
    for (float& v : grey.data) v = 0.3f;
    io::write_picture(folder_ / "sky.exr", grey);
    write_metal(folder_ / "metal.yml");
    write_file(folder_ / "scene.json", scene_text(world));
    const Ended rendered = run({"render", "scene.json", "--spp", "4", "--out", "r"}, folder_.path());
    EXPECT_EQ(rendered.status, 0) << rendered.err;
    const std::string text = recorded(scene_text(world), world.eyes.size());
    const auto first = text.find("\"meshes\""), images = text.find("\"images\"");
    write_file(folder_ / "in.json", scene ? text : text.substr(0, first) + text.substr(images));
    const Ended read = run({"light-probe", "--metal", "metal.yml", "--radius", "40mm", "--circle", "119.5,119.5,84",
                            "--lights", "--columns", "32", "--out", "p", "in.json"},
                           folder_.path());
    EXPECT_EQ(read.status, 0) << read.err;
    manifest::Document d = manifest::parse_document(read.out, "read", folder_.path());
    EXPECT_EQ(d.tables.at("probe-highlights").model, "probe");
    EXPECT_EQ(d.tables.at("probe-reflected").model, "probe-radiance");
    for (auto& [name, light] : d.lights) {
      if (!light.parameters.contains("position_m")) continue;
      const Vec3 u = normalized(light.parameters.at("position_m").vector());
      light = {"directional", {{"towards", std::vector{u.x, u.y, u.z}}, {"watt_per_m2", 1.0}}, "", {}};
    }
    return d;
  }
  Ended explained(const manifest::Document& d) {
    write_file(folder_ / "read.json", manifest::print_document(d, folder_.path()));
    return run({"explain", "read.json"}, folder_.path());
  }
  const std::vector<Vec3> lamps_{normalized(Vec3{0.8, 0.5, 0.4}),   normalized(Vec3{-0.6, 0.7, 0.3}),
                                 normalized(Vec3{-0.5, -0.8, 0.2}), normalized(Vec3{0.3, -0.4, 0.9}),
                                 normalized(Vec3{-0.2, 0.1, 1}),    normalized(Vec3{0.9, -0.3, 0.35}),
                                 normalized(Vec3{-0.9, -0.2, 0.5}), normalized(Vec3{0.2, 0.8, 0.6})};
  ScratchFolder folder_;
};

TEST_F(Explained, FarLampsAndABallThatIsWhereItWasFoundLackNothing) {
  const Ended ended = explained(probed(60, false));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, testing::HasSubstr("tables-probe-highlights: No mismatch")) << ended.err;
  EXPECT_THAT(ended.err, testing::HasSubstr("tables-probe-reflected: No mismatch")) << ended.err;
  EXPECT_THAT(ended.out, testing::Not(testing::HasSubstr("\"mechanisms\"")));
}

TEST_F(Explained, NearLampsThatWereTakenForFarOnesGetTheirPlaces) {
  const Ended ended = explained(probed(0.7, true));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, testing::HasSubstr("probe.distance")) << ended.err;
  // Surroundings are beyond what explain renders: its photographs are left out, in one line that says so.
  EXPECT_THAT(ended.err, testing::HasSubstr("images: not asked: read.json#/lights/probe: has the model \"lat-long\""));
  const manifest::Document d = manifest::parse_document(ended.out, "explained", folder_.path());
  double worst_m = 0;
  for (const Vec3 lamp : lamps_) {
    double nearest_m = 1e9;
    for (const auto& [name, light] : d.lights)
      if (light.model == "point")
        nearest_m = std::min(nearest_m, norm(light.parameters.at("position_m").vector() - lamp * 0.7));
    worst_m = std::max(worst_m, nearest_m);
  }
  std::printf("lamps at 0.7 m: off by %.1f mm at most\n%s\n", 1e3 * worst_m, ended.err.c_str());
  EXPECT_LT(worst_m, 0.05);
}

}  // namespace
}  // namespace gonio::tests
