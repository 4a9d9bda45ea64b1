// The page of a run: what it says while the run goes on and at its end, and its last picture.
#include "acquisition/run/run_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data.h"
#include "io/codes.h"
#include "io/image.h"
#include "io/picture.h"
#include "io/raster.h"
#include "manifest/document.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

io::Image frame(int width, int height, float low, float high) {
  io::Image picture(width, height, {"Y"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture.at(x, y, 0) = x < width / 2 ? low : high;
  return picture;
}

class RunPageTest : public ::testing::Test {
 protected:
  RunPageTest() {
    for (int k = 0; k < 3; ++k) {
      manifest::PlanStep step;
      step.image = "v" + std::to_string(k), step.camera = "standing", step.exposures_s = {0.01};
      step.turntable_rad["turntable"] = 0.5 * k;
      plan.steps.push_back(step);
    }
    plan.id = std::string(64, 'a'), plan.pattern = "a turn";
    std::filesystem::create_directories(folder / "frames");
    for (int k = 0; k < 2; ++k) {
      FrameRecord r;
      r.image = r.group = "v" + std::to_string(k), r.camera = "standing", r.file = "frames/" + r.image + ".png";
      r.exposure_s = 0.01, r.time_s = k, r.lamps = {"bulb"}, r.tries = 1 + k;
      io::write_png(folder / r.file, frame(64, 48, 0.01f, 0.02f + 0.02f * static_cast<float>(k)), 16);
      records[r.image] = r;
    }
  }
  tests::ScratchFolder folder;
  manifest::Document document = manifest::parse_document(R"({"gonio": 1, "laboratory": {
    "robots": {"arm": {"url": "sim://", "model": "ur3", "home_rad": [0, -1.9, 1.9, -1.6, -1.5708, 0]}},
    "cameras": {"standing": {"url": "sim://", "world_from_camera": {"rotation": [0, 0.6, 0.8, 0],
      "translation_m": [0, 0.6, 0.9]}}},
    "turntables": {"turntable": {"url": "sim://", "speed_rad_per_s": 0.5, "acceleration_rad_per_s2": 1}}}})",
                                                         "laboratory.json", ".");
  Laboratory laboratory = believed_laboratory(document);
  manifest::Plan plan;
  std::map<std::string, FrameRecord> records;
};

TEST_F(RunPageTest, SaysHowFarItIsAndLoadsItselfAnewWhileItRuns) {
  const RunPage page(document, laboratory, plan, folder.path());
  const std::string running = page.html({.records = &records, .retaken = 1, .left_s = 200});
  EXPECT_THAT(running, HasSubstr("2 of 3 frames, running"));
  EXPECT_THAT(running, HasSubstr("http-equiv=\"refresh\" content=\"5\""));
  EXPECT_THAT(running, HasSubstr("3 min"));
  EXPECT_THAT(running, HasSubstr("v1: 10 ms"));
  EXPECT_THAT(running, HasSubstr("bulb"));
  // An exposure of 10 ms, then a turn by 0.5 rad: at 1 rad/s^2 to 0.5 rad/s and back, 1.5 s.
  EXPECT_THAT(running, HasSubstr("data-start=\"1.51\""));
  const std::string over = page.html({.records = &records, .refused = 1, .words = {"v2: refused"}, .running = false});
  EXPECT_THAT(over, Not(HasSubstr("http-equiv=\"refresh\"")));
  EXPECT_THAT(over, HasSubstr("v2: refused"));
  EXPECT_THAT(over, HasSubstr("h1 class=\"bad\""));
  const std::string stopped = page.html({.records = &records, .running = false, .stopped = "run: was <interrupted>"});
  EXPECT_THAT(stopped, HasSubstr("2 of 3 frames, stopped"));
  EXPECT_THAT(stopped, HasSubstr("run: was &lt;interrupted&gt;"));
}

TEST_F(RunPageTest, ARunWithoutAFrameHasAPage) {
  const RunPage page(document, laboratory, plan, folder.path());
  records.clear();
  EXPECT_THAT(page.html({.records = &records, .running = false, .stopped = "robot arm: gave up"}),
              HasSubstr("0 of 3 frames, stopped"));
}

TEST_F(RunPageTest, TheLastPictureIsBrightenedAndMadeSmall) {
  io::write_png(folder / "dark.png", frame(640, 480, 0.01f, 0.04f), 16);
  const io::Image shown = io::decode_raster(shown_frame(folder / "dark.png", 200), "shown");
  EXPECT_EQ(shown.width, 160);
  EXPECT_EQ(shown.height, 120);
  EXPECT_NEAR(shown.at(150, 60, 0), io::srgb_from_linear(0.9f), 0.005);
  EXPECT_NEAR(shown.at(10, 60, 0), io::srgb_from_linear(0.225f), 0.005);
  io::write_png(folder / "black.png", frame(8, 8, 0, 0), 16);
  EXPECT_EQ(io::decode_raster(shown_frame(folder / "black.png", 200), "shown").at(4, 4, 0), 0);
}

}  // namespace
}  // namespace gonio::acquisition
