// develop --merge on a recorded camera: raw frames of disks in narrow bands, seven exposures over two decades, with the
// camera's own dark frames (hdr/flea3).
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "process.h"
#include "stats/intervals.h"

namespace gonio::tests {
namespace {

class DevelopFlea3 : public testing::Test {
 protected:
  static std::string frame(const std::string& folder, const std::string& has) {
    for (const auto& entry : std::filesystem::directory_iterator(data("hdr/flea3") / folder))
      if (entry.path().filename().string().find(has) != std::string::npos) return entry.path().string();
    return "";
  }
  // The merged picture of one band, of exposures in ms, at the times that are stated.
  io::Image merged(int band, const std::vector<int>& exposures_ms, io::Image& mask) {
    const std::string out = "m" + std::to_string(exposures_ms[0]);
    std::vector<std::string> words = {"develop", "--merge",          "--mosaic",     "GBRG",  "--views",
                                      "one",     "--keep-exposures", "--noise-gain", "26",    "--read-noise",
                                      "0.6",     "--allow-outside",  "--force",      "--out", out,
                                      "-o",      out + ".json"};
    for (const char* dark : {"d1_dark_25ms", "d1_dark_3916ms"})
      for (const char* number : {"0003.tif", "0004.tif"})
        for (const auto& entry : std::filesystem::directory_iterator(data("hdr/flea3/dark")))
          if (const std::string name = entry.path().filename().string();
              name.starts_with(std::string(dark) + "_") && name.ends_with(number))
            words.insert(words.end(), {"--dark", entry.path().string()});
    for (const int ms : exposures_ms)
      words.push_back(frame("disks", "_" + std::to_string(band) + "nm_" + std::to_string(ms) + "ms_"));
    const Ended ended = run(words, folder_.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    const auto document = manifest::read_document(folder_ / (out + ".json"));
    mask = io::read_picture(manifest::mask_path(document, 0));
    return io::read_picture(manifest::picture_path(document, 0));
  }
  ScratchFolder folder_;
};

// Radiances out of the four shortest exposures and out of the four longest, by half decades of light: the same to 2 %
// and 0.6 of a code in the longest of the short ones, over two decades. The camera cuts codes of 8 bits off instead of
// rounding them: at ten codes the short ones are 5 % low, which nobody states.
TEST_F(DevelopFlea3, ShortAndLongExposuresSayTheSame) {
  GONIO_NEEDS_DATA("hdr/flea3");
  double darkest = 1e9, brightest = 0;
  for (const int band : {400, 450, 500, 550, 600, 650, 700}) {
    io::Image short_mask, long_mask;
    const io::Image few = merged(band, {25, 50, 100, 250}, short_mask);
    const io::Image many = merged(band, {500, 2000, 3916, 250}, long_mask);
    for (int c = 0; c < 3; ++c)
      for (double from = 24; from < 3000; from *= std::sqrt(10.0)) {
        std::vector<double> ratios;
        for (int y = 0; y < few.height; ++y)
          for (int x = 0; x < few.width; ++x) {
            const double light = many.at(x, y, c);
            if (light < from || light >= from * std::sqrt(10.0)) continue;
            if (short_mask.at(x, y, 0) > 0.5f && long_mask.at(x, y, 0) > 0.5f)
              ratios.push_back(few.at(x, y, c) / light);
          }
        if (ratios.size() < 500) continue;
        darkest = std::min(darkest, from), brightest = std::max(brightest, from * std::sqrt(10.0));
        EXPECT_NEAR(stats::median(ratios), 1, 0.02 + 0.6 / (0.25 * from))
            << band << " nm, channel " << c << ", from " << from << " codes a second, " << ratios.size() << " pixels";
      }
  }
  EXPECT_LE(darkest, 24);
  EXPECT_GE(brightest, 2400);
}

}  // namespace
}  // namespace gonio::tests
