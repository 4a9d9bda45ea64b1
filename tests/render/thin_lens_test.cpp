// Pictures through a thin lens against the circle of confusion. The blurred lamp fills at least a seventh of the
// samples of some 50 pixels or more: the sum has a relative error below 1 % and its second moment below 2 %; the
// tolerances are four of these. Seeds are fixed.
#include <gtest/gtest.h>

#include "scenes.h"

namespace gonio::render {
namespace {

struct Spot {
  double sum = 0, second_moment = 0;  // about the picture's centre, px^2
};

// A small lamp 2 m away on the axis of a lens of 200 px.
Spot spot_of(const scene::ThinLens& lens, double lamp_radius_m) {
  tests::SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.diffuse(0), {0, 0, 9});
  builder.light("sphere",
                {{"position_m", std::vector<double>{0, 0, 2}}, {"watt_per_sr", 1.0}, {"radius_m", lamp_radius_m}});
  scene::Scene scene = builder.view(tests::pinhole(25, 200), {}, {}).scene();
  scene.views[0].lens = lens;
  const io::Image image = tests::render_view(scene, {.spp = 1024, .geometry = false});
  Spot spot;
  for (int y = 0; y < 25; ++y)
    for (int x = 0; x < 25; ++x) {
      const double v = image.at(x, y, 0);
      spot.sum += v;
      spot.second_moment += v * ((x - 12) * (x - 12) + (y - 12) * (y - 12));
    }
  spot.second_moment /= spot.sum;
  return spot;
}

TEST(ThinLens, ALampOutOfFocusBecomesADiscOfTheSameLight) {
  constexpr double lamp_m = 0.02, f_px = 200, z = 2;
  const Spot sharp = spot_of({0, 1}, lamp_m);
  for (const double focus_m : {1.0, 1.25, 4.0}) {
    const Spot blurred = spot_of({0.05, focus_m}, lamp_m);
    const double radius_px = 0.05 * f_px * std::abs(1 / z - 1 / focus_m);
    EXPECT_NEAR(blurred.sum, f_px * f_px / (z * z), 0.04 * f_px * f_px / (z * z)) << focus_m;  // L times pixels filled
    EXPECT_NEAR(blurred.second_moment - sharp.second_moment, radius_px * radius_px / 2, 0.04 * radius_px * radius_px)
        << focus_m;
  }
}

TEST(ThinLens, WhatIsInFocusStaysSharp) {
  const Spot sharp = spot_of({0, 1}, 0.02), focused = spot_of({0.05, 2}, 0.02);
  EXPECT_NEAR(focused.second_moment, sharp.second_moment, 0.03 * sharp.second_moment);
}

}  // namespace
}  // namespace gonio::render
