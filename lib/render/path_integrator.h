// The integrator of one carrier (carrier.h). Instantiated once per carrier, in a source of its own.
#pragma once
#include <algorithm>
#include <iterator>

#include "render/light_tracer.h"
#include "render/path_loop.h"
#include "render/sample_map.h"

namespace gonio::render {

template <class Carrier>
class PathIntegrator final : public Integrator {
 public:
  PathIntegrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster, const Transport& transport)
      : setting_(scene, view, caster, transport), loop_(setting_) {
    if (setting_.caustics) light_tracer_.emplace(setting_, *setting_.caustics, Carrier::planes().size());
  }

  std::vector<std::string> planes() const override {
    std::vector<std::string> names = {""};
    std::ranges::copy(Carrier::planes(), std::back_inserter(names));
    std::ranges::copy(setting_.light_planes(), std::back_inserter(names));
    return names;
  }
  std::size_t lights() const override { return setting_.emitters.size(); }
  void trace(Vec2 pixel, Sampler& sampler, std::span<Rgb> planes, Noticed& noticed) const override {
    loop_.trace(pixel, map_ ? map_->onward(pixel) : 1, sampler, planes, noticed);
  }
  PixelGeometry geometry(int x, int y, const Noticed& noticed) const override {
    return setting_.geometry(x, y, noticed);
  }
  const SampleMap* sample_map(int preset) const override {
    if (!setting_.transport.adaptive || preset < least_adaptive) return nullptr;
    if (preset != map_preset_) {
      map_.reset();  // its pilot takes plain paths
      map_.emplace(*this, setting_.view.camera.width_px(), setting_.view.camera.height_px(), preset);
      map_preset_ = preset;
    }
    return &*map_;
  }
  bool traces_from_lights() const override { return light_tracer_.has_value(); }
  void trace_from_lights(std::uint64_t seed, std::uint64_t first, std::uint64_t count, Splats& splats) const override {
    if (light_tracer_) light_tracer_->trace(seed, first, count, splats);
  }

 private:
  static constexpr int least_adaptive = 4;  // samples of a pass: with fewer a pilot costs too much

  PathSetting setting_;
  PathLoop<Carrier> loop_;
  std::optional<LightTracer> light_tracer_;
  mutable std::optional<SampleMap> map_;
  mutable int map_preset_ = 0;
};

std::unique_ptr<Integrator> unpolarized_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                                   const Transport& transport);
std::unique_ptr<Integrator> polarized_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                                 const Transport& transport);

}  // namespace gonio::render
