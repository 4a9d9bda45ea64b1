// An integrator without a scene, for tests of passes: cheap, with known means, with every kind of plane.
#pragma once
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "render/integrator.h"
#include "render/passes.h"

namespace gonio::tests {

class MadeUpIntegrator : public render::Integrator {
 public:
  bool splats = false;
  double spread = 0.5;  // standard deviation of a sample over its mean

  // Evenly distributed about a mean that depends on the pixel; black in the left third of the picture.
  static double mean(Vec2 pixel) { return std::floor(pixel.x + 0.5) < 8 ? 0 : 0.1 + 0.01 * std::floor(pixel.x + 0.5); }

  std::vector<std::string> planes() const override { return {"", "light.lamp", "s1"}; }
  std::size_t lights() const override { return 2; }
  void trace(Vec2 pixel, render::Sampler& sampler, std::span<Rgb> planes, render::Noticed& noticed) const override {
    const Vec2 u = sampler.two();
    const double v = mean(pixel) * (1 + spread * std::sqrt(3.0) * (2 * u.x - 1));
    planes[0] += Rgb{v, 0.5 * v, v * 2 * u.y};
    planes[1] += Rgb{v, v, v} * 0.25;
    planes[2] += Rgb{u.x - 0.5, 0, 0};
    if (v > 0) ++noticed.met;
    if (v > 0 && u.y < 0.5) ++noticed.seen[0];
  }
  render::PixelGeometry geometry(int, int, const render::Noticed&) const override { return {}; }
  bool traces_from_lights() const override { return splats; }
  void trace_from_lights(std::uint64_t seed, std::uint64_t first, std::uint64_t count,
                         render::Splats& to) const override {
    gonio::parallel_for(0, count, [&](std::size_t i) {
      Random random(seed, first + i);
      const Vec2 pixel{random.uniform(-2, 26), random.uniform(-2, 18)};
      const double v = 28.0 * 20.0 * random.uniform() / static_cast<double>(count);
      to.add(pixel, 0, {v, v, v});
    });
  }
};

inline render::PictureIdentity made_up_identity(const render::Integrator& integrator, int samples_per_pass = 4) {
  return {.image = "made-up",
          .scene = "hash",
          .seed = 3,
          .width_px = 24,
          .height_px = 16,
          .samples_per_pass = samples_per_pass,
          .planes = integrator.planes(),
          .lights = {"lamp"}};
}

inline render::PassSums made_up_passes(const render::Integrator& integrator, std::uint32_t first, std::uint32_t count,
                                       int samples_per_pass = 4) {
  render::PassSums sums(made_up_identity(integrator, samples_per_pass), first);
  add_passes(integrator, sums, count, nullptr);
  return sums;
}

}  // namespace gonio::tests
