// Disagreements between what was asked and what came, and figures of pictures.
#include "acquisition/run/frame_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "acquisition/run/instrument_lock.h"
#include "base/error.h"
#include "base/random.h"

namespace gonio::acquisition {
namespace {

RawFrame frame_of(double mean, double sigma, std::uint64_t seed) {
  RawFrame f;
  f.width_px = 200;
  f.height_px = 100;
  f.bits = 12;
  f.pixel_format = "Mono12";
  f.frame_id = 5;
  f.chunk_frame_id = 5;
  f.exposure_s = 0.01;
  f.camera_time_s = 100;
  Random random(seed);
  for (int i = 0; i < 20000; ++i)
    f.samples.push_back(static_cast<std::uint16_t>(std::lround(std::max(0.0, mean + sigma * random.normal()))));
  return f;
}

TEST(FrameCheck, EveryDisagreementIsSaid) {
  const RawFrame good = frame_of(500, 10, 1);
  const Shot shot{0.01, {}};
  const FrameBefore before{4, 99.0, 9.0, 9.02};
  const auto said = [&](RawFrame frame) { return disagreement(frame, shot, "Mono12", before, 10.0, 10.05); };
  EXPECT_EQ(said(good), "");
  RawFrame f = good;
  f.exposure_s = 0.02;
  EXPECT_NE(said(f).find("20 ms"), std::string::npos);
  f = good;
  f.chunk_frame_id = 4;
  EXPECT_NE(said(f).find("figures of frame 4"), std::string::npos);
  f = good;
  f.frame_id = f.chunk_frame_id.emplace(4);
  EXPECT_NE(said(f).find("not after"), std::string::npos);
  f = good;
  f.incomplete_packets = 1;
  EXPECT_NE(said(f).find("missing"), std::string::npos);
  f = good;
  f.samples.pop_back();
  EXPECT_NE(said(f).find("samples"), std::string::npos);
  f = good;
  f.pixel_format = "Mono8";
  EXPECT_NE(said(f).find("Mono8"), std::string::npos);
  EXPECT_EQ(disagreement(good, shot, "Mono12Packed", before, 10.0, 10.05), "");  // frames come unpacked
  f = good;
  f.camera_time_s = 99.1;  // exposed before it was asked for
  EXPECT_NE(said(f).find("time stamp"), std::string::npos);
  f.camera_time_s = 102;
  EXPECT_NE(said(f).find("time stamp"), std::string::npos);
}

TEST(FrameCheck, FiguresAreThoseOfThePicture) {
  const FrameFigures f = figures_of(frame_of(500, 10, 2), 4095, false);
  EXPECT_NEAR(f.mean_code, 500, 0.5);
  EXPECT_NEAR(f.noise, 10, 0.7);
  EXPECT_NEAR(f.bright_code, 500 + 2.326 * 10, 1.5);  // the normal's 99th percentile
  EXPECT_LT(f.focus, 1e-4);
  EXPECT_EQ(f.saturated_share, 0);
  EXPECT_NEAR(figures_of(frame_of(500, 10, 2), 500, false).saturated_share, 0.5, 0.05);
}

TEST(FrameCheck, ABracketsStrayIsFoundAndNoneElse) {
  Random random(5);
  for (int n = 0; n < 200; ++n) {
    std::vector<BracketFrame> bracket;
    const double slope = random.uniform(1e4, 2e5), black = random.uniform(0, 200);
    for (int k = 0; k < 8; ++k) {
      const double exposure = 1e-3 * std::pow(2.0, k);
      FrameFigures f;
      f.mean_code = black + slope * exposure * (1 + 0.01 * random.normal());
      f.noise = std::sqrt(f.mean_code);
      f.saturated_share = f.mean_code > 4000 ? 0.5 : 0;
      bracket.push_back({exposure, f});
    }
    EXPECT_FALSE(stray_of_bracket(bracket));
    auto spoilt = bracket;
    std::size_t last = 0;
    while (last + 1 < spoilt.size() && spoilt[last + 1].figures.saturated_share == 0) ++last;
    if (last < 4) continue;
    const std::size_t wrong = 1 + random.below(static_cast<std::uint32_t>(last));
    if (slope * spoilt[wrong].exposure_s < 40) continue;                             // darker than what is told apart
    spoilt[wrong].figures.mean_code = black + slope * spoilt[wrong - 1].exposure_s;  // kept the one before
    EXPECT_EQ(stray_of_bracket(spoilt), wrong);
  }
}

TEST(FrameCheck, DarkIsDark) {
  const FrameFigures dark = figures_of(frame_of(64, 3, 3), 4095, false);
  EXPECT_TRUE(looks_dark(figures_of(frame_of(64, 3, 4), 4095, false), dark));
  EXPECT_FALSE(looks_dark(figures_of(frame_of(90, 4, 4), 4095, false), dark));
}

TEST(InstrumentLock, OneAtATime) {
  const std::string url = "sim://lock-test-" + std::to_string(::getpid());
  {
    const InstrumentLock first({url, url}, std::chrono::duration<double>(0));
    EXPECT_THROW(InstrumentLock({url}, std::chrono::duration<double>(0)), Error);
    const InstrumentLock other({url + "-other"}, std::chrono::duration<double>(0));
  }
  const InstrumentLock again({url}, std::chrono::duration<double>(0));
}

}  // namespace
}  // namespace gonio::acquisition
