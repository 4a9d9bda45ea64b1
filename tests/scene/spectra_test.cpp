// Spectra of surfaces, and RGB numbers in scenes whose bands are wavelengths.
#include "scene/spectra.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "base/error.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "optics/colour.h"

namespace gonio::scene {
namespace {

using testing::HasSubstr;

const optics::Bands three{false, {450e-9, 550e-9, 650e-9}};

class Spectra : public testing::Test {
 protected:
  Spectra() {
    write("glass.yml", "DATA:\n  - type: formula 5\n    wavelength_range: 0.3 1\n    coefficients: 1.5 0.005 -2\n");
    write("metal.yml", "DATA:\n  - type: tabulated nk\n    data: |\n        0.3 0.4 2\n        0.8 0.9 7\n");
    write("paint.csv", "wavelength_nm,value\n350,0.1\n850,0.6\n");
    write("short.csv", "500,0.1\n600,0.6\n");
    write("bright.csv", "350,0.5\n850,3\n");
  }
  void write(const char* name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  // One ball with this surface.
  Scene scene(const std::string& surface, const optics::Bands& bands = {}) {
    const std::string text =
        R"({"gonio": 1, "files": {"glass": {"path": "glass.yml"}, "metal": {"path": "metal.yml"},
          "paint": {"path": "paint.csv"}, "short": {"path": "short.csv"}, "bright": {"path": "bright.csv"},
          "texture": {"path": "texture.exr"}},
         "cameras": {"c": {"model": "pinhole", "width_px": 2, "height_px": 2, "fx_px": 2, "fy_px": 2,
                         "cx_px": 0.5, "cy_px": 0.5}},
         "meshes": {"ball": {"sphere": {"radius_m": 0.05}}}, "surfaces": {"it": )" +
        surface +
        R"(}, "lights": {"a": {"model": "point", "position_m": [0, 0, 1], "watt_per_sr": [1, 2, 4]}},
         "objects": [{"id": "ball", "mesh": "ball", "surface": "it"}], "images": [{"id": "i", "camera": "c"}]})";
    Reading reading;
    reading.bands = bands;
    return build_scene(manifest::parse_document(text, "s.json", folder_.path()), reading);
  }
  static Rgb value(const Scene& scene, std::size_t i) { return scene.appearance.surfaces[0].values.rgb(i); }
  std::string problem(const std::string& surface, const optics::Bands& bands = {}) {
    try {
      scene(surface, bands);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "none";
  }

  tests::ScratchFolder folder_;
};

void expect_near(Rgb a, Rgb b, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << c;
}

TEST_F(Spectra, IndicesOfAConductor) {
  const std::string metal = R"({"model": "conductor", "spectra": {"eta": "metal", "k": "metal"}})";
  const Scene spectral = scene(metal, three);
  expect_near(value(spectral, 0), {0.55, 0.65, 0.75}, 1e-9);
  expect_near(value(spectral, 1), {3.5, 4.5, 5.5}, 1e-9);
  // Both are linear in the wavelength: in RGB their values at the centres of mass.
  const Scene rgb = scene(metal);
  const Rgb centres = optics::rgb_centres_m();
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(value(rgb, 0)[c], 0.4 + 0.5 * (centres[c] - 300e-9) / 500e-9, 1e-9);
    EXPECT_NEAR(value(rgb, 1)[c], 2 + 5 * (centres[c] - 300e-9) / 500e-9, 1e-9);
  }
}

TEST_F(Spectra, ReflectanceOfAMetal) {
  const Scene spectral = scene(R"({"model": "metal", "spectra": {"f0": "metal"}})", three);
  const auto f0 = [](double n, double k) { return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k); };
  expect_near(value(spectral, 0), {f0(0.55, 3.5), f0(0.65, 4.5), f0(0.75, 5.5)}, 1e-9);
}

TEST_F(Spectra, OneNumberIsThatOfTheDLine) {
  const std::string varnish = R"({"model": "coated-diffuse", "albedo": 0.5, "spectra": {"f0": "glass"}})";
  const double n = 1.5 + 0.005 / (0.5875618 * 0.5875618), f0 = std::pow((n - 1) / (n + 1), 2);
  for (const optics::Bands& bands : {optics::Bands{}, three})
    EXPECT_NEAR(scene(varnish, bands).appearance.surfaces[0].values.scalar(2), f0, 1e-9);
}

TEST_F(Spectra, ReflectanceFromATable) {
  expect_near(value(scene(R"({"model": "diffuse", "spectra": {"albedo": "paint"}})", three), 0), {0.2, 0.3, 0.4}, 1e-9);
}

