#include "render/path_tracer.h"

#include "render/layers.h"

namespace gonio::render {

PictureIdentity picture_identity(const scene::Scene& scene, std::size_t view, const Integrator& integrator,
                                 std::uint64_t seed, int samples_per_pass, std::string scene_hash) {
  const scene::View& what = scene.views[view];
  PictureIdentity identity{.image = what.image,
                           .scene = std::move(scene_hash),
                           .seed = seed,
                           .width_px = what.camera.width_px(),
                           .height_px = what.camera.height_px(),
                           .samples_per_pass = samples_per_pass,
                           .planes = integrator.planes(),
                           .lights = {}};
  for (const std::size_t light : what.lights) identity.lights.push_back(scene.appearance.lights[light].id);
  return identity;
}

io::Image render(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Options& options) {
  Transport transport = options.transport;
  transport.adaptive = options.adaptive;
  const auto integrator = path_integrator(scene, view, caster, transport);
  const SamplePlan plan = sample_plan(options.spp);
  PassSums sums(picture_identity(scene, view, *integrator, options.seed, plan.samples_per_pass));
  const auto passes = static_cast<std::uint32_t>(plan.passes);
  {
    Progress progress(scene.views[view].image, passes * sums.pixels());
    add_passes(*integrator, sums, passes, &progress);
  }
  return develop(sums, options.geometry ? geometry_layers(scene, view, caster, *integrator) : io::Image());
}

}  // namespace gonio::render
