// Rays and paths per second on a table with a knot of 20160 triangles. The rate is per thread of the caller: closest()
// and occluded() are called from one.
#include <benchmark/benchmark.h>
#include <stdlib.h>

#include <filesystem>

#include "base/random.h"
#include "manifest/document.h"
#include "render/path_tracer.h"
#include "render/specimen.h"

namespace gonio {
namespace {

const scene::Scene& knot() {
  static const scene::Scene scene = [] {
    char folder[] = "/tmp/gonio-bench-XXXXXX";
    manifest::Document document = render::specimen("knot", ::mkdtemp(folder));
    document.allow_outside = true;  // the mesh lies in the scratch folder
    scene::Scene built = scene::build_scene(document);
    std::filesystem::remove_all(folder);
    return built;
  }();
  return scene;
}

void primary_rays(benchmark::State& state) {
  const render::RayCaster caster(knot().instances);
  const scene::View& view = knot().views[0];
  std::int64_t rays = 0;
  for (auto _ : state)
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 160; ++x, ++rays) {
        const camera::Ray ray = view.camera.ray({static_cast<double>(x), static_cast<double>(y)});
        benchmark::DoNotOptimize(
            caster.closest(view.world_from_camera * ray.origin_m, view.world_from_camera.rotate(ray.direction)));
      }
  state.SetItemsProcessed(rays);
}
BENCHMARK(primary_rays)->Unit(benchmark::kMillisecond);

void scattered_rays(benchmark::State& state) {
  const render::RayCaster caster(knot().instances);
  Random random(1);
  const auto start = *caster.closest({0, 0.2, 0.3}, normalized(Vec3{0, -0.15, -0.25}));
  std::int64_t rays = 0;
  for (auto _ : state)
    for (int i = 0; i < 10000; ++i, ++rays) {
      const double z = random.uniform(), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
      const Vec3 local{r * std::cos(phi), r * std::sin(phi), z};
      benchmark::DoNotOptimize(caster.closest_from(start, Basis(start.geometric_normal).to_world(local)));
    }
  state.SetItemsProcessed(rays);
}
BENCHMARK(scattered_rays)->Unit(benchmark::kMillisecond);

void paths(benchmark::State& state) {
  const render::RayCaster caster(knot().instances);
  std::int64_t count = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(render::render(knot(), 0, caster, {.spp = 16}));
    count += 160 * 160 * 16;
  }
  state.SetItemsProcessed(count);
}
BENCHMARK(paths)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace gonio
