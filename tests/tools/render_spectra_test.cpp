// render with surfaces whose optical constants come from files (from GONIO_BIN): the pictures are those of the numbers
// that the files reduce to, and what is wrong with a file is said in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "optics/colour.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

class RenderSpectra : public testing::Test {
 protected:
  RenderSpectra() {
    // Schott's coefficients of N-BK7, without its extinction.
    write_file(
        folder_ / "bk7.yml",
        "DATA:\n  - type: formula 2\n    wavelength_range: 0.3 2.5\n    coefficients: 0 1.03961212 0.00600069867 "
        "0.231792344 0.0200179144 1.01046945 103.560653\n");
    write_file(folder_ / "metal.yml",
               "DATA:\n  - type: tabulated nk\n    data: |\n        0.3 0.4 2\n        0.8 0.9 7\n");
  }
  // A ball of this surface under uniform radiance, its middle in one pixel.
  Ended render(const std::string& surface, const std::string& out, const Process::Words& more = {}) {
    write_file(folder_ / "s.json", R"({"gonio": 1,
      "files": {"bk7": {"path": "bk7.yml"}, "metal": {"path": "metal.yml"}},
      "cameras": {"c": {"model": "orthographic", "width_px": 1, "height_px": 1, "px_per_m": 1e5,
                        "cx_px": 0, "cy_px": 0}},
      "meshes": {"ball": {"sphere": {"radius_m": 1}}}, "surfaces": {"it": )" +
                                       surface +
                                       R"(}, "lights": {"a": {"model": "uniform", "radiance": 1}},
      "objects": [{"id": "ball", "mesh": "ball", "surface": "it",
                   "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 3]}}],
      "images": [{"id": "i", "camera": "c"}]})");
    Process::Words words = {"render", "s.json", "--spp", "16384", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, folder_.path());
  }
  std::array<double, 3> pixel(const std::string& surface, const std::string& out) {
    const Ended ended = render(surface, out);
    EXPECT_EQ(ended.status, 0) << ended.err;
    if (ended.status != 0) return {};
    const io::Image picture = io::read_picture(folder_ / (out + "/i.exr"));
    return {picture.at(0, 0, picture.channel("R")), picture.at(0, 0, picture.channel("G")),
            picture.at(0, 0, picture.channel("B"))};
  }
  static std::string three(Rgb v) { return format("[%.17g, %.17g, %.17g]", v.x, v.y, v.z); }
  ScratchFolder folder_;
};

// n and k are linear in the wavelength: their RGB values are those at the matching functions' centres of mass.
TEST_F(RenderSpectra, MetalByItsTable) {
  const Rgb centres = optics::rgb_centres_m();
  Rgb eta, k;
  std::array<double, 3> expected{};
  for (int c = 0; c < 3; ++c) {
    const double share = (centres[c] - 300e-9) / 500e-9, n = 0.4 + 0.5 * share, extinction = 2 + 5 * share;
    (c == 0 ? eta.x : c == 1 ? eta.y : eta.z) = n;
    (c == 0 ? k.x : c == 1 ? k.y : k.z) = extinction;
    expected[static_cast<std::size_t>(c)] =
        ((n - 1) * (n - 1) + extinction * extinction) / ((n + 1) * (n + 1) + extinction * extinction);
  }
  const auto by_file =
      pixel(R"({"model": "conductor", "alpha": 0.02, "spectra": {"eta": "metal", "k": "metal"}})", "a");
  const auto by_numbers =
      pixel(R"({"model": "conductor", "alpha": 0.02, "eta": )" + three(eta) + R"(, "k": )" + three(k) + "}", "b");
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(by_file[c], by_numbers[c], 1e-7) << c;
    EXPECT_NEAR(by_file[c], expected[c], 2e-3) << c;
  }
}

// Bins of wavelengths beside the colours, polarization included: at normal incidence there is none.
TEST_F(RenderSpectra, BinsOfWavelengths) {
  const Ended ended = render(R"({"model": "conductor", "alpha": 0.02, "spectra": {"eta": "metal", "k": "metal"}})", "a",
                             {"--wavelengths", "450nm:650nm:3", "--stokes"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const io::Image picture = io::read_picture(folder_ / "a/i.exr");
  for (const double nm : {450.0, 550.0, 650.0}) {
    const double share = (nm - 300) / 500, n = 0.4 + 0.5 * share, k = 2 + 5 * share;
    const std::string bin = format("%.0f,0nm", nm);
    ASSERT_GE(picture.channel("S0." + bin), 0) << bin;
    ASSERT_GE(picture.channel("S1." + bin), 0) << bin;
    EXPECT_NEAR(picture.at(0, 0, picture.channel("S0." + bin)),
                ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k), 2e-3);
    EXPECT_NEAR(picture.at(0, 0, picture.channel("S1." + bin)), 0, 2e-3);
  }
}

TEST_F(RenderSpectra, ReflectanceByAFormula) {
  const auto sellmeier = [](double wavelength_m) {
    const double w2 = wavelength_m * wavelength_m * 1e12;
    const double n = std::sqrt(1 + 1.03961212 * w2 / (w2 - 0.00600069867) + 0.231792344 * w2 / (w2 - 0.0200179144) +
                               1.01046945 * w2 / (w2 - 103.560653));
    return std::pow((n - 1) / (n + 1), 2);
  };
  const Rgb f0 = optics::rgb_of(sellmeier);
  const auto by_file = pixel(R"({"model": "metal", "alpha": 0.02, "spectra": {"f0": "bk7"}})", "a");
  const auto by_numbers = pixel(R"({"model": "metal", "alpha": 0.02, "f0": )" + three(f0) + "}", "b");
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(by_file[c], by_numbers[c], 1e-7) << c;
  EXPECT_GT(by_file[2], by_file[0]);  // glass refracts blue more
}

TEST_F(RenderSpectra, RefusesInOneLine) {
  const auto refused = [&](const std::string& surface, int status, const char* mentions) {
    const Ended ended = render(surface, "r");
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(mentions));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  };
  refused(R"({"model": "conductor", "eta": 1, "spectra": {"k": "bk7"}})", 65, "states no extinction coefficient k");
  refused(R"({"model": "diffuse", "spectra": {"albedo": "bk7"}})", 65, "does not say what albedo is");
  refused(R"({"model": "conductor", "k": 1, "spectra": {"eta": "nickel"}})", 65, "nickel");
  write_file(folder_ / "metal.yml", "DATA:\n  - type: formula 12\n");
  refused(R"({"model": "conductor", "k": 1, "spectra": {"eta": "metal"}})", 65, "formula 12");
}

}  // namespace
}  // namespace gonio::tests