TEST_F(Spectra, NumbersOfSurfacesAndLightsBecomeSpectra) {
  const Scene spectral = scene(R"({"model": "diffuse", "albedo": [0.6, 0.4, 0.2]})", three);
  const Rgb albedo{0.6, 0.4, 0.2}, intensity{1, 2, 4};
  expect_near(value(spectral, 0), optics::upsampled(albedo, three), 1e-12);
  const auto lit = spectral.appearance.lights[0].emitter->sample({0, 0, 0}, {});
  expect_near(lit.weight, optics::upsampled(intensity, three), 1e-9);
  // Grey stays what it is, and so does everything in RGB.
  expect_near(value(scene(R"({"model": "diffuse", "albedo": 0.3})", three), 0), {0.3, 0.3, 0.3}, 1e-12);
  expect_near(value(scene(R"({"model": "diffuse", "albedo": [0.6, 0.4, 0.2]})"), 0), albedo, 0);
}

TEST_F(Spectra, SaturatedAlbedosStayWithinTheirBounds) {
  const Rgb red = value(scene(R"({"model": "diffuse", "albedo": [1, 0, 0]})", three), 0);
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(red[c] >= 0 && red[c] <= 1) << red[c];
  EXPECT_GT(red.z, 0.9);  // 650 nm
}

// What the renderer adds up over many bands is the RGB of the same scene: here the light that the ball scatters.
TEST_F(Spectra, BinsAddUpToRgb) {
  const std::string surface = R"({"model": "diffuse", "albedo": [0.5, 0.4, 0.3]})";
  constexpr int bins = 48;
  std::vector<double> centres;
  for (int i = 0; i < bins; ++i) centres.push_back(380e-9 + (i + 0.5) * 400e-9 / bins);
  const auto weights = optics::rgb_weights(centres, "bins");
  Rgb sum;
  for (std::size_t i = 0; i < bins; i += 3) {
    const Rgb albedo = value(scene(surface, {false, {centres[i], centres[i + 1], centres[i + 2]}}), 0);
    sum += weights[i] * albedo.x + weights[i + 1] * albedo.y + weights[i + 2] * albedo.z;
  }
  expect_near(sum, {0.5, 0.4, 0.3}, 0.005);
}

TEST_F(Spectra, Textures) {
  io::Image picture(1, 1, {"R", "G", "B"});
  picture.data = {0.5f, 0.25f, 0.125f};
  io::write_picture(folder_ / "texture.exr", picture);
  const Scene spectral = scene(R"({"model": "diffuse", "textures": {"albedo": "texture"}})", three);
  expect_near(spectral.appearance.surfaces[0].values_at(Place{}).rgb(0), optics::upsampled({0.5, 0.25, 0.125}, three),
              1e-6);
}

TEST_F(Spectra, EditsGoThroughTheBandsToo) {
  Scene spectral = scene(R"({"model": "diffuse", "albedo": [0.6, 0.4, 0.2]})", three);
  Surface& surface = spectral.appearance.surfaces[0];
  surface.parameters["albedo"] = manifest::Parameter(std::vector<double>{0.1, 0.2, 0.3});
  refresh(surface, "test");
  expect_near(surface.values.rgb(0), optics::upsampled(Rgb{0.1, 0.2, 0.3}, three), 1e-12);
}

TEST_F(Spectra, SaysWhatIsWrong) {
  EXPECT_THAT(problem(R"({"model": "conductor", "eta": 1, "spectra": {"k": "glass"}})"),
              HasSubstr("glass.yml: states no extinction coefficient k"));
  EXPECT_THAT(problem(R"({"model": "diffuse", "spectra": {"albedo": "glass"}})"),
              HasSubstr("a refractive index does not say what albedo is"));
  EXPECT_THAT(problem(R"({"model": "diffuse", "spectra": {"albedo": "short"}})"), HasSubstr("there is no value"));
  EXPECT_THAT(problem(R"({"model": "diffuse", "spectra": {"albedo": "short"}})", three),
              HasSubstr("450 nm is outside of what it states"));
  EXPECT_THAT(problem(R"({"model": "diffuse", "spectra": {"albedo": "bright"}})"), HasSubstr("albedo becomes"));
  EXPECT_THAT(problem(R"({"model": "diffuse", "albedo": [0.2, 2, 0.2]})", three), HasSubstr("2"));
}

}  // namespace
}  // namespace gonio::scene
