// From the laboratory's raw frames to radiance, through the programs: what acquire(1) states of its frames is what
// develop(1) goes by.
// One process: RawChain.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/value.h"
#include "process.h"

namespace gonio::tests {
namespace {

using testing::HasSubstr;

// Three views by a camera behind a Bayer grid, each at three exposures; one light path a pixel, the same for all three.
class RawChain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    run_well({"acquire", "--specimen", "studio", "--out", "studio", "-o", "mono.json"});
    std::string lab = read_file(*folder_ / "mono.json");
    lab.replace(lab.find("Mono12"), 6, "BayerRG12");
    write_file(*folder_ / "lab.json", lab);
    run_well({"acquire", "lab.json", "--exposure", "5ms", "--exposure", "20ms", "--exposure", "80ms", "--target",
              "0m,0m,3cm", "--plan",
              "octant:azimuth=200deg,span=1deg,step=30deg,lowest=50deg,highest=50deg,radius=36cm,lamp-radius=42cm,"
              "lamp-step=40deg,lamp-lowest=50deg,lamp-azimuth=-30deg,lamp-span=1deg",
              "-o", "plan.json"});
    run_well({"acquire", "plan.json", "--go", "--spp", "1", "--out", "run", "-o", "frames.json"});
  }
  static void TearDownTestSuite() { delete folder_; }
  static Ended run_well(const std::vector<std::string>& words) {
    Ended ended = run(words, folder_->path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }
  static ScratchFolder* folder_;
};
ScratchFolder* RawChain::folder_ = nullptr;

// Poisson and read noise are all that exposures of one view differ by: chi-square per degree of freedom of some 1e5
// samples is 1 to half a percent, the light's own noise being the same in all of them.
TEST_F(RawChain, ExposuresOfOneViewAgreeWithinTheNoiseThatTheFramesState) {
  const Ended merged = run_well(
      {"develop", "--merge", "frames.json", "--out", "d", "-o", "developed.json", "--force", "--log-level", "info"});
  const std::regex figure("chi-square per degree of freedom ([0-9.]+)");
  std::size_t views = 0;
  for (std::sregex_iterator it(merged.err.begin(), merged.err.end(), figure); it != std::sregex_iterator(); ++it) {
    EXPECT_NEAR(std::stod((*it)[1]), 1, 0.03) << merged.err;
    ++views;
  }
  EXPECT_EQ(views, 3u);
  EXPECT_THAT(merged.err, testing::Not(HasSubstr("moved")));
  const manifest::Value developed = manifest::parse_json(read_file(*folder_ / "developed.json"), "developed");
  EXPECT_EQ(developed.find("cameras")->find("camera")->find("mosaic")->as_string(), "RGGB");
  const auto& images = developed.find("images")->as_array();
  ASSERT_EQ(images.size(), 3u);
  for (const manifest::Value& image : images) {
    ASSERT_NE(image.find("gain"), nullptr);
    EXPECT_NEAR(image.find("gain")->as_number(), 102375, 1e-6 * 102375);  // codes per radiance and second, as described
    for (const char* of_frames : {"exposure_s", "noise", "saturation"}) EXPECT_EQ(image.find(of_frames), nullptr);
    std::vector<std::string> steps;
    for (const manifest::Value& step : image.find("developed")->as_array())
      steps.push_back(step.find("step")->as_string());
    EXPECT_THAT(steps, testing::ElementsAre("black", "exposure-times", "merge", "demosaic"));
  }
}

TEST_F(RawChain, AResponseThatBendsIsNoRawFrame) {
  std::string text = read_file(*folder_ / "frames.json");
  const auto at = text.find("\"response\"");
  ASSERT_NE(at, std::string::npos);
  const auto begin = text.find('[', at), end = text.find(']', text.find(']', text.find(']', at) + 1) + 1);
  text.replace(begin, end + 1 - begin, "[[0, 0], [0.5, 0.2], [1, 1]]");
  write_file(*folder_ / "bent.json", text);
  const Ended ended = run({"develop", "--merge", "bent.json", "--out", "b"}, folder_->path());
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("/images/0/response: bends"));
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "b"));
}

TEST_F(RawChain, FramesThatStateAnotherBlackAreRefused) {
  std::string text = read_file(*folder_ / "frames.json");
  const auto black = text.rfind("-0.0009765");
  ASSERT_NE(black, std::string::npos);
  const auto above = text.find("0.99902", black);
  ASSERT_NE(above, std::string::npos);
  text.replace(above, text.find_first_of("],\n", above) - above, "0.99804684");
  text.replace(black, text.find_first_of("],\n", black) - black, "-0.00195316");
  write_file(*folder_ / "two.json", text);
  const Ended ended = run({"develop", "--merge", "two.json", "--out", "t"}, folder_->path());
  EXPECT_EQ(ended.status, 65);
  EXPECT_THAT(ended.err, HasSubstr("states black at code 128, images before it 64"));
}

}  // namespace
}  // namespace gonio::tests
