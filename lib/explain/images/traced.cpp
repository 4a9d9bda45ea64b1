// See traced.h. Every pixel takes as many passes of low-discrepancy samples as render::add_passes would give it; passes
// are independent, so that their scatter measures the error of their mean.
#include "explain/images/traced.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "render/image_seed.h"
#include "render/integrator.h"
#include "render/pass_splats.h"
#include "render/passes.h"
#include "scene/scene.h"

namespace gonio::explain::images {
namespace {

constexpr std::uint64_t photons_per_path = 3;
constexpr double least_spp = 32, most_spp = 4096;

// One pass of a pixel: the mean of its samples, plane by plane.
std::vector<Rgb> trace_pass(const render::Integrator& integrator, const render::SamplePlan& plan, std::uint64_t seed,
                            std::size_t place, int pass, std::array<int, 2> at) {
  std::vector<Rgb> planes(integrator.planes().size());
  render::Noticed noticed;
  noticed.seen.resize(integrator.lights());
  const std::uint64_t stream = (static_cast<std::uint64_t>(place) << 24) + static_cast<std::uint64_t>(pass);
  for (int sample = 0; sample < plan.samples_per_pass; ++sample) {
    render::Sampler sampler(seed, stream, static_cast<std::uint32_t>(sample));
    integrator.trace(Vec2{at[0] - 0.5, at[1] - 0.5} + sampler.two(), sampler, planes, noticed);
  }
  for (Rgb& plane : planes) plane = plane / plan.samples_per_pass;
  return planes;
}

// Sums over the passes of all pixels of a picture become means and their variances.
void trace_picture(const render::Integrator& integrator, const scene::View& view, const render::SamplePlan& plan,
                   std::uint64_t seed, TracedPixels& picture) {
  const std::size_t count = picture.at.size();
  std::vector<Rgb> sum(count), squares(count);
  const int width = view.camera.width_px(), height = view.camera.height_px();
  const std::uint64_t photons = photons_per_path * count * static_cast<unsigned>(plan.samples_per_pass);
  for (int pass = 0; pass < plan.passes; ++pass) {
    std::optional<render::PassSplats> splats;
    if (integrator.traces_from_lights())
      integrator.trace_from_lights(split_mix(seed), static_cast<unsigned>(pass) * photons, photons,
                                   splats.emplace(width, height, integrator.planes().size()));
    parallel_for(
        0, count,
        [&](std::size_t k) {
          const auto [x, y] = picture.at[k];
          std::vector<Rgb> mean = trace_pass(integrator, plan, seed, k, pass, picture.at[k]);
          for (std::size_t p = 0; p < mean.size() && splats; ++p)
            mean[p] += splats->value(
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x), p);
          sum[k] += mean[0], squares[k] += mean[0] * mean[0];
          for (std::size_t p = 1; p < mean.size(); ++p)
            for (int c = 0; c < 3; ++c)
              picture.stokes[9 * k + 3 * (p - 1) + static_cast<std::size_t>(c)] += mean[p][c] / plan.passes;
        },
        8);
  }
  const double n = plan.passes;
  for (std::size_t k = 0; k < count; ++k)
    for (int c = 0; c < 3; ++c) {
      const std::size_t row = 3 * k + static_cast<std::size_t>(c);
      const double mean = sum[k][c] / n;
      picture.radiance[row] = mean;
      picture.variance[row] = std::max(0.0, squares[k][c] / n - mean * mean) / (n - 1);
    }
}

}  // namespace

bool trace_pixels(const manifest::Document& document, std::vector<TracedPixels>& pictures, double paths,
                  std::uint64_t seed, Caustics caustics, Light light) {
  const scene::Scene scene = scene::build_scene(document);
  const render::RayCaster caster(scene.instances);
  const bool polarized = light == Light::polarized;  // of screens: large enough for paths from the camera alone
  const render::Transport transport{.stokes = polarized, .from_lights = !polarized, .adaptive = false};
  double pixels = 0;
  for (const TracedPixels& picture : pictures) pixels += static_cast<double>(picture.at.size());
  const render::SamplePlan plan =
      render::sample_plan(static_cast<int>(std::clamp(paths / std::max(1.0, pixels), least_spp, most_spp)));
  for (TracedPixels& picture : pictures) {
    const auto integrator = render::path_integrator(scene, picture.entry, caster, transport);
    if (caustics == Caustics::refused && integrator->traces_from_lights()) return false;
    picture.radiance.assign(3 * picture.at.size(), 0.0);
    picture.variance.assign(3 * picture.at.size(), 0.0);
    picture.stokes.assign(light == Light::polarized ? 9 * picture.at.size() : 0, 0.0);
    const std::uint64_t own = render::seed_of(seed, scene.views[picture.entry].image);
    trace_picture(*integrator, scene.views[picture.entry], plan, own, picture);
  }
  return true;
}

}  // namespace gonio::explain::images
