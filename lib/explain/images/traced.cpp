// See traced.h. Every pixel takes as many passes of low-discrepancy samples as render::add_passes would give it; passes
// are independent, so that their scatter measures the error of their mean.
#include "explain/images/traced.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/image_seed.h"
#include "render/integrator.h"
#include "render/passes.h"
#include "scene/scene.h"

namespace gonio::explain::images {
namespace {

constexpr double least_spp = 32, most_spp = 1024;

void trace_one(const render::Integrator& integrator, const render::SamplePlan& plan, std::uint64_t seed,
               std::size_t place, TracedPixels& picture) {
  const auto [x, y] = picture.at[place];
  std::vector<Rgb> planes(integrator.planes().size());
  render::Noticed noticed;
  noticed.seen.resize(integrator.lights());
  Rgb sum, squares;
  for (int pass = 0; pass < plan.passes; ++pass) {
    const std::uint64_t stream = (static_cast<std::uint64_t>(place) << 24) + static_cast<std::uint64_t>(pass);
    std::fill(planes.begin(), planes.end(), Rgb{});
    for (int sample = 0; sample < plan.samples_per_pass; ++sample) {
      render::Sampler sampler(seed, stream, static_cast<std::uint32_t>(sample));
      integrator.trace(Vec2{x - 0.5, y - 0.5} + sampler.two(), sampler, planes, noticed);
    }
    const Rgb mean = planes[0] / plan.samples_per_pass;
    sum += mean;
    squares += mean * mean;
  }
  const double n = plan.passes;
  for (int c = 0; c < 3; ++c) {
    const std::size_t row = 3 * place + static_cast<std::size_t>(c);
    const double mean = sum[c] / n;
    picture.radiance[row] = mean;
    picture.variance[row] = std::max(0.0, squares[c] / n - mean * mean) / (n - 1);
  }
}

}  // namespace

bool trace_pixels(const manifest::Document& document, std::vector<TracedPixels>& pictures, double paths,
                  std::uint64_t seed) {
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  const render::Transport transport{.adaptive = false};
  double pixels = 0;
  for (const TracedPixels& picture : pictures) pixels += static_cast<double>(picture.at.size());
  const render::SamplePlan plan =
      render::sample_plan(static_cast<int>(std::clamp(paths / std::max(1.0, pixels), least_spp, most_spp)));
  for (TracedPixels& picture : pictures) {
    const auto integrator = render::path_integrator(scene, picture.entry, caster, transport);
    if (integrator->traces_from_lights()) return false;
    picture.radiance.assign(3 * picture.at.size(), 0.0);
    picture.variance.assign(3 * picture.at.size(), 0.0);
    const std::uint64_t own = render::seed_of(seed, scene.views[picture.entry].image);
    parallel_for(
        0, picture.at.size(), [&](std::size_t k) { trace_one(*integrator, plan, own, k, picture); }, 8);
  }
  return true;
}

}  // namespace gonio::explain::images
