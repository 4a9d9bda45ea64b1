// Pictures from an integrator, by paths from both ends, without film: means and their errors from independent passes.
#pragma once
#include <cmath>
#include <mutex>
#include <vector>

#include "base/parallel.h"
#include "render/integrator.h"

namespace gonio::tests {

class SumOfSplats final : public render::Splats {
 public:
  SumOfSplats(int width, int height, std::size_t planes)
      : width_(width), height_(height), values(planes, std::vector<Rgb>(static_cast<std::size_t>(width * height))) {}
  void add(Vec2 pixel, std::size_t plane, Rgb value) override {
    const int x = static_cast<int>(std::floor(pixel.x + 0.5)), y = static_cast<int>(std::floor(pixel.y + 0.5));
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    const std::lock_guard lock(mutex_);
    values[plane][static_cast<std::size_t>(y * width_ + x)] += value;
  }

 private:
  int width_, height_;
  std::mutex mutex_;

 public:
  std::vector<std::vector<Rgb>> values;
};

struct TwoSided {
  std::vector<double> mean, variance;  // green of plane 0 per pixel; variance of the mean
  std::vector<double> from_lights;     // what of the mean is due to paths from the lights
  std::vector<std::vector<Rgb>> planes;
  double total() const { return sum(mean); }
  double sigma() const { return std::sqrt(sum(variance)); }  // of total(); passes are independent, pixels too
  static double sum(const std::vector<double>& v) {
    double s = 0;
    for (const double x : v) s += x;
    return s;
  }
};

inline TwoSided two_sided(const scene::Scene& scene, const render::RayCaster& caster,
                          const render::Transport& transport, int passes, int samples, std::uint64_t photons,
                          std::uint64_t seed = 1) {
  const auto integrator = render::path_integrator(scene, 0, caster, transport);
  const int width = scene.views[0].camera.width_px(), height = scene.views[0].camera.height_px();
  const auto pixels = static_cast<std::size_t>(width * height);
  const std::size_t planes = integrator->planes().size();
  TwoSided result{std::vector<double>(pixels), std::vector<double>(pixels), std::vector<double>(pixels),
                  std::vector<std::vector<Rgb>>(planes, std::vector<Rgb>(pixels))};
  std::vector<double> squares(pixels);
  for (int pass = 0; pass < passes; ++pass) {
    SumOfSplats splats(width, height, planes);
    if (integrator->traces_from_lights())
      integrator->trace_from_lights(seed, static_cast<std::uint64_t>(pass) * photons, photons, splats);
    parallel_for(0, pixels, [&](std::size_t i) {
      std::vector<Rgb> sums(planes);
      render::Noticed noticed{std::vector<std::uint32_t>(integrator->lights()), 0};
      for (int s = 0; s < samples; ++s) {
        render::Sampler sampler(seed, (i << 16) + static_cast<std::uint64_t>(pass), static_cast<std::uint32_t>(s));
        const Vec2 corner{static_cast<double>(i % width) - 0.5, static_cast<double>(i / width) - 0.5};
        integrator->trace(corner + sampler.two(), sampler, sums, noticed);
      }
      for (std::size_t plane = 0; plane < planes; ++plane)
        result.planes[plane][i] += (sums[plane] / samples + splats.values[plane][i]) / passes;
      const double v = sums[0].y / samples + splats.values[0][i].y;
      result.mean[i] += v / passes;
      result.from_lights[i] += splats.values[0][i].y / passes;
      squares[i] += v * v / passes;
    });
  }
  for (std::size_t i = 0; i < pixels; ++i)
    result.variance[i] = std::max(0.0, squares[i] - result.mean[i] * result.mean[i]) / (passes - 1);
  return result;
}

}  // namespace gonio::tests
