// Hot pixels of stacks of exposures: those that were put in, those that a camera's own dark frames show, and none where
// there are none.
#include "explain/stacks/hot_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "base/text.h"
#include "data.h"
#include "explain/stacks/exposure_outcome.h"
#include "explain/stacks/stack_world.h"
#include "io/picture.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {
namespace {

HotPixels find(const manifest::Document& document) {
  const Stack stack = read_stack(document, stacks_of(document, Kind::exposures).at(0), Kind::exposures);
  return find_hot_pixels(stack, ReadingNoise(stack));
}
HotPixels find(const ExposureWorld& world) {
  const tests::ScratchFolder folder;
  return find(record(world, folder.path()));
}

// 24 stacks without any, linear and on film, of floats and of codes, behind a grid and in colour.
TEST(HotPixels, NoneWhereThereAreNone) {
  for (std::uint64_t k = 0; k < 24; ++k) {
    ExposureWorld world;
    world.width = 144, world.height = 120, world.seed = 1100 + k;
    world.bits = k % 3 == 0 ? 8 : k % 3 == 1 ? 16 : 0;
    if (k % 2 == 1) world.response = film;
    if (k % 4 == 2) world.channels = 3;
    if (k % 4 == 3) world.red = 0.4, world.blue = 0.3;
    EXPECT_TRUE(find(world).pixels.empty()) << k;
  }
}

// 6 stacks with 40 hot pixels each, about as bright as the middle of the scene: more than half are found (the others
// lie at edges and in bright places), of others one in ten at most, and at the rates that were put in.
TEST(HotPixels, ThoseThatWerePutInAreFound) {
  int found = 0, strangers = 0, hot = 0;
  double put_in = 0, told = 0;
  for (std::uint64_t k = 0; k < 6; ++k) {
    ExposureWorld world;
    world.width = 144, world.height = 120, world.seed = 1200 + k, world.bits = 16;
    if (k % 2 == 1) world.red = 0.4, world.blue = 0.3;
    std::mt19937_64 random(k);
    std::exponential_distribution<double> rate(1);
    std::set<std::pair<int, int>> places;
    for (int n = 0; n < 40; ++n) {
      const int x = 3 + static_cast<int>(random() % 138), y = 3 + static_cast<int>(random() % 114);
      world.hot.push_back({x, y, 6 + 6 * rate(random)}), places.insert({x, y});
    }
    const HotPixels all = find(world);
    hot += static_cast<int>(places.size());
    for (const HotPixels::Pixel& p : all.pixels) {
      const auto same = std::ranges::find_if(world.hot, [&](const auto& h) { return h.x == p.x && h.y == p.y; });
      if (same == world.hot.end())
        ++strangers;
      else
        ++found, put_in += same->per_s, told += p.rate;
    }
  }
  EXPECT_GE(found, 0.5 * hot) << found << " of " << hot;
  EXPECT_LE(strangers, 0.1 * found);
  EXPECT_NEAR(told / put_in, 1, 0.03);
}

TEST(HotPixels, AreToldWhereTheyMatter) {
  ExposureWorld world;
  world.width = 144, world.height = 120, world.bits = 16;
  for (int n = 0; n < 60; ++n) world.hot.push_back({5 + 2 * n, 7 + (37 * n) % 100, 6});
  const Outcome few = run(world, 0.2), all = run(world);
  EXPECT_TRUE(few.named.empty()) << few.explanation.sentence;
  EXPECT_EQ(few.explanation.minor.size(), 1u);
  ASSERT_EQ(all.named, std::vector<std::string>{"sensor.hot-pixel"}) << all.explanation.sentence;
  EXPECT_NE(all.explanation.sentence.find("pixels gather more in the dark"), std::string::npos);
  EXPECT_LT(all.explanation.held_out_after, 0.1 * all.explanation.held_out_before) << all.explanation.sentence;
}

// Disks in narrow bands, photographed by a camera whose own dark frames say which pixels are hot: those that read more
// than 4 codes of 255 after 3.9 s. What is found in its photographs is in them; ten or more are found in one band, as
// in the others most lie where the longer exposures are clipped.
TEST(HotPixels, OfARecordedCameraAreThoseOfItsDarkFrames) {
  GONIO_NEEDS_DATA("hdr/flea3");
  std::set<std::pair<int, int>> dark;
  for (const char* name : {"0003", "0004"}) {
    const io::Image frame = io::read_picture(tests::data("hdr/flea3/dark") /
                                             ("d1_dark_3916ms_2019-02-08-171307-" + std::string(name) + ".tif"));
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x)
        if (frame.at(x, y, 0) > 4.0f / 255) dark.insert({x, y});
  }
  int found = 0, strangers = 0;
  for (const int band : {400, 450, 500, 550, 600, 650, 700}) {
    std::string files, images;
    for (const auto& entry : std::filesystem::directory_iterator(tests::data("hdr/flea3/disks"))) {
      const std::string name = entry.path().filename().string(), of_band = "_" + std::to_string(band) + "nm_";
      const auto at = name.find(of_band);
      if (at == std::string::npos) continue;
      const std::string ms = name.substr(at + of_band.size(), name.find("ms", at) - at - of_band.size());
      files += (files.empty() ? "\"" : ", \"") + ms + "\": {\"path\": \"" + entry.path().string() + "\"}";
      images += (images.empty() ? "" : ", ") + format(
                                                   "{\"id\": \"%s\", \"file\": \"%s\", \"camera\": \"c\", "
                                                   "\"exposure_s\": %s, \"response\": \"linear\"}",
                                                   ms.c_str(), ms.c_str(), (ms + "e-3").c_str());
    }
    manifest::ReadOptions options;
    options.allow_outside = true;
    const HotPixels hot = find(manifest::parse_document(
        "{\"gonio\": 1, \"files\": {" + files +
            "}, \"cameras\": {\"c\": {\"model\": \"pinhole\", \"width_px\": 408, "
            "\"height_px\": 344, \"fx_px\": 400, \"fy_px\": 400, \"cx_px\": 203.5, \"cy_px\": 171.5, \"mosaic\": "
            "\"GBRG\"}}, \"images\": [" +
            images + "]}",
        "flea3.json", ".", options));
    int of_band = 0;
    for (const HotPixels::Pixel& p : hot.pixels) of_band += dark.contains({p.x, p.y});
    found += of_band, strangers += static_cast<int>(hot.pixels.size()) - of_band;
    std::cout << band << " nm: " << of_band << " of " << hot.pixels.size() << " in the dark frames' " << dark.size()
              << "\n";
  }
  EXPECT_GE(found, 10);
  EXPECT_LE(strangers, 0.1 * (found + strangers));
}

}  // namespace
}  // namespace gonio::explain::stacks
