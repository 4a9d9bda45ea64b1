// What arrives at a patch from lights with and without extent, against closed forms.
#include "goniometry/sample/irradiance.h"

#include <gtest/gtest.h>

#include "light/irradiance.h"

namespace gonio::goniometry {
namespace {

Rgb arriving(const std::string& model, const manifest::Parameters& parameters, Vec3 point_m) {
  const auto emitter = light::find(model)->prepare(parameters, {}, "light");
  std::vector<Beam> beams;
  beams_at(*emitter, point_m, beams);
  Rgb sum;
  for (const Beam& beam : beams) sum += beam.weight * std::max(0.0, beam.direction.z);
  return sum;
}

TEST(Beams, SumToTheClosedForms) {
  const std::vector<double> at = {0.2, 0.1, 0.3}, watt_per_sr = {1, 2, 3};
  const Vec3 lamp{0.2, 0.1, 0.3}, point{0.01, -0.02, 0}, up{0, 0, 1};
  const Rgb small = arriving("point", {{"position_m", at}, {"watt_per_sr", watt_per_sr}}, point);
  EXPECT_NEAR(small.y / light::point_irradiance({1, 2, 3}, lamp, point, up).y, 1, 1e-12);
  const Rgb ball = arriving("sphere", {{"position_m", at}, {"watt_per_sr", watt_per_sr}, {"radius_m", 0.05}}, point);
  EXPECT_NEAR(ball.z / light::sphere_irradiance({1, 2, 3}, lamp, 0.05, point, up).z, 1, 2e-3);
  const Rgb far = arriving("directional", {{"towards", at}, {"watt_per_m2", watt_per_sr}}, point);
  EXPECT_NEAR(far.x, normalized(lamp).z, 1e-12);
}

}  // namespace
}  // namespace gonio::goniometry
