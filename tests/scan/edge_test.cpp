// A blurred picture continued to complex places, against the blur of a pattern summed place by place.
#include <gtest/gtest.h>

#include <cmath>

#include "scan/mechanisms/structured_light_edge.h"

namespace gonio::tests {
namespace {

TEST(StructuredLightEdge, TurnsThePhaseAsTheBlurOfAPatternDoes) {
  const double spread = 0.8;
  const auto printed = [](double x, double y) { return x + 0.3 * y < 0.4 ? 1.0 : 0.25; };
  for (const Vec2 k : {Vec2{0.8, 0}, Vec2{0.5, -0.4}, Vec2{-0.3, 0.6}}) {
    equation::Neighbours bright{};
    std::complex<double> read = 0;
    const auto blurred = [&](double at_x, double at_y, Vec2 wave) {
      std::complex<double> sum = 0;
      constexpr double step = 0.05;
      for (double x = -6; x < 6; x += step)
        for (double y = -6; y < 6; y += step) {
          const double g = std::exp(-0.5 * (x * x + y * y) / spread) / (2 * pi * spread) * step * step;
          sum += g * printed(at_x + x, at_y + y) * std::polar(1.0, wave.x * x + wave.y * y);
        }
      return sum;
    };
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i)
        bright[static_cast<std::size_t>(5 * (j + 2) + i + 2)] = static_cast<float>(blurred(i, j, {}).real());
    read = blurred(0, 0, k);
    const double turned = equation::structured_light_edge(bright, k, spread);
    EXPECT_NEAR(turned, std::arg(read), 0.01 + 0.05 * std::abs(std::arg(read)));
    EXPECT_GT(std::abs(turned), 0.03);
  }
}

}  // namespace
}  // namespace gonio::tests
