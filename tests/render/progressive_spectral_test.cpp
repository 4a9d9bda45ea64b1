// Spectral pictures of sessions: what their channels are called, and that bins hold what the scene has there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "progressive_scene.h"
#include "render/film.h"
#include "render/spectral.h"

namespace gonio::render {
namespace {

using tests::rendered;
using tests::small_scene;

TEST(SpectralPictures, ChannelsGiveTheirWavelengthsBack) {
  EXPECT_EQ(spectral_channel(0, 550e-9), "S0.550,0nm");
  EXPECT_EQ(spectral_channel(3, 402.5e-9), "S3.402,5nm");
  const auto all = parse_wavelengths("380nm:780nm:37", "x");
  std::vector<std::string> planes = {"", "s1"};
  for (std::size_t i = 0; i < all.size(); i += 3)
    planes.push_back(spectral_channel(0, all[i]) + " " + (i + 1 < all.size() ? spectral_channel(0, all[i + 1]) : "-") +
                     " " + (i + 2 < all.size() ? spectral_channel(0, all[i + 2]) : "-"));
  const auto back = wavelengths_of(planes);
  ASSERT_EQ(back.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_NEAR(back[i], all[i], 1e-13);
  const auto bands = spectral_bands(all);
  ASSERT_EQ(bands.size(), 13u);
  EXPECT_FALSE(bands[0].rgb);
  EXPECT_EQ(bands[12].wavelength_m[0], all[36]);
  EXPECT_EQ(bands[12].wavelength_m[2], all[36]);
}

// A grey scene: paths are the same in every band, and so are the values.
TEST(SpectralPictures, BinsOfAGreySceneAreItsGrey) {
  SessionOptions options{.geometry = false, .spp = 8, .wavelengths_m = parse_wavelengths("400nm:700nm:5", "x")};
  options.transport.stokes = true;
  const Rendered picture = rendered(small_scene(), options);
  const io::Image& image = picture.picture;
  for (const double wavelength_m : options.wavelengths_m)
    for (int stokes = 0; stokes < 4; ++stokes) {
      const int bin = image.channel(spectral_channel(stokes, wavelength_m)),
                band = image.channel(stokes == 0 ? "G" : "s" + std::to_string(stokes) + ".G");
      ASSERT_GE(bin, 0);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          ASSERT_NEAR(image.at(x, y, bin), image.at(x, y, band), 2e-6 * image.at(x, y, 1)) << x << " " << y;
    }
  // And the colours are what they are without wavelengths.
  options.wavelengths_m.clear();
  EXPECT_EQ(rendered(small_scene(), options).facts.relative_error, picture.facts.relative_error);
}

// A red table: its long wavelengths are bright, its short ones dark.
TEST(SpectralPictures, BinsFollowTheColourOfASurface) {
  const SessionOptions options{.geometry = false, .spp = 4, .wavelengths_m = {450e-9, 650e-9}};
  const io::Image image = rendered(small_scene(tests::glass(), "[0.7, 0.1, 0.1]"), options).picture;
  const int blue = image.channel("S0.450,0nm"), red = image.channel("S0.650,0nm");
  double sum_blue = 0, sum_red = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) sum_blue += image.at(x, y, blue), sum_red += image.at(x, y, red);
  EXPECT_GT(sum_red, 3 * sum_blue);
}

}  // namespace
}  // namespace gonio::render
