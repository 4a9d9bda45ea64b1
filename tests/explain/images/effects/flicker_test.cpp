// Lamps on the mains under a rolling shutter: |sin| of the mains as it is averaged over an exposure, begun at a moment
// that no picture shares with another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "effect_world.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "render/sensor_chain.h"

namespace gonio::tests {
namespace {

using testing::ElementsAre;

constexpr double period_px = 17.3, swing = 0.06;

double phase_of(std::size_t image) {
  return std::fmod(2.4 * static_cast<double>(image) + 0.9 * static_cast<double>(image * image), 2 * std::numbers::pi);
}

EffectWorld flickering() {
  EffectWorld world;
  world.change = [](std::size_t image, std::size_t, io::Image& picture) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        for (int c = 0; c < 3; ++c)
          picture.at(x, y, c) *=
              static_cast<float>(1 + swing * std::sin(2 * std::numbers::pi * y / period_px + phase_of(image)));
  };
  return world;
}

TEST(Flicker, BandsThatBeginAnewInEveryPictureAreNamedAndWritten) {
  const EffectOutcome outcome(flickering());
  ASSERT_THAT(outcome.named(), ElementsAre("sensor.row-pattern")) << outcome.explanation.sentence;
  EXPECT_NEAR(outcome.fitted("period_px"), period_px, 0.3);
  // The manifest says so: what render would write for each picture.
  manifest::Document upgraded = manifest::parse_document(flickering().manifest(""), "believed", {});
  outcome.problem.apply(outcome.explanation, upgraded);
  for (std::size_t i = 0; i < upgraded.images.size(); ++i) {
    const render::Sensor sensor = render::sensor_of(upgraded, i);
    const mechanism::Mechanism& m = *mechanism::find_mechanism("sensor.row-pattern");
    const double sine = sensor.amount(m, "sine"), cosine = sensor.amount(m, "cosine");
    EXPECT_NEAR(sine, swing * std::cos(phase_of(i)), 0.008) << i;
    EXPECT_NEAR(cosine, swing * std::sin(phase_of(i)), 0.008) << i;
    EXPECT_NEAR(sensor.amount(m, "period_px"), period_px, 0.3);
  }
}

TEST(Flicker, LampsOnDirectCurrentShowNone) {
  const EffectOutcome outcome(EffectWorld{}, {"sensor.row-pattern", "light.position", "sensor.non-linearity"});
  EXPECT_THAT(outcome.named(), ElementsAre()) << outcome.explanation.sentence;
}

}  // namespace
}  // namespace gonio::tests
