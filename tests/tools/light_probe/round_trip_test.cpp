// render, light-probe, render, from GONIO_BIN: the surroundings of a simulated ball come back, by direction and energy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "probe_scene.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class RoundTrip : public testing::Test {
 protected:
  // Three views of one ball, the first along +x, as --orthographic has the world.
  void photograph() {
    world_.eyes = {{-0.3, 0, 0}, {0.17, 0.25, 0.1}, {0.13, -0.27, -0.06}};
    world_.balls = {{}};
    write_surroundings(folder_ / "sky.exr", 512);
    write_metal(folder_ / "metal.yml");
    write_file(folder_ / "scene.json", scene_text(world_));
    const Ended ended = run({"render", "scene.json", "--spp", "20", "--aov", "off", "--out", "r"}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
    write_file(folder_ / "in.json", recorded(scene_text(world_), world_.eyes.size()));
  }
  Ended unwrap(std::vector<std::string> words) const {
    words.insert(words.begin(), {"light-probe", "--metal", "metal.yml", "--camera-radius", "0m", "--columns", "512",
                                 "--circle", "200,199,112", "--log-level", "info"});
    return run(words, folder_.path());
  }
  double worst_direction_deg(const io::Image& map, double* mean = nullptr) const {
    double worst = 0, sum = 0;
    for (const Vec3& lamp : lamps()) {
      const double off = angle_between(middle_of_lamp(map, lamp), middle_of_lamp(sky(), lamp)) * 180 / pi;
      worst = std::max(worst, off), sum += off;
    }
    if (mean != nullptr) *mean = sum / static_cast<double>(lamps().size());
    return worst;
  }
  io::Image sky() const { return io::read_picture(folder_ / "sky.exr"); }
  // A matt ball under the surroundings of this file, as render shows it.
  io::Image matt(const std::string& file) const {
    std::string text = scene_text(world_);
    const auto replace = [&](const std::string& from, const std::string& to) {
      const auto at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    };
    replace("sky.exr", file);
    replace(format(R"("model": "conductor", "eta": %g, "k": %g, "alpha": 0)", metal_n, metal_k),
            R"("model": "diffuse", "albedo": 0.5)");
    replace(R"("width_px": 400, "height_px": 400)", R"("width_px": 50, "height_px": 50)");
    replace(R"("fx_px": 1100, "fy_px": 1100, "cx_px": 199.5, "cy_px": 199.5)",
            R"("fx_px": 137.5, "fy_px": 137.5, "cx_px": 24.5, "cy_px": 24.5)");
    write_file(folder_ / "matt.json", text);
    const Ended ended =
        run({"render", "matt.json", "--spp", "256", "--aov", "off", "--out", "m", "--force"}, folder_.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    return io::read_picture(folder_ / "m/v0.exr");
  }
  // light-probe | render: the scene under what was found, and not under its first lights as well.
  void expect_the_photograph_again(const Ended& found) const {
    write_file(folder_ / "found.json", found.out);
    const Ended ended = run({"render", "found.json", "--spp", "4", "--aov", "off", "--out", "again"}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
    const Rgb before = mean_of(io::read_picture(folder_ / "r/v1.exr")),
              after = mean_of(io::read_picture(folder_ / "again/v1.exr"));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1, 0.01);
    std::printf("light-probe | render: %+.3f %%\n", 100 * (after.y / before.y - 1));
  }
  static Rgb mean_of(const io::Image& p) {
    Rgb sum{};
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) sum += Rgb{p.at(x, y, 0), p.at(x, y, 1), p.at(x, y, 2)};
    return sum / static_cast<double>(p.pixels());
  }
  // --lights: each lamp once, in its direction, and all light together as before.
  void expect_lamps_apart(Rgb whole) const {
    const Ended ended = unwrap({"--radius", "30mm", "--lights", "--out", "l", "in.json"});
    ASSERT_EQ(ended.status, 0) << ended.err;
    const manifest::Document d = manifest::parse_document(ended.out, "out", folder_.path());
    EXPECT_EQ(d.lights.at("probe").model, "lat-long");
    Rgb sum = integral(io::read_picture(folder_ / "l/probe.exr"));
    for (const Vec3& lamp : lamps()) {
      int here = 0;
      for (const auto& [name, light] : d.lights) {
        if (light.model != "directional") continue;
        const double off = angle_between(light.parameters.at("towards").vector(), lamp);
        if (off > 0.05) continue;
        EXPECT_LT(off * 180 / pi, 0.2) << name;
        const std::vector<double>& sigma = light.sigma.at("towards");
        EXPECT_LT(off, 4 * std::sqrt(sigma[0] * sigma[0] + sigma[1] * sigma[1] + sigma[2] * sigma[2])) << name;
        ++here;
        sum += light.parameters.at("watt_per_m2").rgb();
      }
      EXPECT_EQ(here, 1);
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / whole[c], 1, 5e-3);
    std::printf("with lights apart: %+.3f %%\n", 100 * (sum.y / whole.y - 1));
  }
  ProbeWorld world_;
  ScratchFolder folder_;
};

TEST_F(RoundTrip, SurroundingsComeBackAndOrthographicOnesDoNot) {
  photograph();
  const Ended ended = unwrap({"--radius", "30mm", "--out", "p", "in.json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const io::Image found = io::read_picture(folder_ / "p/probe.exr"), truth = sky();
  double mean_deg = 0;
  const double worst_deg = worst_direction_deg(found, &mean_deg);
  expect_the_photograph_again(ended);
  const Rgb before = integral(truth), after = integral(found);
  RecordProperty("worst_direction_deg", std::to_string(worst_deg));
  std::printf("directions: worst %.4f deg, mean %.4f deg; energy %+.4f %+.4f %+.4f %%\n", worst_deg, mean_deg,
              100 * (after.x / before.x - 1), 100 * (after.y / before.y - 1), 100 * (after.z / before.z - 1));
  EXPECT_LT(worst_deg, 0.2);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1, 5e-3);
  // The same photograph without its camera.
  const Ended flat = unwrap({"--orthographic", "--out", "o", "r/v0.exr"});
  ASSERT_EQ(flat.status, 0) << flat.err;
  double flat_mean_deg = 0;
  const double flat_deg = worst_direction_deg(io::read_picture(folder_ / "o/probe.exr"), &flat_mean_deg);
  std::printf("orthographic: worst %.3f deg, mean %.3f deg\n", flat_deg, flat_mean_deg);
  EXPECT_GT(flat_mean_deg, 10 * mean_deg);
  // Rendered again: noise of the two pictures is below a thousandth of the mean.
  const io::Image old = matt("sky.exr"), fresh = matt("p/probe.exr");
  double old_sum = 0, fresh_sum = 0, squares = 0, count = 0;
  for (int y = 15; y < 35; ++y)
    for (int x = 15; x < 35; ++x)
      for (int c = 0; c < 3; ++c) {
        const double a = old.at(x, y, c), b = fresh.at(x, y, c);
        old_sum += a, fresh_sum += b, squares += std::pow(b / a - 1, 2), ++count;
      }
  std::printf("rendered again: %+.4f %%, pixels differ by %.3f %% (rms)\n", 100 * (fresh_sum / old_sum - 1),
              100 * std::sqrt(squares / count));
  EXPECT_NEAR(fresh_sum / old_sum, 1, 5e-3);
  expect_lamps_apart(after);
}

}  // namespace
}  // namespace gonio::tests
