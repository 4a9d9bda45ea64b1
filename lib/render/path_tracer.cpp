// The loop over pixels; see path_tracer.h. What a path carries is the integrator's affair (integrator.h).
#include "render/path_tracer.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "render/image_seed.h"
#include "render/integrator.h"

namespace gonio::render {
namespace {

constexpr int tile = 16;  // pixels per side of a unit of parallel work

class PixelLoop {
 public:
  PixelLoop(const Integrator& integrator, const SamplePlan& plan, int width_px, std::uint64_t seed, bool geometry)
      : integrator_(integrator), plan_(plan), width_px_(width_px), seed_(seed), geometry_(geometry) {}

  Pixel pixel(int x, int y) const {
    Pixel result;
    Noticed noticed{.seen = std::vector<std::uint32_t>(integrator_.lights()), .met = 0};
    Rgb spread;  // sum of squared deviations (Welford 1962)
    for (int replicate = 0; replicate < plan_.replicates; ++replicate) {
      throw_if_interrupted();  // a tile with a million samples per pixel lasts minutes
      const Rgb value = replicate_mean(x, y, replicate, noticed);
      const Rgb step = value - result.mean;
      result.mean += step / (replicate + 1);
      spread += step * (value - result.mean);
    }
    result.variance = spread / (static_cast<double>(plan_.replicates) * (plan_.replicates - 1));
    if (geometry_) result.geometry = integrator_.geometry(x, y, noticed);
    return result;
  }

 private:
  Rgb replicate_mean(int x, int y, int replicate, Noticed& noticed) const {
    const auto pixel =
        static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(width_px_) + static_cast<std::uint64_t>(x);
    const std::uint64_t stream = (pixel << 24) + static_cast<std::uint64_t>(replicate);
    const int count = plan_.side * plan_.side;
    std::vector<Rgb> planes(integrator_.planes().size());
    for (int sample = 0; sample < count; ++sample) {
      Sampler sampler(seed_, stream, static_cast<std::uint32_t>(sample));
      integrator_.trace(Vec2{x - 0.5, y - 0.5} + sampler.two(), sampler, planes, noticed);
    }
    return planes[0] / count;
  }

  const Integrator& integrator_;
  SamplePlan plan_;
  int width_px_;
  std::uint64_t seed_;
  bool geometry_;
};

}  // namespace

io::Image render(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Options& options) {
  const scene::View& what = scene.views[view];
  const int width = what.camera.width_px(), height = what.camera.height_px();
  const auto integrator = path_integrator(scene, view, caster, options.transport);
  const PixelLoop loop(*integrator, sample_plan(options.spp), width, seed_of(options.seed, what.image),
                       options.geometry);
  std::vector<Pixel> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int columns = (width + tile - 1) / tile, rows = (height + tile - 1) / tile;
  Progress progress(what.image, pixels.size());
  parallel_for(0, static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t index) {
    const int left = static_cast<int>(index) % columns * tile, top = static_cast<int>(index) / columns * tile;
    const int right = std::min(left + tile, width), bottom = std::min(top + tile, height);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
            loop.pixel(x, y);
    progress.advance(static_cast<std::uint64_t>(right - left) * static_cast<std::uint64_t>(bottom - top));
  });
  std::vector<std::string> lights;
  for (const std::size_t light : what.lights) lights.push_back(scene.appearance.lights[light].id);
  return develop(width, height, pixels, lights, options.geometry);
}

}  // namespace gonio::render
