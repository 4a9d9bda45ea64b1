// Pictures with bins of wavelengths beside red, green and blue: what they are called, and that each is the picture at
// its wavelength. Scenes come from manifests, with the files of refractive indices that they name.
#include "render/spectral.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "polarized_scenes.h"

namespace gonio::render {
namespace {

using testing::ElementsAre;

TEST(Wavelengths, FirstAndLastAreIncluded) {
  const auto five = parse_wavelengths("400nm:600nm:5", "test");
  ASSERT_EQ(five.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(five[i], (400 + 50 * static_cast<double>(i)) * 1e-9, 1e-18);
  EXPECT_THAT(parse_wavelengths("0.55um:0.55um:1", "test"), ElementsAre(testing::DoubleNear(550e-9, 1e-18)));
  for (const char* wrong : {"", "400nm", "400nm:700nm", "400nm:700nm:0", "400nm:700nm:1", "400nm:400nm:2",
                            "700nm:400nm:3", "400nm:700nm:2.5", "400:700:3", "1nm:700nm:3", "400nm:700nm:3000"})
    EXPECT_THROW(parse_wavelengths(wrong, "test"), Error) << wrong;
}

TEST(Wavelengths, ThreeToAScene) {
  const auto bands = spectral_bands({4e-7, 5e-7, 6e-7, 7e-7});
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_FALSE(bands[0].rgb || bands[1].rgb);
  EXPECT_THAT(bands[0].wavelength_m, ElementsAre(4e-7, 5e-7, 6e-7));
  EXPECT_THAT(bands[1].wavelength_m, ElementsAre(7e-7, 7e-7, 7e-7));
  EXPECT_EQ(spectral_channel(0, 550e-9), "S0.550,0nm");
  EXPECT_EQ(spectral_channel(2, 632.8e-9), "S2.632,8nm");
}

class Spectral : public testing::Test {
 protected:
  static constexpr double angle = 1.0;
  const std::vector<double> wavelengths_m = {450e-9, 500e-9, 550e-9, 600e-9, 650e-9};

  Spectral() {
    std::ofstream(folder_ / "metal.yml")
        << "DATA:\n  - type: tabulated nk\n    data: |\n        0.3 0.4 2\n        0.8 0.9 7\n";
  }
  // A ball under uniform radiance, seen where light falls in at `angle`.
  scene::Scene scene(const std::string& surface, const optics::Bands& bands) {
    const std::string text =
        R"({"gonio": 1, "files": {"metal": {"path": "metal.yml"}},
         "cameras": {"c": {"model": "pinhole", "width_px": 1, "height_px": 1, "fx_px": 2, "fy_px": 2,
                           "cx_px": 0, "cy_px": 0}},
         "meshes": {"ball": {"sphere": {"radius_m": 1}}}, "surfaces": {"it": )" +
        surface +
        R"(}, "lights": {"a": {"model": "uniform", "radiance": 1}},
         "objects": [{"id": "ball", "mesh": "ball", "surface": "it"}], "images": [{"id": "i", "camera": "c"}]})";
    scene::Reading reading;
    reading.bands = bands;
    scene::Scene scene = build_scene(manifest::parse_document(text, "s.json", folder_.path()), reading);
    const auto lights = scene.views.front().lights;
    scene.views = {tests::one_pixel({std::sin(angle), 0, 5}, {0, 0, -1}, {0, 1, 0})};
    scene.views.front().lights = lights;
    return scene;
  }
  io::Image picture(const std::string& surface, int spp) {
    const scene::Scene colour = scene(surface, {});
    std::vector<scene::Scene> scenes;
    for (const optics::Bands& bands : spectral_bands(wavelengths_m)) scenes.push_back(scene(surface, bands));
    const RayCaster caster(colour.instances);
    const Transport transport{.stokes = true};
    std::vector<std::unique_ptr<Integrator>> spectral;
    for (const scene::Scene& s : scenes) spectral.push_back(path_integrator(s, 0, caster, transport));
    const auto all = with_spectrum(path_integrator(colour, 0, caster, transport), std::move(spectral), wavelengths_m);
    const SamplePlan plan = sample_plan(spp);
    PassSums sums(picture_identity(colour, 0, *all, 1, plan.samples_per_pass));
    add_passes(*all, sums, static_cast<std::uint32_t>(plan.passes), nullptr);
    return develop(sums, {});
  }
  static double value(const io::Image& picture, const std::string& channel) {
    const int place = picture.channel(channel);
    EXPECT_GE(place, 0) << channel;
    return place < 0 ? 0 : picture.at(0, 0, place);
  }

  tests::ScratchFolder folder_;
};

// Each bin is what Fresnel's equations give at its wavelength, polarization included; the ball is as smooth as the
// model goes, which blurs the angle a little.
TEST_F(Spectral, MetalFromATableOfIndices) {
  const io::Image seen =
      picture(R"({"model": "conductor", "alpha": 0.02, "spectra": {"eta": "metal", "k": "metal"}})", 1 << 14);
  const auto at = [](double w) {
    const double share = (w - 300e-9) / 500e-9;
    return optics::fresnel_reflection(std::cos(angle), {0.4 + 0.5 * share, 2 + 5 * share});
  };
  for (const double w : wavelengths_m) {
    EXPECT_NEAR(value(seen, spectral_channel(0, w)), at(w)(0, 0), 2e-3) << w;
    EXPECT_NEAR(value(seen, spectral_channel(1, w)), at(w)(1, 0), 2e-3) << w;
    EXPECT_NEAR(value(seen, spectral_channel(2, w)), 0, 2e-3) << w;
    EXPECT_NEAR(value(seen, spectral_channel(3, w)), 0, 2e-3) << w;
  }
  EXPECT_GT(value(seen, spectral_channel(0, 650e-9)), value(seen, spectral_channel(0, 450e-9)) + 0.05);
  EXPECT_GT(value(seen, "R"), value(seen, "B") + 0.05);
  EXPECT_LT(seen.channel("S0.700,0nm"), 0);
}

// Bins of what is grey are alike to the last bit: all follow the same paths.
TEST_F(Spectral, BinsShareTheirNoise) {
  const io::Image seen = picture(R"({"model": "coated-diffuse", "albedo": 0.4, "f0": 0.04, "alpha": 0.2})", 4);
  for (const double w : wavelengths_m) EXPECT_EQ(value(seen, spectral_channel(0, w)), value(seen, "G"));
}

}  // namespace
}  // namespace gonio::render
